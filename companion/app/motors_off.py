"""Stop the motors from outside the program: what its unit runs after it, however it ended.

    python -m companion.app.motors_off /etc/mavboat/boat.toml

A killed program leaves its pins and pulses as they were, and the motors run on: lgpio's PWM ends with the
process and leaves its pin high or low, the Pi's PWM and a PCA9685 go on. Bridges get their enable pins low,
or all inputs where they have none. Speed controllers get neutral for some pulses, since they run on for up to
two seconds without, and then none; a software signal has ended with the program, its pin is driven low.
Winches stop; relays, lights and horns are switched off. This loads nothing but the configuration and the part
that is needed: it has to be quick. A file that cannot be read stands for a boat with the default pins.
"""

import shutil
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path
from time import sleep

from companion.config.boat_config import BoatConfig, load_config
from companion.config.parts import MotorsPart, Parts, Pca9685Part, PulseOutputSetting
from companion.config.parts.payload import PayloadSetting, RelayPayload, WinchPayload
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
    motors, stopped = config.parts.motors, True
    if motors.driver == "esc":
        signals = (motors.left, motors.right) if config.drive.has_pair else (motors.left,)
        stopped = _end_signals(signals, config.parts.pca9685)
    elif motors.driver != "none":
        stopped = _drive(motors.stop_pins(has_right=config.drive.has_pair), _LOW)
    stopped &= _stop_payload(config.payload, config.parts.pca9685)
    return code if stopped else 1


def _stop_payload(payloads: Iterable[PayloadSetting], chip: Pca9685Part) -> bool:
    """Winches stopped; relays, lights and horns off."""
    levels: dict[str, list[int]] = {_LOW: [], _HIGH: []}
    signals: list[PulseOutputSetting] = []
    for one in payloads:
        if isinstance(one, RelayPayload):
            levels[_HIGH if one.active_low else _LOW].append(one.pin)
        elif isinstance(one, WinchPayload):
            levels[_LOW] += [pin for name, pin in one.pins.items() if name != "count_pin"]
            signals += () if one.signal_in_use is None else (one.signal_in_use,)
    stopped = [_drive(pins, level) for level, pins in levels.items() if pins]
    return all(stopped) and (not signals or _end_signals(signals, chip))


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


def _end_signals(signals: Iterable[PulseOutputSetting], chip: Pca9685Part) -> bool:
    """Neutral on all that still have pulses, then the end of the pulses."""
    still = [signal for signal in signals if signal.output != "software"]
    pins = [signal.pin for signal in signals if signal.output == "software"]
    stopped = _drive(pins, _LOW) if pins else True
    for is_end in (False, True):
        for signal in still:
            try:
                _replace(signal, 0.0 if is_end else signal.trim_us, chip)
            except (OSError, HardwareError) as error:
                sys.stderr.write(f"motors_off: {error}\n")
                stopped = False
        if still and not is_end:
            sleep(_LAST_PULSES / min(chip.frequency_hz, *(signal.frequency_hz for signal in still)))
    return stopped


def _replace(signal: PulseOutputSetting, width_us: float, chip: Pca9685Part) -> None:
    if signal.output == "hardware":
        from companion.hal.pulses.sysfs_pwm import replace_sysfs_pulses  # noqa: PLC0415 — only what is needed

        replace_sysfs_pulses(signal.pin, width_us)
    else:
        from companion.hal.pulses.pca9685 import replace_pca9685_pulses  # noqa: PLC0415

        replace_pca9685_pulses(signal.channel, width_us, chip)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
