"""Parts are found on the I²C bus by reading only, and what is not sure is not taken for a part."""

import errno
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from twins.i2c import Bno055Twin, I2cDev, Part
from twins.inertial import Icm20948Twin, Lsm6dsTwin, Mpu6050Twin
from twins.lines import HandClock
from twins.magnetics import Hmc5883lTwin, Lis3mdlTwin, Qmc5883lTwin, Qmc5883pTwin, Scene
from twins.pucks import Ak09916Twin, Ist8308Twin, Ist8310Twin
from twins.pulses import Pca9685Twin

from companion.app.init.findings import Found
from companion.app.init.i2c_parts import ROWS, find_i2c_parts
from companion.config.boat_config import BoatConfig, with_value

CLOCK = HandClock()
SCENE = Scene(CLOCK)


class Untouched:
    """A part that nobody may write to."""

    def __init__(self, part: Part) -> None:
        self._part = part

    def get(self, register: int, length: int) -> bytes:
        return self._part.get(register, length)

    def put(self, register: int, data: bytes) -> None:
        raise AssertionError(f"{data!r} was written to register {register:#x}")


class WideRegisters:
    """Registers of two bytes, by their contents after power-up; zero else.

    INA219: INA219_CONFIG_DEFAULT of Linux's drivers/hwmon/ina2xx.c. The others are by their data sheets.
    """

    def __init__(self, contents: dict[int, int]) -> None:
        self._contents = contents

    def get(self, register: int, length: int) -> bytes:
        return self._contents.get(register, 0).to_bytes(2, "big")[:length]

    def put(self, register: int, data: bytes) -> None:
        raise AssertionError(f"{data!r} was written to register {register:#x}")


def part_of(driver: str) -> Part:
    wide = {
        "ina219": {0: 0x399F},
        "ina226": {0: 0x4127, 0xFE: 0x5449, 0xFF: 0x2260},
        "ina228": {1: 0xFB68, 0x3E: 0x5449, 0x3F: 0x2281},
        "ads1115": {1: 0x8583, 2: 0x8000, 3: 0x7FFF},
    }
    narrow: dict[str, Callable[[], Part]] = {
        "pca9685": Pca9685Twin,
        "bno055": Bno055Twin,
        "qmc5883l": lambda: Qmc5883lTwin(SCENE),
        "qmc5883p": lambda: Qmc5883pTwin(SCENE),
        "hmc5883l": lambda: Hmc5883lTwin(SCENE),
        "lis3mdl": lambda: Lis3mdlTwin(SCENE),
        "ist8310": lambda: Ist8310Twin(SCENE),
        "ist8308": lambda: Ist8308Twin(SCENE),
        "ak09916": lambda: Ak09916Twin(SCENE),
        "mpu6050": lambda: Mpu6050Twin(SCENE),
        "lsm6ds": lambda: Lsm6dsTwin(SCENE),
        "icm20948": lambda: Icm20948Twin(SCENE),
    }
    return WideRegisters(wide[driver]) if driver in wide else Untouched(narrow[driver]())


@pytest.fixture
def one_bus(dev: I2cDev, tmp_path: Path) -> I2cDev:
    (tmp_path / "dev/i2c-3").unlink()
    return dev


def scan(dev: I2cDev, parts: dict[int, Part]) -> tuple[list[Found], list[str]]:
    dev.parts = parts
    everything = list(find_i2c_parts())
    return [one for one in everything if isinstance(one, Found)], [
        one for one in everything if isinstance(one, str)
    ]


@pytest.mark.parametrize(
    ("driver", "address"), sorted({(row.driver, one) for row in ROWS for one in row.addresses})
)
def test_each_part_is_found_at_each_of_its_addresses_without_a_write(
    driver: str, address: int, one_bus: I2cDev
) -> None:
    (part, *_), notes = scan(one_bus, {address: part_of(driver)})
    assert (part.driver, bool(part.doubt), notes) == (driver, driver == "ads1115", [])
    config = BoatConfig()
    for key, value in part.values.items():
        config = with_value(config, key, value)
    assert address in part.values.values()
    assert driver == "pca9685" or part.values[part.key] == driver


def test_the_parts_of_a_boat_are_found_together_the_better_of_two_first(one_bus: I2cDev) -> None:
    drivers = {
        0x1E: "hmc5883l",
        0x29: "bno055",
        0x40: "ina219",
        0x41: "pca9685",
        0x45: "ina226",
        0x69: "mpu6050",
    }
    parts, notes = scan(one_bus, {address: part_of(driver) for address, driver in drivers.items()})
    assert [part.driver for part in parts] == ["pca9685", "bno055", "hmc5883l", "mpu6050", "ina226", "ina219"]
    assert notes == []


