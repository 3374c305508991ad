"""Calibration from the command line, while the boat's program is stopped: of a bare magnetometer, as the
running boat does it for a ground station, and of speed controllers (ESCs).

An ESC that is switched on at full throttle learns instead of arming. What it takes next differs: the shortest
pulse (forward only; BLHeli manual, "Throttle range calibration"), or full astern and stop, in an order of its
own. So the operator chooses each pulse, by the ESC's manual.
"""

import time
from collections.abc import Callable
from contextlib import ExitStack, closing

from companion.app.parts import open_compass
from companion.app.runner import Clock
from companion.app.status_file import running_boat
from companion.calibration.compass import CompassCalibration, CompassVerdict
from companion.config.actuators import PulseOutputSetting
from companion.config.boat_config import BoatConfig
from companion.config.parameter_table import ROWS
from companion.config.parameters import Parameters
from companion.core.errors import ConfigError, HardwareError
from companion.core.storage import Storage
from companion.hal.interfaces import PulseOutput
from companion.sensors.compass.magnetic_field import FieldCorrector, compass_hooks, parameter_values

_PERIOD_S = 0.02
_STEP_PERCENT = 10
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


def calibrate_compass(
    config: BoatConfig, storage: Storage, clock: Clock, say: Callable[[str], object]
) -> None:
    """Collect the field while the operator turns the boat, and store the result. Raises ConfigError: there is
    nothing to calibrate, or nowhere to keep the result. HardwareError: the part does not answer, the boat's
    program runs, or the calibration has failed.
    """
    part = config.parts.compass
    if not part.is_magnetometer:
        raise ConfigError(f"parts.compass.driver = {part.driver!r}: expected a magnetometer")
    if not config.storage.folder:
        raise ConfigError("storage.folder: the boat keeps no parameters; expected a folder")
    if running_boat(config) is not None:
        raise HardwareError("the boat's program uses the compass: sudo systemctl stop mavboat")
    corrector = FieldCorrector()
    parameters = Parameters(config, ROWS, storage, compass_hooks(corrector))
    most_fitness = next(parameters.value(row) for row in parameters.rows if row.name == "COMPASS_CAL_FIT")
    with closing(open_compass(config, clock.now_s, corrector)) as compass:
        say("Turn the boat slowly through a full circle on the water, or in the hands about all axes.")
        calibration = CompassCalibration(corrector.correction, None, clock.now_s())
        told = 0
        while not calibration.is_complete:
            now_s = clock.now_s()
            if calibration.is_late(now_s):
                seen = calibration.progress_percent
                raise HardwareError(f"compass: only {seen} % of the directions were seen")
            calibration.update(compass.read(), now_s)
            if calibration.progress_percent >= told + _STEP_PERCENT:
                told = calibration.progress_percent // _STEP_PERCENT * _STEP_PERCENT
                say(f"{told} %")
            clock.sleep(_PERIOD_S)
    fit = calibration.solve(most_fitness)
    if fit.verdict is not CompassVerdict.SUCCESS:
        raise HardwareError(f"compass not calibrated: {fit.reason}")
    if reasons := parameters.set_many(parameter_values(fit.correction)):
        raise HardwareError(f"compass not calibrated: {reasons[0]}")
    x, y, z = fit.correction.offset
    say(f"Calibrated: offsets {x:.0f}, {y:.0f}, {z:.0f} mG, error {fit.fitness_mg:.1f} mG")


def calibrate_escs(
    config: BoatConfig,
    open_output: Callable[[PulseOutputSetting], PulseOutput],
    ask: Callable[[str], str],
    wait: Callable[[float], None] = time.sleep,
) -> bool:
    """Send the pulses that the operator asks for, to all motors at once; False if it was not confirmed.

    Neutral is sent before the pulses end, also after Ctrl-C. Raises ConfigError: the motors have no speed
    controllers. HardwareError: a signal cannot be opened, or failed.
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
