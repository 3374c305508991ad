"""Calibration of a bare magnetometer from the command line, while the boat's program is stopped.

The running boat does the same for a ground station (`companion.services.commands.compass`).
"""

from collections.abc import Callable
from contextlib import closing
from pathlib import Path

from companion.app.clock import Clock
from companion.app.parts import open_compass
from companion.app.status_file import find_status, read_status
from companion.calibration.compass import CompassCalibration, CompassVerdict
from companion.config.boat_config import BoatConfig
from companion.config.parameter_table import ROWS
from companion.config.parameters import Parameters
from companion.core.errors import BoatError, ConfigError, HardwareError
from companion.core.storage import Storage
from companion.sensors.compass.magnetic_field import FieldCorrector
from companion.sensors.compass.parameters import compass_hooks, parameter_values

_PERIOD_S = 0.02
_STEP_PERCENT = 10


def calibrate_compass(
    config: BoatConfig, storage: Storage, clock: Clock, say: Callable[[str], object]
) -> None:
    """Collect the field while the operator turns the boat, and store the result.

    Raises:
        ConfigError: there is nothing to calibrate, or nowhere to keep the result.
        HardwareError: the part does not answer, the boat's program runs, or the calibration has failed.
    """
    part = config.parts.compass
    if not part.is_magnetometer:
        raise ConfigError(f"parts.compass.driver = {part.driver!r}: expected a magnetometer")
    if not config.storage.folder:
        raise ConfigError("storage.folder: the boat keeps no parameters; expected a folder")
    if _is_boat_running(config):
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


def _is_boat_running(config: BoatConfig) -> bool:
    try:
        return Path(f"/proc/{read_status(find_status(config)).process}").exists()
    except BoatError:
        return False
