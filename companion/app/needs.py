"""What a configuration needs of the computer, and whether two parts need the same of it."""

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Final, NamedTuple

from companion.config.actuators import PulseOutputSetting
from companion.config.board import HEADER_I2C, I2C_PINS, ONE_WIRE, i2c_device, pwm_channels, uart_pins
from companion.config.boat_config import BoatConfig
from companion.config.payload import WinchPayload
from companion.config.section import Section
from companion.config.sensors import CompassPart
from companion.core.errors import ConfigError
from companion.links.port_url import parse_port_url

# How a driver is connected: a new driver on a bus or a port needs its row here.
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
PORT_DRIVERS = frozenset(
    {"nmea", "bno085", "ubx", "gpsd", "a02yyuw", "tfmini", "ping1d", "serial", "crsf", "ibus", "sbus"}
)
_ECHO_PINS = ("hcsr04", "jsnsr04t")
_ONE_WIRE_FILES = "/sys/bus/w1/"


class PinUse(NamedTuple):
    """A pin, the key of the configuration that uses it, and as what if that is not the key's own value."""

    pin: int
    key: str
    what: str = ""


def pins_in_use(config: BoatConfig) -> Iterator[PinUse]:
    """Of all parts but those on UARTs and I²C buses."""
    parts, sonar = config.parts, config.parts.sonar
    for name, pin in parts.motors.pins(has_right=config.drive.has_pair).items():
        yield PinUse(pin, f"parts.motors.{name}")
    for key, signal in signals_in_use(config):
        if signal.output != "pca9685":
            yield PinUse(signal.pin, key)
    if sonar.driver in _ECHO_PINS:
        yield PinUse(sonar.trigger, "parts.sonar.trigger")
        yield PinUse(sonar.echo, "parts.sonar.echo")
    optional = {
        "parts.sonar.servo": sonar.servo if sonar.driver != "none" else -1,
        "parts.hull.leak": parts.hull.leak if parts.hull.driver != "none" else -1,
        "parts.pca9685.output_enable": parts.pca9685.output_enable,
    }
    yield from (PinUse(pin, key) for key, pin in optional.items() if pin >= 0)
    for index, payload in enumerate(config.payload):
        for name, pin in payload.pins.items():
            yield PinUse(pin, f"payload[{index}].{name}")
    for index, probe in enumerate(config.probe):
        if probe.driver == "file" and probe.path.startswith(_ONE_WIRE_FILES):
            yield PinUse(ONE_WIRE, f"probe[{index}].path", "1-wire")


def signals_in_use(config: BoatConfig) -> Iterator[tuple[str, PulseOutputSetting]]:
    """Keys and settings of the servo and ESC signals."""
    motors, rudder = config.parts.motors, config.parts.rudder
    if motors.driver == "esc":
        yield "parts.motors.left", motors.left
        if config.drive.has_pair:
            yield "parts.motors.right", motors.right
    if rudder.driver != "none":
        yield "parts.rudder.signal", rudder.signal
    for index, payload in enumerate(config.payload):
        if payload.signal_in_use is not None:
            yield f"payload[{index}].signal", payload.signal_in_use


@dataclass(frozen=True, slots=True)
class Needs:
    """By the key that needs them. ports: devices; i2c: devices of buses; pwm: pins of the Pi's own PWM."""

    ports: Mapping[str, str]
    i2c: Mapping[str, str]
    pwm: Mapping[str, int]
    stretches_clock: bool  # a part on the header's bus does


def needs_of(config: BoatConfig) -> Needs:
    """From the drivers that are chosen."""
    ports: dict[str, str] = {}
    i2c: dict[str, str] = {}
    pwm: dict[str, int] = {}
    for key, signal in signals_in_use(config):
        if signal.output == "pca9685":
            i2c[key] = i2c_device(config.parts.pca9685.i2c_bus)
        elif signal.output == "hardware":
            pwm[key] = signal.pin
    for key, driver, section in _drivers(config):
        if driver in I2C_ADDRESSES:
            i2c[key] = _bus(section)
        elif driver in PORT_DRIVERS:
            ports[f"{key}.port"] = getattr(section, "port", "")
    for number, link in enumerate(config.link_settings):
        url = parse_port_url(link.url)
        if url.kind == "serial":
            ports[f"links[{number}]"] = url.place
    devices = {key: port for key, port in ports.items() if port.startswith("/dev/")}
    compass = config.parts.compass
    return Needs(
        devices, i2c, pwm, stretches_clock=compass.part_driver == "bno055" and _bus(compass) == HEADER_I2C
    )


def check_needs(config: BoatConfig, model: str) -> None:
    """No pin, device, signal, PWM channel or address twice; each pin can do what it is used for; motors and
    winches have signals that can be ended.

    model: of the computer; a Pi before the Pi 5 if it is none.

    Raises:
        ConfigError: names both keys.
    """
    needs = needs_of(config)
    _check_signals(config, needs, model)
    check_ports(needs)
    _check_pins(config, needs, model)
    chips: dict[tuple[str, int], tuple[str, str]] = {}
    for key, chip, bus, address in i2c_chips(config):
        other, other_chip = chips.setdefault((bus, address), (key, chip))
        if chip != other_chip or (chip != "ads1115" and key != other):
            raise ConfigError(f"{key}: {address:#x} on I²C belongs to {other}; expected another")


