"""Every row of the failsafe table on the whole boat under way: condition, actions, end state.

The condition is forced, the rest is the boat in its water. Rows with the same course share a voyage; the
rudder boat sails those in which its drive counts.
"""

from typing import NamedTuple

import pytest
from boat_rig import OK, Rig, waypoint
from sailing_rig import is_stopped

from companion.core.modes import Mode
from companion.failsafe.inputs import FailsafeInputs
from companion.failsafe.table import Condition

CLEAR, CHECK = "Clearing the propellers", "Checking the motors"
SOON = {"failsafe.long_timeout_s": 15.0, "failsafe.dead_reckoning_s": 15.0}  # rather than minutes
ROOM_M = {"catamaran": 3.0, "rudder": 1.5 + 3.0 * 2.5}  # of station keeping
AUTO, LOITER, RTL, HOLD, SMART_RTL = Mode.AUTO, Mode.LOITER, Mode.RTL, Mode.HOLD, Mode.SMART_RTL


class Course(NamedTuple):
    """modes: one after the other, the last is the end state, reached after after_s at the latest.
    recoveries: what is told of them, in order.
    """

    modes: tuple[Mode, ...]
    after_s: float = 5.0
    recoveries: tuple[str, ...] = ()


TOLD, HOME, STAY = Course((AUTO,), 15.0), Course((AUTO, RTL), 20.0), Course((AUTO, LOITER))
BACK, STAY_THEN_HOME = Course((AUTO, SMART_RTL), 20.0), Course((AUTO, LOITER, RTL), 22.0)
CATAMARAN: dict[Condition, Course] = {
    Condition.CAPSIZED: TOLD,  # and the boat is disarmed
    Condition.HEADING_LOST: STAY,
    Condition.POSITION_LOST: Course((AUTO, LOITER, HOLD), 20.0),
    Condition.LEAK: HOME,
    Condition.TOO_HOT: HOME,
    Condition.BATTERY_CRITICAL: HOME,
    Condition.BATTERY_LOW: HOME,
    Condition.OUT_OF_RANGE: HOME,
    Condition.SHALLOW: BACK,
    Condition.STUCK: Course((AUTO, RTL, LOITER), 140.0, (CLEAR, CLEAR)),
    Condition.NO_HEADWAY: Course((AUTO, RTL, LOITER), 70.0),
    Condition.OPERATOR_LOST: STAY_THEN_HOME,
    Condition.PLANNER_LOST: STAY_THEN_HOME,
    Condition.HELM_LOST: STAY_THEN_HOME,
    Condition.RC_LOST: STAY_THEN_HOME,
    Condition.GNSS_BAD: TOLD,
    Condition.COMPASS_BAD: TOLD,
    Condition.GYRO_BAD: TOLD,
    Condition.SONAR_LOST: TOLD,
    Condition.OVERRUN: Course((AUTO, LOITER), 10.0),
    Condition.STORAGE_FAILED: TOLD,
    Condition.FENCE_BREACHED: HOME,
    Condition.AGROUND: TOLD,  # afloat, without a fence: the manoeuvre ends at once
    Condition.STEERING_LOST: Course((AUTO, LOITER), 45.0, (CHECK, CHECK)),
    Condition.MOTOR_FAILING: Course((AUTO, RTL, LOITER), 170.0, (CHECK, CLEAR, CLEAR)),
}
# One motor cannot be tested against another: its propeller is cleared. And without a rudder it drifts.
RUDDER: dict[Condition, Course] = {
    Condition.HEADING_LOST: STAY,
    Condition.STEERING_LOST: Course((AUTO, HOLD), 45.0, (CLEAR, CLEAR)),
    Condition.MOTOR_FAILING: Course((AUTO, RTL, LOITER), 170.0, (CLEAR, CLEAR, CLEAR)),
}


def under_way(boat: str) -> Rig:
    rig = Rig("open", f"boat.model={boat}", config=dict(SOON)).sail(
        waypoint(300.0, 0.0), waypoint(300.0, 50.0)
    )
    rig.run(8.0)
    return rig


