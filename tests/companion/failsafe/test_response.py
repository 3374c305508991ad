"""What is decided where the boat may or may not drift, and when the motors are checked without an alarm."""

import pytest
from boat_rig import nav_at
from failsafe_scenarios import with_verdict
from fence_rig import box
from laid_fence import area, laid
from msgspec.structs import replace

from companion.config.boat_config import BoatConfig, decode_config, with_value
from companion.core.modes import Mode
from companion.core.status_text import Severity
from companion.failsafe.actions import (
    MODES,
    RECOVERIES,
    Action,
    AssumeFailed,
    Decision,
    Notify,
    Recover,
    Retreat,
    State,
    Trigger,
)
from companion.failsafe.inputs import FailsafeInputs, may_drift
from companion.failsafe.monitor import Alarm, Change, Failsafes
from companion.failsafe.motors.hypotheses import Fault
from companion.failsafe.response import respond, routine_check
from companion.failsafe.table import ROWS, Condition
from companion.geofence.fence import Fence
from companion.rc.manual_input import ManualInput

ROW = next(row for row in ROWS if row.condition is Condition.MOTOR_FAILING)
NO_ROOM = "No room for a motor check: using one motor"


def water_south_of(north_m: float) -> Fence:
    """Open water, but for a line so far north of the boat."""
    return laid(area(box(-500.0, -500.0, north_m, 500.0)))


def inputs(
    north_m_s: float = 0.0, east_m_s: float = 0.0, room_m: float = 20.0, **more: object
) -> FailsafeInputs:
    """A boat in GUIDED in this current."""
    nav = replace(nav_at(), current_north_m_s=north_m_s, current_east_m_s=east_m_s)
    made = FailsafeInputs(
        now_s=0.0, config=BoatConfig(), mode=Mode.GUIDED, armed=True, nav=nav, fence=water_south_of(room_m)
    )
    return replace(made, **more)


def decided(action: Action, seen: FailsafeInputs) -> list[Decision]:
    """After the alarm has been told."""
    told, *decisions = respond(Alarm(ROW, Change.FIRES, "Left motor gives no thrust", action), seen)
    assert isinstance(told, Notify)
    return decisions


CLEARING = [Recover(Trigger.CLEAR, Severity.WARNING, "Clearing the propellers")]
CHECKING = [Recover(Trigger.CHECK, Severity.WARNING, "Checking the motors")]


@pytest.mark.parametrize(("north_m_s", "has_room"), [(-1.0, True), (0.32, True), (0.34, False), (2.0, False)])
def test_a_boat_on_one_motor_clears_its_propellers_only_with_a_minute_of_room(
    north_m_s: float, has_room: bool
) -> None:
    on_one = inputs(north_m_s, failed_motor="Left motor gives no thrust")
    assert decided(Action.CLEAR_PROPELLERS, on_one) == (CLEARING if has_room else [])
    assert decided(Action.CLEAR_PROPELLERS, inputs(north_m_s)) == CLEARING


@pytest.mark.parametrize("fault", Fault)
@pytest.mark.parametrize(("north_m_s", "has_room"), [(1.95, True), (2.05, False)])
def test_without_ten_seconds_of_room_a_motor_without_thrust_is_not_checked(
    fault: Fault, north_m_s: float, has_room: bool
) -> None:
    is_assumed = not has_room and fault in (Fault.DEAD, Fault.BLOCKED, Fault.LOST)
    expected = [AssumeFailed(True), Notify(Severity.WARNING, NO_ROOM)] if is_assumed else CHECKING
    assert decided(Action.CHECK_MOTORS, with_verdict(fault)(inputs(north_m_s))) == expected


def test_a_motor_that_was_reversed_is_checked_instead_of_cleared() -> None:
    assert decided(Action.CLEAR_PROPELLERS, inputs(reversed_motor=True)) == CHECKING


@pytest.mark.parametrize(("room_m", "has_room"), [(3.0, False), (9.0, True)])
def test_the_current_may_turn_by_seventeen_degrees_meanwhile(room_m: float, has_room: bool) -> None:
    seen = inputs(east_m_s=0.4, room_m=room_m)  # along the line: 24 m in a minute, and 7 m towards it
    assert may_drift(seen.nav, seen.fence, 60.0) is has_room


@pytest.mark.parametrize("recovery", State)
def test_a_motor_named_during_a_comparison_is_reported_at_once(recovery: State) -> None:
    """The other manoeuvres hide what the motors do. An alarm that is active waits for their end."""
    failsafes = Failsafes(BoatConfig(), ManualInput())
    failsafes.update(with_verdict(Fault.FOULED)(inputs()))
    changes = [failsafes.update(replace(inputs(recovery=recovery), now_s=0.1 * tick)) for tick in range(170)]
    assert any(changes) is (recovery in (State.IDLE, State.COMPARING))


def test_failsafes_are_postponed_once_at_most() -> None:
    failsafes = Failsafes(BoatConfig(), ManualInput())
    failsafes.postpone(1.5)
    failsafes.postpone(9.0)
    assert (failsafes.is_due(1.4), failsafes.is_due(1.5)) == (False, True)
    failsafes.update(inputs())
    failsafes.postpone(3.0)
    assert not failsafes.is_due(2.9)


@pytest.mark.parametrize("wanted", ["needs_motor_check", "needs_motor_comparison"])
@pytest.mark.parametrize(
    "change",
    [
        {"needs_motor_check": False, "needs_motor_comparison": False},
        {"armed": False},
        {"mode": Mode.HOLD},
        {"mode": Mode.MANUAL},
        {"mode": Mode.STEERING},
        {"recovery": State.CLEARING},
        {"recovery": State.COMPARING},
        {"config": with_value(BoatConfig(), "failsafe.motor_action", int(Action.CLEAR_PROPELLERS))},
        {"nav": replace(nav_at(), current_north_m_s=2.05)},
    ],
)
def test_but_not_where_it_would_be_in_the_way(change: dict[str, object], wanted: str) -> None:
    assert routine_check(replace(inputs(**{wanted: True}), **change)) == []


@pytest.mark.parametrize("layout", ["rudder", "differential", "differential_rudder"])
@pytest.mark.parametrize("condition", Condition, ids=lambda one: one.name)
def test_what_one_motor_and_a_rudder_cannot_do_is_replaced(layout: str, condition: Condition) -> None:
    """Every action in every row: the mode or the recovery that follows from it."""
    config = decode_config({"drive": {"layout": layout}}, "test")
    row = next(row for row in ROWS if row.condition is condition)
    seen = FailsafeInputs(now_s=0.0, config=config, armed=True, mode=Mode.GUIDED, nav=nav_at(), fence=Fence())
    for action in (*RECOVERIES, *MODES):
        _, *decisions = respond(Alarm(row, Change.FIRES, "x", action), seen)
        expected = action
        if layout == "rudder" and action is Action.CHECK_MOTORS:
            expected = Action.CLEAR_PROPELLERS
        if layout == "rudder" and action in MODES and condition is Condition.STEERING_LOST:
            expected = Action.HOLD
        if expected in RECOVERIES:
            assert [one.trigger for one in decisions if isinstance(one, Recover)] == [RECOVERIES[expected][0]]
        else:
            assert [one.modes for one in decisions if isinstance(one, Retreat)] == [MODES[expected]]