def test_the_magnetometer_within_an_icm_20948_needs_no_answer_of_its_own(one_bus: I2cDev) -> None:
    parts, _ = scan(one_bus, {0x69: part_of("icm20948")})
    assert [part.driver for part in parts] == ["icm20948", "ak09916"]
    parts, _ = scan(one_bus, {0x69: part_of("icm20948"), 0x0C: part_of("ak09916")})
    assert [part.driver for part in parts] == ["ak09916", "icm20948"]


def test_nobody_is_spoken_to_who_takes_a_registers_number_for_a_command(one_bus: I2cDev) -> None:
    """PCF8574 and 8574A (levels of its outputs), MCP4725 (its voltage), TCA9548A (its channels)."""

    class Commanded:
        def get(self, register: int, length: int) -> bytes:
            raise AssertionError(f"command {register:#x}")

        def put(self, register: int, data: bytes) -> None:
            raise AssertionError

    addresses = (*range(0x20, 0x28), *range(0x38, 0x40), *range(0x60, 0x68), *range(0x70, 0x78))
    assert scan(one_bus, dict.fromkeys(addresses, Commanded())) == ([], [])


def test_two_parts_at_one_address_are_no_sure_part(one_bus: I2cDev) -> None:
    """An INA219 beside a PCA9685 as delivered: every bit is low that either pulls low."""

    class Both:
        def get(self, register: int, length: int) -> bytes:
            pair = part_of("pca9685").get(register, 1) * length, part_of("ina219").get(register, length)
            return bytes(one & other for one, other in zip(*pair, strict=True))

        def put(self, register: int, data: bytes) -> None:
            raise AssertionError

    (part,), _ = scan(one_bus, {0x40: Both()})
    assert "two parts at one address" in part.doubt


def test_a_stranger_at_a_parts_address_is_told_and_not_taken(one_bus: I2cDev) -> None:
    parts, notes = scan(one_bus, {0x28: Untouched(Bno055Twin(chip_id=0xA1))})
    assert (parts, notes) == ([], ["0x28 on I²C bus 1: no supported part, or two at one address"])


@given(st.dictionaries(st.sampled_from(range(0x08, 0x78)), st.binary(min_size=256, max_size=256), max_size=4))
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=30)
def test_whatever_answers_nothing_is_raised_and_nothing_written(
    one_bus: I2cDev, maps: dict[int, bytes]
) -> None:
    class Map:
        def __init__(self, content: bytes) -> None:
            self._content = content

        def get(self, register: int, length: int) -> bytes:
            return (self._content * 2)[register : register + length]

        def put(self, register: int, data: bytes) -> None:
            raise AssertionError

    scan(one_bus, {address: Map(content) for address, content in maps.items()})


def test_parts_of_another_bus_name_it(dev: I2cDev, tmp_path: Path) -> None:
    (tmp_path / "dev/i2c-1").unlink()
    (part,), _ = scan(dev, {0x28: part_of("bno055")})
    assert part.values == {
        "parts.compass.driver": "bno055",
        "parts.compass.address": 0x28,
        "parts.compass.i2c_bus": 3,
    }


def test_a_bus_that_hangs_is_told_once(one_bus: I2cDev, monkeypatch: pytest.MonkeyPatch) -> None:
    class Hung:
        def get(self, register: int, length: int) -> bytes:
            raise OSError(errno.ETIMEDOUT, "Connection timed out")

        def put(self, register: int, data: bytes) -> None:
            raise AssertionError

    parts, notes = scan(one_bus, dict.fromkeys(range(0x08, 0x78), Hung()))
    assert (parts, notes) == ([], ["I²C bus 1 hangs: a part or a wire holds SDA or SCL low"])


def test_without_a_bus_or_the_right_to_it_the_cure_is_told(
    one_bus: I2cDev, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(_: str) -> None:
        raise PermissionError

    monkeypatch.setattr("smbus2.SMBus", refuse)
    _, (note,) = scan(one_bus, {})
    assert note.endswith("add the user to the group i2c")
    (tmp_path / "dev/i2c-1").unlink()
    _, (note,) = scan(one_bus, {})
    assert note.endswith("sudo raspi-config nonint do_i2c 0")
