"""Every row of the failsafe table on the catamaran and on the rudder boat: condition, actions, end state.

The condition is forced, the rest is the whole boat in its water, under way in AUTO.
"""

from typing import NamedTuple

import pytest
from boat_rig import Rig, waypoint

from companion.core.modes import Mode
from companion.failsafe.inputs import FailsafeInputs
from companion.failsafe.table import Condition

CLEAR, CHECK = "Clearing the propellers", "Checking the motors"
SOON = {"failsafe.long_timeout_s": 20.0, "failsafe.dead_reckoning_s": 20.0}  # rather than minutes
ROOM_M = {"catamaran": 3.0, "rudder": 1.5 + 3.0 * 2.5}  # of station keeping


class Course(NamedTuple):
    """recoveries: what is told of them, in order. modes: one after the other, the last is the end state;
    DISARMED ends disarmed. after_s: when that is reached at the latest.
    """

    modes: tuple[Mode, ...]
    after_s: float = 5.0
    recoveries: tuple[str, ...] = ()
    is_disarmed: bool = False


AUTO, LOITER, RTL, HOLD = Mode.AUTO, Mode.LOITER, Mode.RTL, Mode.HOLD
HOME, STAY, TOLD = Course((AUTO, RTL), 20.0), Course((AUTO, LOITER)), Course((AUTO,), 20.0)
STAY_THEN_HOME = Course((AUTO, LOITER, RTL), 30.0)

BOTH: dict[Condition, Course] = {
    Condition.CAPSIZED: Course((AUTO,), is_disarmed=True),
    Condition.HEADING_LOST: STAY,
    Condition.POSITION_LOST: Course((AUTO, LOITER, HOLD), 25.0),
    Condition.LEAK: HOME,
    Condition.TOO_HOT: HOME,
    Condition.BATTERY_CRITICAL: HOME,
    Condition.BATTERY_LOW: HOME,
    Condition.OUT_OF_RANGE: HOME,
    Condition.SHALLOW: Course((AUTO, Mode.SMART_RTL), 20.0),
    Condition.STUCK: Course((AUTO, RTL, LOITER), 140.0, (CLEAR, CLEAR)),
    Condition.NO_HEADWAY: Course((AUTO, RTL, LOITER), 70.0),
    Condition.OPERATOR_LOST: STAY_THEN_HOME,
    Condition.PLANNER_LOST: STAY_THEN_HOME,
    Condition.HELM_LOST: STAY_THEN_HOME,
    Condition.RC_LOST: STAY_THEN_HOME,
    Condition.GNSS_BAD: TOLD,
    Condition.COMPASS_BAD: TOLD,
    Condition.SONAR_LOST: TOLD,
    Condition.OVERRUN: Course((AUTO, LOITER), 10.0),
    Condition.STORAGE_FAILED: TOLD,
    Condition.FENCE_BREACHED: HOME,
    Condition.AGROUND: TOLD,  # afloat, without a fence: the manoeuvre ends at once
}
BY_BOAT: dict[str, dict[Condition, Course]] = {
    "catamaran": {
        **BOTH,
        Condition.STEERING_LOST: Course((AUTO, LOITER), 45.0, (CHECK, CHECK)),
        Condition.MOTOR_FAILING: Course((AUTO, RTL, LOITER), 170.0, (CHECK, CLEAR, CLEAR)),
    },
    # One motor cannot be tested against another: its propeller is cleared. And without a rudder it drifts.
    "rudder": {
        **BOTH,
        Condition.STEERING_LOST: Course((AUTO, HOLD), 45.0, (CLEAR, CLEAR)),
        Condition.MOTOR_FAILING: Course((AUTO, RTL, LOITER), 170.0, (CLEAR, CLEAR, CLEAR)),
    },
}


def forced(rig: Rig, condition: Condition) -> None:
    """The row sees its condition from now on."""

    def watch(_: FailsafeInputs) -> str:
        return "forced"

    (row,) = [one for one in rig.boat.vehicle.failsafes._escalations if one.row.condition is condition]
    row.row = row.row._replace(watch=watch)


@pytest.mark.parametrize(
    ("boat", "condition"),
    [(boat, condition) for boat, rows in BY_BOAT.items() for condition in rows],
    ids=lambda one: one if isinstance(one, str) else one.name,
)
def test_the_row_ends_as_it_should(boat: str, condition: Condition) -> None:
    course = BY_BOAT[boat][condition]
    rig = Rig("open", f"boat.model={boat}", config=dict(SOON)).sail(
        waypoint(300.0, 0.0), waypoint(300.0, 50.0)
    )
    rig.run(30.0)
    rig.peer.forget()
    forced(rig, condition)
    modes, texts = [rig.boat.vehicle.mode], []
    vehicle = rig.boat.vehicle
    for _ in range(round(course.after_s / 0.5)):
        rig.run(0.5)
        rig.peer.heartbeat()
        if vehicle.mode is not modes[-1]:
            modes.append(vehicle.mode)
    texts = rig.peer.texts
    assert "Failsafe: forced" in texts
    assert tuple(modes) == course.modes
    assert tuple(text for text in texts if text in (CLEAR, CHECK)) == course.recoveries
    assert vehicle.armed is not course.is_disarmed
    at = rig.world.truth
    if course.is_disarmed or modes[-1] is HOLD:
        rig.run(2.0)
        command = rig.boat.command
        assert (command.left, command.right, command.rudder) == (0.0, 0.0, 0.0)
    elif modes[-1] is LOITER:
        for _ in range(30):
            rig.run(1.0)
            rig.peer.heartbeat()  # or the boat goes home for want of an operator
            assert rig.offset_m(at.north_m, at.east_m) < ROOM_M[boat] + 2.0  # it still makes way at first
    elif modes[-1] in (RTL, Mode.SMART_RTL):
        before_m = rig.offset_m(0.0, 0.0)
        rig.until(lambda: rig.offset_m(0.0, 0.0) < max(before_m - 10.0, 3.0), 40.0)
    else:
        rig.run(5.0)
        assert rig.offset_m(300.0, 0.0) < ((300.0 - at.north_m) ** 2 + at.east_m**2) ** 0.5 - 4.0


def test_every_row_is_in_the_table() -> None:
    for rows in BY_BOAT.values():
        assert set(rows) == set(Condition)
