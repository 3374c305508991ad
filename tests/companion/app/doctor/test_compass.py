"""The doctor's line on the calibration of a magnetometer."""

import pytest
from doctor_tree import Examine

from companion.app.doctor.findings import Verdict
from companion.app.doctor.parts import check_compass_calibration
from companion.config.boat_config import BoatConfig, Parts, StorageSetting
from companion.config.sensors import CompassPart
from companion.core.generations import Generation, seal

pytest_plugins = ("doctor_fixtures",)

BOAT = BoatConfig(
    parts=Parts(compass=CompassPart(driver="qmc5883l")), storage=StorageSetting(folder="/var/lib/mavboat")
)
CALIBRATED = "COMPASS_OFS_X -120.5\nCOMPASS_OFS_Y 33\nCOMPASS_OFS_Z -8\n"


@pytest.mark.parametrize(
    ("stored", "verdict", "words"),
    [
        ("", Verdict.WARNING, "none: only MANUAL and HOLD arm"),
        ("WP_RADIUS 3\n", Verdict.WARNING, "none: only MANUAL and HOLD arm"),
        (CALIBRATED, Verdict.FINE, "offsets -120, 33, -8 mG; motors' field not measured"),
        (f"{CALIBRATED}COMPASS_MOTCT 2\n", Verdict.FINE, "offsets -120, 33, -8 mG; motors' field by current"),
    ],
)
def test_the_stored_parameters_tell_whether_it_is_calibrated(
    examine: Examine, stored: str, verdict: Verdict, words: str
) -> None:
    files = {"/var/lib/mavboat/params.parm": seal(Generation(3, stored.encode())).decode()} if stored else {}
    (finding,) = check_compass_calibration(examine(files, BOAT))
    assert (finding.verdict, finding.text) == (verdict, words)
    assert ("calibrate-compass" in finding.cure) is (verdict is Verdict.WARNING)


def test_other_compasses_have_no_line(examine: Examine) -> None:
    assert check_compass_calibration(examine({}, BoatConfig())) == []
