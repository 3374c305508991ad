"""Finds parts on the I²C buses by their identification registers.

Nothing is written to a part but the number of the register to read: no output moves, no setting changes.
"""

import errno
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from typing import Final, NamedTuple

from companion.app.init.findings import COMPASS, IMU, Found
from companion.app.init.presets import Value
from companion.core.errors import HardwareError
from companion.hal import ads1115, raspberry_pi
from companion.hal.battery import INA219, INA226, INA228, SHUNT_ADDRESSES
from companion.hal.heading import bno055
from companion.hal.heading.chips import Chip
from companion.hal.heading.inertial import INERTIAL
from companion.hal.heading.magnetometers import MAGNETOMETERS, Ak09916
from companion.hal.raspberry_pi import I2cBus, Registers, open_i2c

_BATTERY, _PCA9685 = "parts.battery.driver", "parts.pca9685.address"


class _ReadingBus:
    """Drops what a driver writes: some reset a part, or set it up, to identify it."""

    def __init__(self, bus: I2cBus) -> None:
        self.read_i2c_block_data, self.close = bus.read_i2c_block_data, bus.close

    def write_i2c_block_data(self, address: int, register: int, data: Sequence[int]) -> None:
        pass


class I2cRow(NamedTuple):
    """A part that can be told by reading. is_it: raises OSError if nothing answers."""

    key: str
    driver: str
    addresses: Sequence[int]
    is_it: Callable[[Registers], bool]
    doubt: str = ""


def _is_chip(kind: type[Chip[object]]) -> Callable[[Registers], bool]:
    return lambda part: not kind(part.bus, part.address, lambda _: None).identify()


def _holds(values: dict[int, bytes]) -> Callable[[Registers], bool]:
    return lambda part: all(part.read(at, len(value)) == value for at, value in values.items())


# Nobody changes a PCA9685's further addresses (revision 4, 7.3.6 and 7.3.7), nor an ADS1115's thresholds
# (SBAS444E, 8.1.4). An INA219 is as after power-up (SBOS448G, 8.6.2.1), or as the boat sets it up.
_PCA9685_HOLDS: Final = {2: b"\xe2", 3: b"\xe4", 4: b"\xe8", 5: b"\xe0"}
_ADS1115_HOLDS: Final = {2: b"\x80\x00", 3: b"\x7f\xff"}
_INA219_SET_UP: Final = (0x399F, INA219.setup[0][1])
_STRANGE: Final = "it has no number: an INA219 that another program set up, or two parts at one address"

# Of two rows for one address or one use, the upper one comes first. An RM3100 is not looked for: a PCF8574 at
# its address may drive relays, and takes the number of a register for the levels of its outputs.
ROWS: Final = (
    I2cRow(_PCA9685, "pca9685", range(0x40, 0x48), _holds(_PCA9685_HOLDS)),
    I2cRow(COMPASS, "bno055", bno055.ADDRESSES, _holds({0: bytes((bno055.CHIP_ID,))})),
    *(
        I2cRow(key, driver, kind.ADDRESSES, _is_chip(kind))
        for key, kinds in ((COMPASS, MAGNETOMETERS), (IMU, INERTIAL))
        for driver, kind in kinds.items()
        if driver != "rm3100"
    ),
    I2cRow(_BATTERY, "ina228", SHUNT_ADDRESSES, INA228.is_at),
    I2cRow(_BATTERY, "ina226", SHUNT_ADDRESSES, INA226.is_at),
    I2cRow(_BATTERY, "ina219", SHUNT_ADDRESSES, lambda part: part.read_word(0) in _INA219_SET_UP),
    I2cRow(_BATTERY, "ina219", SHUNT_ADDRESSES, lambda part: part.read_word(0) & 0xC000 == 0, _STRANGE),
    I2cRow(_BATTERY, "ads1115", ads1115.ADDRESSES, _holds(_ADS1115_HOLDS), "it may be for probes"),
)
_ADDRESSES: Final = [(row, address) for row in ROWS for address in row.addresses]


def find_i2c_parts() -> Iterator[Found | str]:
    """Parts and remarks, of buses 0 to 9: a Pi's others are those of cameras and displays."""
    buses = sorted(raspberry_pi.ROOT.glob("dev/i2c-[0-9]"))
    if not buses:
        yield "there is no I²C bus; switch it on: sudo raspi-config nonint do_i2c 0"
    for device in buses:
        number = int(device.name.removeprefix("i2c-"))
        try:
            with closing(open_i2c(f"I²C bus {number}", number)) as bus:
                yield from _scan(_ReadingBus(bus), number)
        except HardwareError as error:
            yield str(error)


def _scan(bus: I2cBus, number: int) -> Iterator[Found | str]:
    silent, known = set[int](), set[int]()
    for row, address in _ADDRESSES:
        if address in silent | known:
            continue
        try:
            is_it = row.is_it(Registers(bus, address))
        except OSError as error:
            if error.errno == errno.ETIMEDOUT:
                yield f"I²C bus {number} hangs: a part or a wire holds SDA or SCL low"
                return
            silent.add(address)
            continue
        if is_it:
            known.add(address)
            yield _found(row, number, address)
            if row.driver == "icm20948" and Ak09916.ADDRESSES[0] not in known:  # not connected through yet
                yield Found(COMPASS, "ak09916", f"in the ICM-20948 at {address:#x}", {COMPASS: "ak09916"})
    for address in sorted({address for _, address in _ADDRESSES} - silent - known):
        yield f"{address:#x} on I²C bus {number}: no supported part, or two at one address"


def _found(row: I2cRow, number: int, address: int) -> Found:
    section, _, name = row.key.rpartition(".")
    values: dict[str, Value] = {} if name == "address" else {row.key: row.driver}
    values[f"{section}.{'imu_' if name == 'imu' else ''}address"] = address
    if number != 1:
        values[f"{section}.i2c_bus"] = number
    return Found(row.key, row.driver, f"{address:#x} on I²C bus {number}", values, row.doubt)
