"""Stop the motors from outside the program: what its unit runs after it, however it ended.

    python -m companion.app.motors_off /etc/mavboat/boat.toml

A killed program leaves its pins and pulses as they were, and the motors run on: lgpio's PWM ends with the
process and leaves its pin high or low, the Pi's PWM and a PCA9685 go on. Bridges get their enable pins low,
or all inputs where they have none. Speed controllers get neutral for some pulses, since they run on for up to
two seconds without, and then none; a software signal has ended with the program, its pin is driven low. The
pin at OE of a PCA9685 is driven high, which ends its pulses also where its bus does not answer. Winches stop;
relays, lights and horns are switched off. This loads nothing but the configuration and the part that is
needed: it has to be quick. A file that cannot be read stands for a boat with the default pins.
"""

import shutil
import subprocess
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from time import sleep
from typing import NamedTuple

from companion.config.actuators import MotorsPart, Pca9685Part, PulseOutputSetting
from companion.config.boat_config import BoatConfig, Parts, load_config
from companion.config.payload import RelayPayload, WinchPayload
from companion.core.errors import ConfigError, HardwareError

_PINCTRL = "pinctrl"  # of Raspberry Pi OS; "op dl" is output, driven low
_LOW, _HIGH = "dl", "dh"
_LONGEST_S = 5.0
_LAST_PULSES = 3  # neutral ones, before the end


def main(arguments: list[str]) -> int:
    """The exit code: 0 done, 1 a motor could not be stopped, 2 the file cannot be used."""
    if len(arguments) != 1:
        sys.stderr.write("motors_off: expected the boat's TOML file\n")
        return 2
    code, config = 0, BoatConfig(parts=Parts(motors=MotorsPart(driver="l298n")))
    try:
        config = load_config(Path(arguments[0]))
    except ConfigError as error:
        sys.stderr.write(f"motors_off: {error}; taking the default pins\n")
        code = 2
    stopped = [_end(outputs, config.parts.pca9685) for outputs in outputs_to_end(config)]
    if all(stopped):
        return code
    sys.stderr.write("motors_off: a motor may still be running: switch the boat off\n")
    return 1


class Outputs(NamedTuple):
    """low, high: pins that end at this level. signals: those that go on after a kill."""

    low: list[int]
    high: list[int]
    signals: list[PulseOutputSetting]


def outputs_to_end(config: BoatConfig) -> list[Outputs]:
    """Those of the motors, then those of the payload: winches stopped; relays, lights and horns off."""
    motors, has_pair, chip = config.parts.motors, config.drive.has_pair, config.parts.pca9685
    pins, signals = list[int](), list[PulseOutputSetting]()
    if motors.driver == "esc":
        signals = [motors.left, motors.right][: 1 + has_pair]
    elif motors.driver != "none":
        pins = motors.stop_pins(has_right=has_pair)
    relays = [one for one in config.payload if isinstance(one, RelayPayload)]
    winches = [one for one in config.payload if isinstance(one, WinchPayload)]
    off = [relay.pin for relay in relays if not relay.active_low]
    off += [pin for winch in winches for name, pin in winch.pins.items() if name != "count_pin"]
    return [
        _outputs(pins, [], signals, chip),
        _outputs(
            off,
            [relay.pin for relay in relays if relay.active_low],
            [winch.signal_in_use for winch in winches if winch.signal_in_use is not None],
            chip,
        ),
    ]


def _outputs(
    low: list[int], high: list[int], signals: list[PulseOutputSetting], chip: Pca9685Part
) -> Outputs:
    """A software signal has ended with the program: its pin is driven low. High at OE ends the chip's."""
    pins = [signal.pin for signal in signals if signal.output == "software"]
    if chip.output_enable >= 0 and any(signal.output == "pca9685" for signal in signals):
        high = [*high, chip.output_enable]
    return Outputs(low + pins, high, [signal for signal in signals if signal.output != "software"])


def _end(outputs: Outputs, chip: Pca9685Part) -> bool:
    low = not outputs.low or _drive(outputs.low, _LOW)
    going_on = _end_signals(outputs.signals, chip)  # before OE: neutral stops a speed controller at once
    high = not outputs.high or _drive(outputs.high, _HIGH)
    if high and chip.output_enable in outputs.high:
        going_on.discard("pca9685")
    return low and high and not going_on


def _drive(pins: Iterable[int], level: str) -> bool:
    text = ",".join(map(str, pins))
    try:
        program = shutil.which(_PINCTRL)
        if program is None:
            raise FileNotFoundError(f"{_PINCTRL} is not installed")
        subprocess.run([program, "set", text, "op", level], check=True, timeout=_LONGEST_S)  # noqa: S603
    except (OSError, subprocess.SubprocessError) as error:
        sys.stderr.write(f"motors_off: pins {text}: {error}\n")
        return False
    return True


def _end_signals(signals: Sequence[PulseOutputSetting], chip: Pca9685Part) -> set[str]:
    """Neutral on all, then the end of the pulses. Returns the outputs that could not be ended."""
    going_on: set[str] = set()
    for is_end in (False, True):
        for signal in signals:
            try:
                _replace(signal, 0.0 if is_end else signal.trim_us, chip)
            except (OSError, HardwareError) as error:
                sys.stderr.write(f"motors_off: {error}\n")
                going_on.add(signal.output)
        if signals and not is_end:
            sleep(_LAST_PULSES / min(chip.frequency_hz, *(signal.frequency_hz for signal in signals)))
    return going_on


def _replace(signal: PulseOutputSetting, width_us: float, chip: Pca9685Part) -> None:
    if signal.output == "hardware":
        from companion.hal.pulses.sysfs_pwm import replace_sysfs_pulses  # noqa: PLC0415 — only what is needed

        replace_sysfs_pulses(signal.pin, width_us)
    else:
        from companion.hal.pulses.pca9685 import replace_pca9685_pulses  # noqa: PLC0415

        replace_pca9685_pulses(signal.channel, width_us, chip)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
