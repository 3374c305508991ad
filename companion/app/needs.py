"""What a configuration needs of the computer."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from companion.config.boat_config import BoatConfig
from companion.config.parts import CompassPart
from companion.config.parts.outputs_in_use import signals_in_use
from companion.config.section import Section
from companion.links.port_url import parse_port_url

# How a driver is connected. A test compares them with the configuration's: a new driver needs its row here.
I2C_ADDRESSES: Final = {  # where the configuration gives none
    "bno055": 0x28,
    "qmc5883l": 0x0D,
    "qmc5883p": 0x2C,
    "hmc5883l": 0x1E,
    "lis3mdl": 0x1C,
    "mpu6050": 0x68,
    "lsm6ds": 0x6A,
    "ina219": 0x40,
    "ina226": 0x40,
    "ina228": 0x40,
    "ads1115": 0x48,
}
I2C_DRIVERS = frozenset(I2C_ADDRESSES)
PORT_DRIVERS = frozenset(
    {"nmea", "bno085", "ubx", "gpsd", "a02yyuw", "tfmini", "ping1d", "serial", "crsf", "ibus", "sbus"}
)
OTHER_DRIVERS = frozenset(
    {
        "none",
        "l298n",
        "tb6612",
        "bts7960",
        "drv8833",
        "esc",
        "servo",
        "hcsr04",
        "jsnsr04t",
        "host",
        "file",
        "gnss",
    }
)


@dataclass(frozen=True, slots=True)
class Needs:
    """By the key that needs them. ports: devices; i2c: parts on the bus; pwm: pins of the Pi's own PWM."""

    ports: Mapping[str, str]
    i2c: Sequence[str]
    pwm: Mapping[str, int]
    stretches_clock: bool  # a part on the bus does


def needs_of(config: BoatConfig) -> Needs:
    """From the drivers that are chosen."""
    ports: dict[str, str] = {}
    i2c: list[str] = []
    pwm: dict[str, int] = {}
    for key, signal in signals_in_use(config):
        if signal.output == "pca9685":
            i2c.append(key)
        elif signal.output == "hardware":
            pwm[key] = signal.pin
    for key, driver, section in _drivers(config):
        if driver in I2C_DRIVERS:
            i2c.append(key)
        elif driver in PORT_DRIVERS:
            ports[f"{key}.port"] = getattr(section, "port", "")
    for number, link in enumerate(config.link_settings):
        url = parse_port_url(link.url)
        if url.kind == "serial":
            ports[f"links[{number}]"] = url.place
    devices = {key: port for key, port in ports.items() if port.startswith("/dev/")}
    return Needs(devices, i2c, pwm, stretches_clock=config.parts.compass.part_driver == "bno055")


def i2c_chips(config: BoatConfig) -> Iterator[tuple[str, str, int]]:
    """Key, chip and address of each part on the bus. An ADS1115 may have several keys."""
    compass = config.parts.compass
    for _, signal in signals_in_use(config):
        if signal.output == "pca9685":
            yield "parts.pca9685.address", "pca9685", config.parts.pca9685.address
    for key, driver, section in _drivers(config):
        if driver in I2C_ADDRESSES:
            yield f"{key}.address", driver, getattr(section, "address", 0) or I2C_ADDRESSES[driver]
    if compass.is_magnetometer and compass.imu != "none":
        yield "parts.compass.imu_address", compass.imu, compass.imu_address or I2C_ADDRESSES[compass.imu]


def _drivers(config: BoatConfig) -> Iterator[tuple[str, str, Section]]:
    """Key, driver and section of each part."""
    for name in config.parts.__struct_fields__:
        value = getattr(config.parts, name)
        if isinstance(value, CompassPart):
            yield "parts.compass", value.part_driver, value
            continue
        for number, one in enumerate(value if isinstance(value, tuple) else (value,)):
            key = f"parts.{name}[{number}]" if isinstance(value, tuple) else f"parts.{name}"
            yield key, getattr(one, "driver", ""), one
    yield "rc", config.rc.driver, config.rc
    for number, probe in enumerate(config.probe):
        yield f"probe[{number}]", probe.driver, probe
