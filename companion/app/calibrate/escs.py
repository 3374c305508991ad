"""Calibration of speed controllers (ESCs): teaches them the pulses of full ahead, stop and full astern.

An ESC that is switched on at full throttle learns instead of arming. What it takes next differs: the shortest
pulse (forward only; BLHeli manual, "Throttle range calibration"), or full astern and stop, in an order of its
own. So the operator chooses each pulse, by the ESC's manual.
"""

import time
from collections.abc import Callable
from contextlib import ExitStack

from companion.config.boat_config import BoatConfig
from companion.config.parts import PulseOutputSetting
from companion.core.errors import ConfigError
from companion.hal.interfaces import PulseOutput

CONFIRMATION = "propellers off"
_LAST_PULSES_S = 0.1

_INTRODUCTION = f"""This sends full throttle to the speed controllers.
 1. Stop the boat's program: sudo systemctl stop mavboat
 2. Take the propellers off, and disconnect the pack from the speed controllers.
Type "{CONFIRMATION}" when that is done: """

_HELP = """Signals: high = {high} µs, neutral = {neutral} µs, low = {low} µs; end stops.
 Forward only: high, connect the pack, wait for the beeps, low, wait for the beeps, end.
 With reverse: by its manual; often high, connect the pack, low, neutral, waiting for the beeps after each.
"""


def calibrate_escs(
    config: BoatConfig,
    open_output: Callable[[PulseOutputSetting], PulseOutput],
    ask: Callable[[str], str],
    wait: Callable[[float], None] = time.sleep,
) -> bool:
    """Send the pulses that the operator asks for, to all motors at once; False if it was not confirmed.

    Neutral is sent before the pulses end, also after Ctrl-C.

    Raises:
        ConfigError: the motors have no speed controllers.
        HardwareError: a signal cannot be opened, or failed.
    """
    part = config.parts.motors
    if part.driver != "esc":
        raise ConfigError(f"parts.motors.driver = {part.driver!r}: expected 'esc'")
    if ask(_INTRODUCTION).strip().lower() != CONFIRMATION:
        return False
    settings = (part.left, part.right) if config.drive.has_pair else (part.left,)
    with ExitStack() as ending:
        outputs: list[tuple[PulseOutput, PulseOutputSetting]] = []
        for setting in settings:
            output = open_output(setting)
            ending.callback(output.close)
            outputs.append((output, setting))
        ending.callback(wait, _LAST_PULSES_S)
        for output, setting in outputs:
            ending.callback(output.write_us, setting.trim_us)
        text = _HELP.format(high=part.left.max_us, neutral=part.left.trim_us, low=part.left.min_us)
        while (chosen := ask(f"{text}high, neutral, low or end: ").strip().lower()) != "end":
            text = "" if chosen in ("high", "neutral", "low") else f"{chosen!r}: no such signal\n"
            for output, setting in outputs:
                match chosen:
                    case "high":
                        output.write_us(setting.max_us)
                    case "neutral":
                        output.write_us(setting.trim_us)
                    case "low":
                        output.write_us(setting.min_us)
    return True
