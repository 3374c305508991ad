"""Whether a magnetometer is calibrated, by the boat's stored parameters."""

from pathlib import Path

from companion.app.doctor.findings import Examined, Finding, Verdict
from companion.config.parameter_table import ROWS
from companion.config.parameters import PARAMETER_FILE, Parameters
from companion.core.generations import find_newest
from companion.core.storage import MemoryStorage
from companion.sensors.compass.magnetic_field import BY_CURRENT, NO_MOTORS, FieldCorrector
from companion.sensors.compass.parameters import compass_hooks


def check_compass_calibration(examined: Examined) -> list[Finding]:
    """Nothing for parts that calibrate themselves."""
    config = examined.config
    if not config.parts.compass.is_magnetometer or not config.storage.folder:
        return []
    storage, corrector = MemoryStorage(), FieldCorrector()
    path = examined.path(str(Path(config.storage.folder).expanduser() / PARAMETER_FILE))
    try:
        storage.save(PARAMETER_FILE, find_newest(path).generation.content)
    except OSError as error:
        return [Finding("compass calibration", Verdict.WARNING, f"{path}: {error.strerror}")]
    Parameters(config, ROWS, storage, compass_hooks(corrector))
    correction = corrector.correction
    if not correction.is_calibrated:
        cure = "turn the boat with boat-companion calibrate-compass, or from QGroundControl's compass page"
        return [Finding("compass calibration", Verdict.WARNING, "none: only MANUAL and HOLD arm", cure)]
    offsets = ", ".join(f"{one:.0f}" for one in correction.offset)
    source = "current" if correction.motor_source == BY_CURRENT else "throttle"
    motors = "not measured" if correction.motor_source == NO_MOTORS else f"by {source}"
    return [Finding("compass calibration", Verdict.FINE, f"offsets {offsets} mG; motors' field {motors}")]
