"""Magnetometers of GNSS pucks and the ICM-20948: registers that others compute with, and what goes wrong."""

import math
import struct
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from twins.i2c import Part, plug_in
from twins.inertial import Icm20948Twin
from twins.lines import HandClock
from twins.magnetic_bench import MAGNETOMETERS as TWINS
from twins.magnetic_bench import Bench
from twins.magnetics import Scene
from twins.pucks import Ak09916Twin, Ist8308Twin, Ist8310Twin, Rm3100Twin

from companion.config.sensors import CompassPart, Mounting
from companion.core.errors import HardwareError
from companion.core.vectors import Vector, times
from companion.hal.heading.inertial import INERTIAL
from companion.hal.heading.magnetic_compass import open_magnetic_compass
from companion.hal.heading.magnetometers import MAGNETOMETERS
from companion.hal.heading.orientation import board_to_body
from companion.hal.raspberry_pi import open_i2c
from companion.sensors.compass.attitude import GRAVITY_M_S2
from companion.sensors.compass.magnetic_field import FieldCorrector

PUCKS = ["ist8310", "ist8308", "rm3100", "ak09916"]


class Bytes:
    """A bus with one part, whose registers hold these bytes; all else is zero."""

    def __init__(self, **registers: bytes) -> None:
        self.map = bytearray(0x100)
        for name, data in registers.items():
            at = int(name.removeprefix("x"), 16)
            self.map[at : at + len(data)] = data

    def read_i2c_block_data(self, address: int, register: int, length: int) -> list[int]:
        return list(self.map[register : register + length])

    def write_i2c_block_data(self, address: int, register: int, data: object) -> None: ...

    def close(self) -> None: ...


def in_body(vector: Vector) -> Vector:
    return times(board_to_body(Mounting()), vector)


@pytest.mark.parametrize(
    ("driver", "registers"),
    [
        # PX4: 1320 counts a gauss, z turned over: 0.2, −0.1 and 0.45 G ahead, to starboard and down
        ("ist8310", {"x02": b"\x01" + struct.pack("<3h", 264, -132, -594), "x0D": b"\x70"}),
        # ArduPilot: 1.515 mG a count, z turned over
        ("ist8308", {"x10": b"\x01" + struct.pack("<3h", 132, -66, -297)}),
        # ArduPilot, PX4: 75 counts a microtesla, axes as they are: 1500, −750, 3375
        ("rm3100", {"x34": b"\x80", "x24": bytes.fromhex("0005DC FFFD12 000D2F")}),
        # SparkFun: 0.15 µT a count; PX4: axes as they are
        ("ak09916", {"x10": b"\x01" + struct.pack("<3hxx", 133, -67, 300)}),
    ],
)
def test_registers_are_the_field_that_other_drivers_compute(driver: str, registers: dict[str, bytes]) -> None:
    field = MAGNETOMETERS[driver](Bytes(**registers)).read()
    assert field is not None
    assert in_body(field) == pytest.approx((200.0, -100.0, 450.0), abs=0.8)


def test_registers_of_an_icm_20948_are_the_motion_that_other_drivers_compute() -> None:
    # SparkFun: 8.192 counts a thousandth of g, 65.5 a degree a second; PX4: y and z turned over
    data = struct.pack(">6h", 819, -1638, 8192, 655, 1310, -1965)
    motion = INERTIAL["icm20948"](Bytes(x1A=b"\x01", x2D=data)).read()
    assert motion is not None
    force_g = tuple(one / GRAVITY_M_S2 for one in in_body(motion.force))
    assert force_g == pytest.approx((0.1, 0.2, -1.0), abs=1e-3)
    rate_deg_s = tuple(math.degrees(one) for one in in_body(motion.rate))
    assert rate_deg_s == pytest.approx((10.0, -20.0, 30.0))


@given(data=st.binary(min_size=0x100, max_size=0x100))
def test_whatever_bytes_come_there_is_a_finite_field_or_none(data: bytes) -> None:
    bus = Bytes(x00=data)
    for driver in PUCKS:
        part = MAGNETOMETERS[driver](bus)
        assert isinstance(part.identify(), str)
        field = part.read()
        assert field is None or max(map(abs, field)) < 50000.0
    motion = INERTIAL["icm20948"](bus).read()
    assert motion is None or math.isfinite(sum((*motion.rate, *motion.force)))


