"""Which pins and servo signals the configuration uses."""

from collections.abc import Iterator
from typing import NamedTuple

from companion.config.actuators import PulseOutputSetting
from companion.config.board import ONE_WIRE
from companion.config.boat_config import BoatConfig

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