def forced(rig: Rig, condition: Condition, why: str) -> None:
    """The row sees its condition from now on, or no more."""

    def watch(_: FailsafeInputs) -> str:
        return why

    (row,) = [one for one in rig.boat.vehicle.failsafes._escalations if one.row.condition is condition]
    row.row = row.row._replace(watch=watch)


def follow(rig: Rig, condition: Condition, course: Course) -> None:
    """Force the row; the boat takes its course."""
    rig.peer.forget()
    forced(rig, condition, "forced")
    vehicle = rig.boat.vehicle
    modes, began_s = [vehicle.mode], rig.now_s
    while rig.now_s < began_s + course.after_s and (
        len(modes) < len(course.modes) or course.modes == (AUTO,)
    ):
        rig.run(0.5)
        rig.peer.heartbeat()
        if vehicle.mode is not modes[-1]:
            modes.append(vehicle.mode)
    texts = rig.peer.texts
    assert "Failsafe: forced" in texts
    assert tuple(modes) == course.modes
    assert tuple(text for text in texts if text in (CLEAR, CHECK)) == course.recoveries


def stays(rig: Rig, boat: str) -> None:
    """The boat ends where its last mode keeps it."""
    at = rig.world.truth
    if rig.mode == "HOLD":
        rig.run(2.0)
        assert is_stopped(rig)
    for _ in range(20 if rig.mode == "LOITER" else 0):
        rig.run(1.0)
        rig.peer.heartbeat()  # or the boat goes home for want of an operator
        assert rig.offset_m(at.north_m, at.east_m) < ROOM_M[boat] + 2.0  # it still makes way at first


# Sailed with a receiver and a motor that really fail: test_failsafes_afloat.py
SAILED = (Condition.POSITION_LOST, Condition.MOTOR_FAILING)
SHARED = (TOLD, HOME, BACK, STAY_THEN_HOME)
LONE = [one for one, course in CATAMARAN.items() if course not in SHARED and one not in SAILED]


@pytest.mark.parametrize(
    ("boat", "condition"),
    [*(("catamaran", one) for one in LONE), *(("rudder", one) for one in RUDDER)],
    ids=lambda one: one if isinstance(one, str) else one.name,
)
def test_the_row_ends_as_it_should(boat: str, condition: Condition) -> None:
    rig = under_way(boat)
    follow(rig, condition, {"catamaran": CATAMARAN, "rudder": RUDDER}[boat][condition])
    assert rig.boat.vehicle.armed
    stays(rig, boat)


@pytest.mark.parametrize("course", [HOME, BACK, STAY_THEN_HOME], ids=["home", "back", "stay then home"])
def test_rows_that_lead_home_do_so_one_after_the_other(course: Course) -> None:
    rig = under_way("catamaran")
    for condition in [one for one, its in CATAMARAN.items() if its is course]:
        follow(rig, condition, course)
        before_m = rig.offset_m(0.0, 0.0)
        rig.until(lambda before_m=before_m: rig.offset_m(0.0, 0.0) < before_m - 1.0, 20.0)  # type: ignore[misc]
        forced(rig, condition, "")
        assert rig.set_mode(Mode.AUTO) == OK
        for _ in range(6):
            rig.peer.heartbeat()
            rig.run(1.0)


def test_rows_that_are_only_told_let_the_boat_go_on_until_it_is_capsized() -> None:
    rig = under_way("catamaran")
    told = [one for one, its in CATAMARAN.items() if its is TOLD and one is not Condition.CAPSIZED]
    for condition in told:
        forced(rig, condition, f"forced {condition.name}")
    for _ in range(20):
        rig.run(1.0)
        rig.peer.heartbeat()
    assert {f"Failsafe: forced {one.name}" for one in told} <= set(rig.peer.texts)
    assert rig.mode == "AUTO"
    assert rig.world.truth.north_m_s > 1.0
    forced(rig, Condition.CAPSIZED, "forced")
    rig.run(5.0)
    assert not rig.boat.vehicle.armed
    assert is_stopped(rig)


def test_every_row_is_in_the_table() -> None:
    assert set(CATAMARAN) == set(Condition)