@pytest.mark.parametrize(
    ("driver", "limit_mg"), [("ist8310", 16000), ("ist8308", 5000), ("rm3100", 8000), ("ak09916", 49120)]
)
def test_a_field_beyond_the_range_is_no_sample(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, driver: str, limit_mg: int
) -> None:
    bench = Bench(monkeypatch, tmp_path, CompassPart(driver=driver))  # type: ignore[arg-type]
    for ahead_mg, is_measured in ((0.9 * limit_mg, True), (1.1 * limit_mg, False), (0.0, True)):
        bench.scene.iron_mg = (ahead_mg, 0.0, 0.0)
        bench.run(0.1)
        assert (bench.reading.time_s == bench.clock()) is is_measured


@pytest.mark.parametrize("driver", PUCKS)
def test_a_puck_that_is_unplugged_and_back_gives_the_heading_again(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, driver: str
) -> None:
    bench = Bench(monkeypatch, tmp_path, CompassPart(driver=driver, imu="icm20948"))  # type: ignore[arg-type]
    bench.run(12.0)
    parts: list[tuple[int, Part]] = [
        (bench.field.address, bench.field),
        (bench.motion.address, bench.motion),
    ]
    for address, _ in parts:
        del bench.dev.parts[address]
    bench.clock.advance(0.02)
    with pytest.raises(OSError, match="121"):
        bench.compass.step()
    bench.clock.advance(5.0)
    for address, part in parts:
        bench.dev.parts[address] = part
    bench.field.power_up()
    bench.motion.power_up()
    bench.scene.heading_deg = 140.0
    bench.run(4.0)
    assert bench.reading.time_s == pytest.approx(bench.clock(), abs=0.03)
    assert abs(bench.error_deg) < 1.5
    assert bench.reading.yaw_rate_rad_s is not None


@pytest.mark.parametrize("driver", PUCKS)
def test_a_puck_that_repeats_one_value_is_not_believed(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, driver: str
) -> None:
    bench = Bench(monkeypatch, tmp_path, CompassPart(driver=driver))  # type: ignore[arg-type]
    bench.run(1.0)
    bench.field.is_stuck, setups = True, bench.field.setups
    bench.run(4.0)
    assert bench.clock() - bench.reading.time_s > 1.0
    assert bench.field.setups > setups


@pytest.mark.parametrize(
    ("driver", "address", "twin", "told"),
    [
        ("ist8308", 0x00, Ak09916Twin, r"IST8308: .* 0xc says 0x48, not 0x8 \(AK09916\)"),
        ("ak09916", 0x00, Ist8308Twin, r"AK09916: .* 0xc says 0x800, not 0x4809 \(IST8308\)"),
        ("ist8308", 0x00, Ist8310Twin, r"IST8308: .* 0xc says 0x10, not 0x8 \(IST8310\)"),
        ("ist8310", 0x0C, Ist8308Twin, r"IST8310: .* 0xc says 0x8, not 0x10 \(IST8308\)"),
        ("ist8310", 0x20, Rm3100Twin, r"IST8310: .* 0x20 says 0x0, not 0x10$"),
        ("rm3100", 0x0C, Ist8308Twin, r"RM3100: .* 0xc says 0x0, not 0x22$"),
    ],
)
def test_another_part_at_the_address_is_named(
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    driver: str,
    address: int,
    twin: type[Ak09916Twin],
    told: str,
) -> None:
    clock = HandClock()
    plug_in(monkeypatch, tmp_path, {address or 0x0C: twin(Scene(clock))})
    part = CompassPart(driver=driver, address=address)  # type: ignore[arg-type]
    with pytest.raises(HardwareError, match=told):
        open_magnetic_compass(part, clock, FieldCorrector(), clock.advance)


