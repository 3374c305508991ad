"""From what has fired to what the vehicle is to do: the one interpreter of the table's actions."""

from typing import Final

from companion.core.modes import Mode
from companion.core.status_text import Severity
from companion.failsafe.actions import (
    MODES,
    RECOVERIES,
    TRANSITIONS,
    Action,
    AssumeFailed,
    Decision,
    LimitSpeed,
    Notify,
    Recover,
    Retreat,
    State,
    StopMotors,
    Trigger,
)
from companion.failsafe.inputs import FailsafeInputs, may_drift
from companion.failsafe.monitor import Alarm, Change
from companion.failsafe.table import Condition, Row

# For how long a boat drifts that clears its propellers and checks its motors, twice over, and gets under way
_CLEARING_DRIFT_S: Final = 60.0
_CHECK_DRIFT_S: Final = 10.0  # one motor check, and turning into the current
RECHECK_DRIFT_S: Final = 15.0  # the same on one motor, which takes longer to turn
_SLOW_SHARE: Final = 0.5  # of cruise speed: what a propeller with weed still manages


def respond(alarm: Alarm, inputs: FailsafeInputs) -> list[Decision]:
    """What to do about an alarm."""
    row = alarm.row
    action = _suited(alarm.action, row, inputs)
    if alarm.change is Change.ENDS:
        return [Notify(Severity.NOTICE, f"Failsafe over: {row.over}")] if row.over else []
    is_driven = inputs.armed and inputs.mode is not Mode.HOLD
    acts = action is Action.DISARM or (is_driven and action is not Action.NONE)
    if alarm.change is Change.ESCALATES and not acts:
        return []
    severity = Severity.WARNING if action is Action.NONE else Severity.CRITICAL
    persists = " (persists)" if alarm.change is Change.ESCALATES else ""
    told = Notify(severity, f"Failsafe: {alarm.text}{persists}")
    if not acts:
        return [told]
    if action is Action.DISARM:
        return [told, StopMotors()]
    if action in RECOVERIES:
        return [told, *_recover(action, inputs)]
    if action is not Action.HOLD and row.guard.spares(inputs):
        return [told]
    limit = [LimitSpeed(_SLOW_SHARE)] if row.is_slow else []
    return [told, Retreat(MODES[action]), *limit]


def _suited(action: Action, row: Row, inputs: FailsafeInputs) -> Action:
    """The action that comes closest to this one on a boat with one motor and a rudder.

    It has no second motor to test this one against: pulses astern wash weed off propeller and rudder. And
    where it cannot steer, every mode that drives takes it away from its place: it drifts.
    """
    if inputs.config.drive.has_pair:
        return action
    if action is Action.CHECK_MOTORS:
        return Action.CLEAR_PROPELLERS
    if row.condition is Condition.STEERING_LOST and action in MODES:
        return Action.HOLD
    return action


def _recover(action: Action, inputs: FailsafeInputs) -> list[Decision]:
    """A recovery, where the boat has room to drift meanwhile."""
    if action is Action.CLEAR_PROPELLERS and inputs.reversed_motor:
        action = Action.CHECK_MOTORS  # its wires may be right again
    trigger, text = RECOVERIES[action]
    if trigger not in TRANSITIONS[inputs.recovery]:
        return []
    nav, fence, verdict = inputs.nav, inputs.fence, inputs.verdict
    if trigger is Trigger.CLEAR and inputs.failed_motor and not may_drift(nav, fence, _CLEARING_DRIFT_S):
        return []  # sailing on one motor is all that keeps the boat off the line
    if (
        verdict is not None
        and not verdict.has_thrust
        and trigger is Trigger.CHECK
        and not may_drift(nav, fence, _CHECK_DRIFT_S)
    ):
        text = "No room for a motor check: using one motor"
        return [AssumeFailed(verdict.is_left), Notify(Severity.WARNING, text)]
    return [Recover(trigger, Severity.WARNING, text)]


def routine_check(inputs: FailsafeInputs) -> list[Decision]:
    """Check or compare motors that cannot be judged otherwise, where that may take the place of the mode for
    some seconds.
    """
    is_driven = inputs.armed and inputs.mode is not Mode.HOLD and not inputs.mode.rules.is_by_hand
    is_wanted = inputs.config.failsafe.motor_action == Action.CHECK_MOTORS
    is_free = is_driven and is_wanted and inputs.recovery is State.IDLE
    if not is_free or not may_drift(inputs.nav, inputs.fence, _CHECK_DRIFT_S):
        return []
    if inputs.needs_motor_check:
        return [Recover(Trigger.CHECK, Severity.NOTICE, "Steering has no effect: checking the motors")]
    if inputs.needs_motor_comparison:
        return [Recover(Trigger.COMPARE, Severity.NOTICE, "Motors draw more current: comparing them")]
    return []
