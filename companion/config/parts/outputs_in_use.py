"""Which pins and signals the configuration uses: no two parts on one."""

from collections.abc import Iterator

from companion.config.boat_config import BoatConfig
from companion.config.parts import MotorsPart, PulseOutputSetting
from companion.core.errors import ConfigError

_PAYLOAD_PINS = ("pin", "out_pin", "in_pin", "count_pin")


def check_outputs(config: BoatConfig) -> None:
    """No pin and no signal twice, a pin for each signal, and motors only on signals that can be ended.

    Raises:
        ConfigError: names both keys.
    """
    taken: dict[str, str] = {}
    for key, output in outputs_in_use(config):
        if output == "GPIO -1":
            raise ConfigError(f"{key}.pin: expected the number of a pin")
        if (other := taken.setdefault(output, key)) != key:
            raise ConfigError(f"{key}: {output} belongs to {other}; expected another")
    for key, signal in signals_in_use(config):
        is_motor = key.startswith("parts.motors.")
        if is_motor and signal.output == "pca9685" and config.parts.pca9685.output_enable < 0:
            raise ConfigError(
                f"{key}: a PCA9685 goes on with its last pulse when the bus fails; expected OE on a pin, "
                "parts.pca9685.output_enable, or output = 'hardware'"
            )


def outputs_in_use(config: BoatConfig) -> Iterator[tuple[str, str]]:
    """Keys, and the pin or signal of each."""
    parts = config.parts
    yield from _of_bridges(parts.motors, has_right=config.drive.has_pair)
    for key, signal in signals_in_use(config):
        is_chip = signal.output == "pca9685"
        yield key, f"channel {signal.channel} of the PCA9685" if is_chip else f"GPIO {signal.pin}"
    if parts.sonar.driver in ("hcsr04", "jsnsr04t"):
        yield "parts.sonar.trigger", f"GPIO {parts.sonar.trigger}"
        yield "parts.sonar.echo", f"GPIO {parts.sonar.echo}"
    if parts.sonar.driver != "none" and parts.sonar.servo >= 0:
        yield "parts.sonar.servo", f"GPIO {parts.sonar.servo}"
    if parts.hull.driver != "none" and parts.hull.leak >= 0:
        yield "parts.hull.leak", f"GPIO {parts.hull.leak}"
    if parts.pca9685.output_enable >= 0:
        yield "parts.pca9685.output_enable", f"GPIO {parts.pca9685.output_enable}"
    for index, payload in enumerate(config.payload):
        key = f"payload[{index}]"
        pins = [(f"{key}.{name}", getattr(payload, name, None)) for name in _PAYLOAD_PINS]
        yield from ((name, f"GPIO {pin}") for name, pin in pins if pin is not None)


def signals_in_use(config: BoatConfig) -> Iterator[tuple[str, PulseOutputSetting]]:
    """Keys and settings of the servo and ESC signals. A payload with pins of its own takes no signal."""
    motors, rudder = config.parts.motors, config.parts.rudder
    if motors.driver == "esc":
        for side in _sides(config.drive.has_pair):
            yield f"parts.motors.{side}", getattr(motors, side)
    if rudder.driver != "none":
        yield "parts.rudder.signal", rudder.signal
    for index, payload in enumerate(config.payload):
        signal = getattr(payload, "signal", None)
        has_pins = any(getattr(payload, name, None) is not None for name in _PAYLOAD_PINS[:3])
        if isinstance(signal, PulseOutputSetting) and not has_pins:
            yield f"payload[{index}].signal", signal


def _of_bridges(part: MotorsPart, *, has_right: bool) -> Iterator[tuple[str, str]]:
    if part.driver in ("none", "esc"):
        return
    names = ("forward", "backward") if part.driver == "drv8833" else ("forward", "backward", "enable")
    for side in _sides(has_right):
        for name in names:
            yield f"parts.motors.{side}_{name}", f"GPIO {getattr(part, f'{side}_{name}')}"


def _sides(has_right: bool) -> tuple[str, ...]:
    return ("left", "right") if has_right else ("left",)
