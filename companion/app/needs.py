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
from companion.hal import ads1115
from companion.hal.battery import SHUNT_ADDRESSES, SHUNT_CHIPS
from companion.hal.heading import bno055
from companion.hal.heading.inertial import INERTIAL
from companion.hal.heading.magnetometers import MAGNETOMETERS
from companion.links.port_url import line_url, parse_port_url

# How a driver is connected: a new driver on a bus or a port needs its row here.
I2C_ADDRESSES: Final = {  # where the configuration gives none
    "bno055": bno055.ADDRESSES[0],
    **{driver: chip.ADDRESSES[0] for chips in (MAGNETOMETERS, INERTIAL) for driver, chip in chips.items()},
    **dict.fromkeys(SHUNT_CHIPS, SHUNT_ADDRESSES[0]),
    "ads1115": ads1115.ADDRESSES[0],
}
PORT_DRIVERS = frozenset(
    {"nmea", "bno085", "ubx", "a02yyuw", "tfmini", "ld06", "rplidar_a1", "ping1d", "serial"}
    | {"crsf", "ibus", "sbus"}
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
    if rudder.driver == "servo":
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
    """From the drivers that are chosen. A ConfigError names the key of a port that is none."""
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
    reporting = config.parts.motors.ports(has_right=config.drive.has_pair)
    ports |= {f"parts.motors.{key}": port for key, port in reporting.items()}
    urls = {key: line_url(port) for key, port in ports.items()}
    urls |= {f"links[{number}]": link.url for number, link in enumerate(config.link_settings)}
    if autopilot := config.parts.autopilot_part.url:
        urls["parts.autopilot"] = autopilot
    devices: dict[str, str] = {}
    for key, text in urls.items():
        try:
            url = parse_port_url(text)
        except ConfigError as error:
            raise ConfigError(f"{key}: {error}") from None
        if url.place.startswith("/dev/"):
            devices[key] = url.place
    compass = config.parts.compass
    return Needs(
        devices, i2c, pwm, stretches_clock=compass.part_driver == "bno055" and _bus(compass) == HEADER_I2C
    )


class _Claims:
    """Who owns a thing: whoever claims it first."""

    def __init__(self) -> None:
        self._owners: dict[object, tuple[str, str]] = {}

    def claim(self, thing: object, name: str, key: str, use: str = "", *, is_shared: bool = False) -> None:
        """use: as what, if that is not the key's own value. is_shared: by all with the same use."""
        other, other_use = self._owners.setdefault(thing, (key, use))
        if other != key and not (is_shared and use == other_use):
            owner = f"{other}, {other_use}" if other_use else other
            raise ConfigError(f"{key}: {name} belongs to {owner}; expected another")


def check_needs(config: BoatConfig, model: str) -> None:
    """No pin, device, signal, PWM channel or address twice; each pin can do what it is used for; motors and
    winches have signals that can be ended.

    model: of the computer; a Pi before the Pi 5 if it is none. A ConfigError names both keys.
    """
    needs, claims = needs_of(config), _Claims()
    winches = (n for n, one in enumerate(config.payload) if isinstance(one, WinchPayload))
    runs_on = {"parts.motors.left", "parts.motors.right", *(f"payload[{n}].signal" for n in winches)}
    for key, signal in signals_in_use(config):
        if signal.output == "pca9685":
            claims.claim(("channel", signal.channel), f"channel {signal.channel} of the PCA9685", key)
            if key in runs_on and config.parts.pca9685.output_enable < 0:
                raise ConfigError(
                    f"{key}: a PCA9685 goes on with its last pulse when the bus fails; expected OE on a pin, "
                    "parts.pca9685.output_enable, or output = 'hardware'"
                )
        elif signal.pin < 0:
            raise ConfigError(f"{key}.pin: expected the number of a pin")
    _check_pwm(needs.pwm, pwm_channels(model))
    check_ports(needs)
    buses = (PinUse(pin, key, bus) for key, bus in needs.i2c.items() for pin in I2C_PINS.get(bus, ()))
    uarts = (PinUse(pin, key, port) for key, port in needs.ports.items() for pin in uart_pins(port, model))
    for pin, key, what in (*buses, *uarts, *pins_in_use(config)):
        claims.claim(pin, f"GPIO {pin}", key, what, is_shared=bool(what))  # a bus, or a line of several parts
    for key, chip, bus, address in i2c_chips(config):
        claims.claim((bus, address), f"{address:#x} on I²C", key, chip, is_shared=chip == "ads1115")


def _check_pwm(pins: Mapping[str, int], channels: Mapping[int, int]) -> None:
    for key, pin in pins.items():
        if pin not in channels:
            raise ConfigError(f"{key}: GPIO {pin} has no hardware PWM; expected 12, 13, 18 or 19")
    for key, pin in pins.items():
        twin = next((one for one, of in channels.items() if of == channels[pin] and one != pin), pin)
        other = next((one for one, of in pins.items() if of == twin != pin), None)
        if other is not None:
            raise ConfigError(
                f"{other}: GPIO {twin} shares a PWM channel with {key}, GPIO {pin}; expected another"
            )


def check_ports(needs: Needs) -> None:
    """No device twice, by whatever name, but for probes on one line. A ConfigError names both keys."""
    claims = _Claims()
    for key, port in needs.ports.items():
        use = "a line of probes" if key.startswith("probe[") else ""
        claims.claim(os.path.realpath(port), port, key, use, is_shared=bool(use))  # udev's names are links


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
        if compass.imu == "icm20948" and compass.part_driver != "ak09916":  # its own is connected through
            yield "parts.compass.imu", "ak09916", _bus(compass), I2C_ADDRESSES["ak09916"]


def _drivers(config: BoatConfig) -> Iterator[tuple[str, str, Section]]:
    parts = {f"parts.{name}": getattr(config.parts, name) for name in config.parts.__struct_fields__}
    probes = {f"probe[{number}]": probe for number, probe in enumerate(config.probe)}
    for key, part in {**parts, "rc": config.rc, **probes}.items():
        driver = part.part_driver if isinstance(part, CompassPart) else getattr(part, "driver", "")
        if driver:
            yield key, driver, part
