"""What an operator sees in QGroundControl 4.4 when a button does not do what it says.

A command that fails is shown as "… command failed"; the reason is what the boat says beside it. A text of
severity ERROR (3) or worse pops up, others are only in the list. The pages for sensors show every text.
"""

import pytest
from boat_rig import DENIED, FAILED, UNSUPPORTED, Rig
from twins.qgc_compass import QgcCompassPage

from companion.mavlink.dialect import dialect

CMD = dialect
POPS_UP = 3
HIDDEN = ("prearm:", "ekf", "arm", "initialising")  # beginnings of texts that the sensors page leaves out


@pytest.fixture
def rig() -> Rig:
    """A boat that could be armed, with neither a mission nor a fence."""
    return Rig().ready()


def popped_up(rig: Rig) -> list[str]:
    return [one.text for one in rig.peer.said("STATUSTEXT") if one.severity <= POPS_UP]


@pytest.mark.parametrize(
    ("number", "params", "reason"),
    [
        (CMD.MAV_CMD_DO_SET_MODE, (1.0, 6.0), "FOLLOW: no vehicle is heard"),
        (CMD.MAV_CMD_DO_SET_MODE, (1.0, 10.0), "AUTO: no mission"),
        (CMD.MAV_CMD_MISSION_START, (), "AUTO: no mission"),
        (CMD.MAV_CMD_DO_SET_MODE, (1.0, 16.0), "Mode 16 is not available on this boat"),
        (CMD.MAV_CMD_DO_REPOSITION, (-1.0, 0.0, 0.0, 0.0, 50.001, -1.2), "Go to: not in GUIDED"),
        (CMD.MAV_CMD_DO_FENCE_ENABLE, (1.0,), "Fence: none uploaded"),
    ],
)
def test_a_button_that_fails_pops_up_its_reason(
    rig: Rig, number: int, params: tuple[float, ...], reason: str
) -> None:
    assert rig.ask(number, *params) == FAILED
    assert popped_up(rig) == [reason]


def test_the_compass_page_does_not_begin_and_the_reason_pops_up(rig: Rig) -> None:
    """A page that has begun ends with "YOU MUST REBOOT YOUR VEHICLE NOW", after either report."""
    page = QgcCompassPage(rig)
    page.press_ok()
    assert page.verdict == "nothing appears"
    assert rig.peer.texts[0].startswith("Compass: calibrates itself")
    assert popped_up(rig)
    assert not rig.peer.said("MAG_CAL_REPORT")


@pytest.mark.parametrize(
    ("params", "reason"),
    [
        ((0, 0, 1, 0, 0, 0), "Pressure: this boat has no barometer"),
        ((0, 0, 0, 0, 1, 0), "Accelerometer: the heading sensor calibrates itself"),
        ((0, 0, 0, 0, 2, 0), "Accelerometer: the heading sensor calibrates itself"),
        ((0, 0, 0, 0, 0, 1), "Compass: interference of the motors is not measured"),
        ((0, 0, 0, 1, 0, 0), "RC: this boat has no receiver"),
    ],
)
def test_a_sensor_without_anything_to_calibrate_says_so(
    rig: Rig, params: tuple[float, ...], reason: str
) -> None:
    assert rig.ask(CMD.MAV_CMD_PREFLIGHT_CALIBRATION, *params) in (UNSUPPORTED, DENIED)
    assert rig.peer.texts == [reason]
    assert not reason.lower().startswith(HIDDEN)