def _check_signals(config: BoatConfig, needs: Needs, model: str) -> None:
    channels: dict[str, str] = {}
    winches = (n for n, one in enumerate(config.payload) if isinstance(one, WinchPayload))
    runs_on = {"parts.motors.left", "parts.motors.right", *(f"payload[{n}].signal" for n in winches)}
    for key, signal in signals_in_use(config):
        if signal.output == "pca9685":
            _claim(channels, f"channel {signal.channel} of the PCA9685", key)
            if key in runs_on and config.parts.pca9685.output_enable < 0:
                raise ConfigError(
                    f"{key}: a PCA9685 goes on with its last pulse when the bus fails; expected OE on a pin, "
                    "parts.pca9685.output_enable, or output = 'hardware'"
                )
        elif signal.pin < 0:
            raise ConfigError(f"{key}.pin: expected the number of a pin")
    of_pins = pwm_channels(model)
    for key, pin in needs.pwm.items():
        if pin not in of_pins:
            raise ConfigError(f"{key}: GPIO {pin} has no hardware PWM; expected 12, 13, 18 or 19")
    for key, pin in needs.pwm.items():
        twin = next((one for one, of in of_pins.items() if of == of_pins[pin] and one != pin), pin)
        other = next((one for one, of in needs.pwm.items() if of == twin != pin), None)
        if other is not None:
            raise ConfigError(
                f"{other}: GPIO {twin} shares a PWM channel with {key}, GPIO {pin}; expected another"
            )


def check_ports(needs: Needs) -> None:
    """No device twice, by whatever name.

    Raises:
        ConfigError: names both keys.
    """
    taken: dict[str, str] = {}
    for key, port in needs.ports.items():
        device = os.path.realpath(port)  # udev's names are links
        other = taken.setdefault(device, key)
        shares_line = key.startswith("probe[") and other.startswith("probe[")  # several numbers of one line
        if other != key and not shares_line:
            raise ConfigError(f"{key}: {port} belongs to {other}; expected another")


def _check_pins(config: BoatConfig, needs: Needs, model: str) -> None:
    buses = (PinUse(pin, key, bus) for key, bus in needs.i2c.items() for pin in I2C_PINS.get(bus, ()))
    uarts = (PinUse(pin, key, port) for key, port in needs.ports.items() for pin in uart_pins(port, model))
    taken: dict[int, PinUse] = {}
    for use in (*buses, *uarts, *pins_in_use(config)):
        other = taken.setdefault(use.pin, use)
        is_shared = bool(use.what) and use.what == other.what  # a bus, or a line with several numbers
        if other.key != use.key and not is_shared:
            owner = f"{other.key}, {other.what}" if other.what else other.key
            raise ConfigError(f"{use.key}: GPIO {use.pin} belongs to {owner}; expected another")


def _claim(taken: dict[str, str], what: str, key: str) -> None:
    if (other := taken.setdefault(what, key)) != key:
        raise ConfigError(f"{key}: {what} belongs to {other}; expected another")


def _bus(section: Section) -> str:
    return i2c_device(getattr(section, "i2c_bus", 1))


def i2c_chips(config: BoatConfig) -> Iterator[tuple[str, str, str, int]]:
    """Key, chip, bus and address of each part on I²C. An ADS1115 may have several keys."""
    compass, pca9685 = config.parts.compass, config.parts.pca9685
    for _, signal in signals_in_use(config):
        if signal.output == "pca9685":
            yield "parts.pca9685.address", "pca9685", _bus(pca9685), pca9685.address
    for key, driver, section in _drivers(config):
        if driver in I2C_ADDRESSES:
            address = getattr(section, "address", 0) or I2C_ADDRESSES[driver]
            yield f"{key}.address", driver, _bus(section), address
    if compass.is_magnetometer and compass.imu != "none":
        address = compass.imu_address or I2C_ADDRESSES[compass.imu]
        yield "parts.compass.imu_address", compass.imu, _bus(compass), address


def _drivers(config: BoatConfig) -> Iterator[tuple[str, str, Section]]:
    """Key, driver and section of each part."""
    for name in config.parts.__struct_fields__:
        value = getattr(config.parts, name)
        if not isinstance(value, Section):
            continue
        if isinstance(value, CompassPart):
            yield "parts.compass", value.part_driver, value
            continue
        for number, one in enumerate(value if isinstance(value, tuple) else (value,)):
            key = f"parts.{name}[{number}]" if isinstance(value, tuple) else f"parts.{name}"
            yield key, getattr(one, "driver", ""), one
    yield "rc", config.rc.driver, config.rc
    for number, probe in enumerate(config.probe):
        yield f"probe[{number}]", probe.driver, probe