def test_an_ak09916_in_an_icm_20948_is_only_found_through_it(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    clock = HandClock()
    field, motion = Ak09916Twin(Scene(clock)), Icm20948Twin(Scene(clock))
    field.carrier = motion
    motion.banks[0][0x03] = 0x20  # another program drove the auxiliary bus
    plug_in(monkeypatch, tmp_path, {0x0C: field, 0x69: motion})
    monkeypatch.setattr("companion.hal.heading.magnetic_compass.MagneticCompass.start", lambda self: self)
    with pytest.raises(HardwareError, match="AK09916: no answer at I²C address 0xc"):
        open_magnetic_compass(CompassPart(driver="ak09916"), clock, FieldCorrector(), clock.advance)
    through = CompassPart(driver="ak09916", imu="icm20948")
    open_magnetic_compass(through, clock, FieldCorrector(), clock.advance).close()


def test_an_icm_20948_that_another_program_left_in_another_bank_and_ranges_is_set_up(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    clock = HandClock()
    twin = Icm20948Twin(Scene(clock))
    twin.bank = 3
    twin.banks[2][0x01], twin.banks[2][0x11], twin.banks[2][0x14] = 0x07, 0xFF, 0x07
    twin.scene.yaw_rate_deg_s = 30.0
    plug_in(monkeypatch, tmp_path, {0x69: twin})
    part = INERTIAL["icm20948"](open_i2c("ICM-20948"), wait=clock.advance)
    assert part.identify() == ""
    part.set_up()
    assert twin.rate_hz() == pytest.approx(1125.0 / 11.0)
    clock.advance(0.02)
    motion = part.read()
    assert motion is not None
    assert in_body(motion.force)[2] == pytest.approx(-GRAVITY_M_S2, abs=0.1)
    assert math.degrees(in_body(motion.rate)[2]) == pytest.approx(30.0, abs=0.3)


def test_an_icm_20948_that_changes_its_bank_is_read_from_bank_0(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    bench = Bench(monkeypatch, tmp_path, CompassPart(driver="ak09916", imu="icm20948"))
    bench.scene.roll_deg = 10.0
    bench.run(12.0)
    assert isinstance(bench.motion, Icm20948Twin)
    bench.motion.bank = 1
    bench.motion.banks[1][0x1A], bench.motion.banks[1][0x2D:0x39] = 0x01, bytes(range(0x60, 0x6C))
    bench.run(1.0)
    assert bench.motion.bank == 0
    assert bench.reading.time_s == bench.clock()
    assert math.degrees(bench.reading.roll_rad or 0.0) == pytest.approx(10.0, abs=0.5)


OTHER_SETTINGS = {
    "ist8310": {0x41: 0x00, 0x42: 0x00, 0x0D: 0x00},
    "ist8308": {0x20: 0x02, 0x31: 0x0C, 0x34: 0x01, 0x41: 0x2D},
    "rm3100": {0x01: 0x71, 0x05: 50, 0x07: 100, 0x09: 50, 0x0B: 0x9F},
    "ak09916": {0x31: 0x02},
}


@pytest.mark.parametrize("driver", PUCKS)
def test_a_puck_with_settings_of_another_program_is_set_up_and_each_measurement_is_read_once(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, driver: str
) -> None:
    clock = HandClock()
    twin = TWINS[driver](Scene(clock))
    for register, value in OTHER_SETTINGS[driver].items():
        twin.map[register] = value
    plug_in(monkeypatch, tmp_path, {twin.address: twin})
    part = MAGNETOMETERS[driver](open_i2c(driver), wait=clock.advance)
    assert part.identify() == ""
    part.set_up()
    for _ in range(10):
        clock.advance(0.02)
        field = part.read()
        assert field is not None
        assert in_body(field) == pytest.approx((200.0, 0.0, 440.0), abs=8.0)
        assert part.read() is None
    averages = {"ist8310": 0x24, "ist8308": 0x24}
    assert twin.map[0x41] == averages.get(driver, 0x00)


@pytest.mark.parametrize("driver", PUCKS)
def test_a_level_puck_finds_the_heading_within_its_noise_all_around(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, driver: str
) -> None:
    bench = Bench(monkeypatch, tmp_path, CompassPart(driver=driver))  # type: ignore[arg-type]
    bench.scene.noise_mg = 0.0
    resolution_deg = math.degrees(1.6 / 200.0)  # of the coarsest, in the horizontal field
    for heading_deg in range(0, 360, 30):
        bench.scene.heading_deg = heading_deg
        bench.run(0.1)
        assert abs(bench.error_deg) < resolution_deg
