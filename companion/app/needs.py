"""What a configuration needs of the computer."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from companion.config.boat_config import BoatConfig
from companion.config.parts import PulseOutputSetting
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
    for key, section in _sections(config):
        driver = getattr(section, "driver", "")
        if isinstance(section, PulseOutputSetting):
            if section.output == "pca9685":
                i2c.append(key)
            elif section.output == "hardware":
                pwm[key] = section.pin
        elif driver in I2C_DRIVERS:
            i2c.append(key)
        elif driver in PORT_DRIVERS:
            ports[f"{key}.port"] = getattr(section, "port", "")
    for number, link in enumerate(config.link_settings):
        url = parse_port_url(link.url)
        if url.kind == "serial":
            ports[f"links[{number}]"] = url.place
    devices = {key: port for key, port in ports.items() if port.startswith("/dev/")}
    return Needs(devices, i2c, pwm, stretches_clock=config.parts.compass.driver == "bno055")


def i2c_chips(config: BoatConfig) -> Iterator[tuple[str, str, int]]:
    """Key, chip and address of each part on the bus. An ADS1115 may have several keys."""
    compass = config.parts.compass
    for key, section in _sections(config):
        driver = getattr(section, "driver", "")
        if driver in I2C_ADDRESSES:
            yield f"{key}.address", driver, getattr(section, "address", 0) or I2C_ADDRESSES[driver]
        elif isinstance(section, PulseOutputSetting) and section.output == "pca9685":
            yield "parts.pca9685.address", "pca9685", config.parts.pca9685.address
    if compass.is_magnetometer and compass.imu != "none":
        yield "parts.compass.imu_address", compass.imu, compass.imu_address or I2C_ADDRESSES[compass.imu]


def _sections(config: BoatConfig) -> Iterator[tuple[str, Section]]:
    for name in config.parts.__struct_fields__:
        value = getattr(config.parts, name)
        for number, one in enumerate(value if isinstance(value, tuple) else (value,)):
            yield from _used(f"parts.{name}[{number}]" if isinstance(value, tuple) else f"parts.{name}", one)
    yield "rc", config.rc
    for number, probe in enumerate(config.probe):
        yield f"probe[{number}]", probe
    for number, payload in enumerate(config.payload):
        yield from _used(f"payload[{number}]", payload)


def _used(key: str, section: Section) -> Iterator[tuple[str, Section]]:
    """A section, and its signals as far as they are in use."""
    driver = getattr(section, "driver", "")
    yield key, section
    has_pins = getattr(section, "pin", None) is not None or getattr(section, "out_pin", None) is not None
    if driver not in ("", "esc", "servo") or has_pins:
        return
    for name in section.__struct_fields__:
        value = getattr(section, name)
        if isinstance(value, PulseOutputSetting):
            yield f"{key}.{name}", value
