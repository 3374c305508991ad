"""All failsafes: ten times a second, which have fired, escalated or ended, or hold for a new reason."""

import math
from collections.abc import Sequence
from enum import Enum
from typing import NamedTuple

from companion.config.boat_config import BoatConfig
from companion.config.tuning import Failsafe
from companion.failsafe.actions import RECOVERIES, Action, State
from companion.failsafe.endurance import Endurance
from companion.failsafe.inputs import FailsafeInputs
from companion.failsafe.motors.rudder_watch import RudderWatch
from companion.failsafe.motors.watch import MotorWatch
from companion.failsafe.table import ROWS, Condition, Row, Step
from companion.geofence.fence import FenceMonitor
from companion.rc.manual_input import ManualInput

PERIOD_S = 0.1
_SLACK_S = 1e-6
# Times what ends a condition: one that is only told and comes back so soon has to stay away twice as long to
# be over. So a loose contact is told a few times, and not every few seconds. What acts has to act each time
_SOON = 4.0
_JUDGED = (State.IDLE, State.COMPARING)  # where the motion says something about the motors
_POWER = int(Condition.BATTERY_CRITICAL | Condition.BATTERY_LOW | Condition.OUT_OF_RANGE)


class Planner:
    """The planner's heartbeats and set-points, and whether it steers the boat."""

    def __init__(self) -> None:
        self.last_heard_s = math.nan
        self.is_steering = False

    def heard(self, now_s: float) -> None:
        """A heartbeat of a planner has come."""
        self.last_heard_s = now_s

    def steers(self, now_s: float) -> None:
        """The boat obeys a set-point of the planner."""
        self.last_heard_s = now_s
        self.is_steering = True

    def release(self) -> None:
        """The planner no longer steers: its silence does not count."""
        self.is_steering = False

    def silent_s(self, now_s: float) -> float:
        """For how long a planner that steers has been silent; NaN while none steers."""
        return now_s - self.last_heard_s if self.is_steering else math.nan


class Change(Enum):
    """What has just changed."""

    STAYS = 0
    FIRES = 1
    ESCALATES = 2  # the condition has lasted: the next step
    ENDS = 3
    NEW_REASON = 4  # the condition still holds, but for another reason


class Escalation:
    """One row's timing: since when its condition has held, or not. action: what the present step asks for."""

    def __init__(self, row: Row) -> None:
        self.row = row
        self._ended_s = -math.inf
        self._clear_s = row.clear_s
        self._next = 0
        self.reset()

    def reset(self) -> None:
        """Forget everything but when it ended, in case it comes back."""
        self.text = self._told = ""  # the condition in words: as last seen, and as told
        self.action = Action.NONE
        self.is_active = False
        self.is_overruled = False  # the operator has chosen a mode since it fired
        self._since_s = self._calm_s = self._reason_s = math.nan
        self._step_s = 0.0

    def update(self, text: str, setting: Failsafe, now_s: float) -> Change:
        """Take what the condition says now, "" while nothing is wrong."""
        if not text:
            if not self.is_active:
                self._since_s = math.nan
                return Change.STAYS
            if math.isnan(self._calm_s):
                self._calm_s = now_s
            if now_s - self._calm_s < self._clear_s:
                return Change.STAYS
            self.reset()
            self._ended_s = now_s
            return Change.ENDS
        self._calm_s = math.nan
        if _reason(text) != _reason(self.text):
            self._reason_s = now_s
        self.text = text
        if self.is_active:
            change = self._escalate(setting, now_s)
            if change is Change.STAYS and self._has_new_reason(now_s):
                change = Change.NEW_REASON
            if change is not Change.STAYS:
                self._told = text
            return change
        if math.isnan(self._since_s):
            self._since_s = now_s
        if now_s - self._since_s < _seconds(self.row.after, setting):
            return Change.STAYS
        self.is_active, self._step_s, self._told = True, now_s, text
        steps, first = _steps(self.row, setting), _action(self.row.action, setting)
        if first is Action.NONE:
            comes_and_goes = now_s - self._ended_s < _SOON * self._clear_s
            self._clear_s = 2.0 * self._clear_s if comes_and_goes else self.row.clear_s
        is_relapse = now_s - self._ended_s < self.row.relapse_s and first is not Action.NONE
        if is_relapse and self._next < len(steps):
            self._take(steps[self._next], setting)  # what was done before has not lasted
        else:
            self._next, self.action = 0, first
        return Change.FIRES

    def _escalate(self, setting: Failsafe, now_s: float) -> Change:
        steps = _steps(self.row, setting)
        if self._next >= len(steps) or self.is_overruled or self.action is Action.NONE:
            return Change.STAYS
        wait_s = _seconds(steps[self._next].after, setting)
        if wait_s <= 0.0 or now_s - self._step_s < wait_s:
            return Change.STAYS
        self._step_s = now_s
        self._take(steps[self._next], setting)
        return Change.ESCALATES

    def _has_new_reason(self, now_s: float) -> bool:
        """Whether its reason is not the one told, and has not changed for as long as its end must last."""
        return _reason(self.text) != _reason(self._told) and now_s - self._reason_s >= self.row.clear_s

    def _take(self, step: Step, setting: Failsafe) -> None:
        self.action = _action(step.action, setting)
        self._next += 1


def _reason(text: str) -> str:
    """A condition's words without its figures."""
    return "".join(letter for letter in text if letter.isalpha() or letter == " ")


def _steps(row: Row, setting: Failsafe) -> tuple[Step, ...]:
    """The steps of a row. The propellers are cleared as often as is set, the first action included."""
    steps = row.then
    if not steps or steps[0].action is not Action.CLEAR_PROPELLERS:
        return steps
    first = _action(row.action, setting)
    is_tried = first in (Action.CLEAR_PROPELLERS, Action.CHECK_MOTORS)
    again = setting.clearing_tries - (first is Action.CLEAR_PROPELLERS) if is_tried else 0
    return steps[:1] * again + steps[1:]


def _seconds(value: float | str, setting: Failsafe) -> float:
    return float(getattr(setting, value)) if isinstance(value, str) else value


def _action(value: Action | str, setting: Failsafe) -> Action:
    return Action(getattr(setting, value)) if isinstance(value, str) else value


class Alarm(NamedTuple):
    """What a row has just done. action: what is to be done, NONE where it is only told."""

    row: Row
    change: Change
    text: str
    action: Action


class Failsafes:
    """active: bits of what has fired and is not over. is_postponed: nothing has been watched for a while. The
    other attributes feed the inputs.
    """

    def __init__(self, config: BoatConfig, sticks: ManualInput, rows: Sequence[Row] = ROWS) -> None:
        self.active = 0
        self.operator_heard_s = math.nan  # silence counts only after the first heartbeat
        self.planner = Planner()
        self.sticks = sticks
        self.endurance = Endurance()
        self.motors = MotorWatch(config)
        self.rudder = RudderWatch()
        self.fence = FenceMonitor()
        self._escalations = [Escalation(row) for row in rows]
        self._due_s, self.is_postponed = 0.0, False
        self._suspended_s = -math.inf
        self._was_armed = False

    def is_due(self, now_s: float) -> bool:
        """Whether the next cycle is due."""
        return now_s >= self._due_s

    def postpone(self, until_s: float) -> None:
        """No cycle is due before. What is postponed is not postponed again."""
        if not self.is_postponed:
            self._due_s, self.is_postponed = until_s, True

    def suspend(self, until_s: float) -> None:
        """Motors, and the parts beside them, are away: only the independent rows are watched."""
        self._suspended_s = until_s

    def is_suspended(self, now_s: float) -> bool:
        return now_s < self._suspended_s

    def is_active(self, condition: Condition) -> bool:
        """Whether this has fired and is not over."""
        return bool(self.active & int(condition))

    @property
    def pack_is_low(self) -> bool:
        """Whether the pack calls the boat home, for whatever reason."""
        return bool(self.active & _POWER)

    def renew_pack(self, share: float) -> None:
        """The pack has been changed or charged to this share: its failsafes are over. They fire again if the
        voltage is still too low.
        """
        for escalation in self._escalations:
            if int(escalation.row.condition) & _POWER:
                escalation.reset()
        self.active &= ~_POWER
        self.endurance.renew(share)

    def overrule(self) -> None:
        """The operator has chosen a mode: active failsafes take no further step."""
        for escalation in self._escalations:
            escalation.is_overruled = escalation.is_active
        self.planner.release()
        self.sticks.stop_watching()

    def update(self, inputs: FailsafeInputs) -> list[Alarm]:
        """One cycle."""
        now_s, setting, armed = inputs.now_s, inputs.config.failsafe, inputs.armed
        self._due_s, self.is_postponed = now_s + PERIOD_S - _SLACK_S, False
        alarms: list[Alarm] = []
        is_suspended = self.is_suspended(now_s)
        is_disarmed_now, self._was_armed = self._was_armed and not armed, armed
        for escalation in self._escalations:
            row = escalation.row
            if not armed and not row.guard.disarmed:
                if is_disarmed_now:
                    escalation.reset()
                    self.active &= ~int(row.condition)
                continue
            if is_suspended and not row.guard.is_independent:
                continue
            text = row.watch(inputs)
            if text and not escalation.is_active and row.guard.waits(inputs):
                text = ""
            if not text and not escalation.is_active:
                if escalation.text:
                    escalation.reset()
                continue
            if inputs.recovery not in _JUDGED and escalation.action in RECOVERIES:
                text = escalation.text  # its own recovery may be under way, whose motion says nothing
            change = escalation.update(text, setting, now_s)
            if change is Change.ENDS:
                self.active &= ~int(row.condition)
                alarms.append(Alarm(row, change, row.over, Action.NONE))
            elif change is not Change.STAYS:
                self.active |= int(row.condition)
                is_concerned = inputs.mode in row.guard.modes
                acts = is_concerned and change is not Change.NEW_REASON
                action = escalation.action if acts else Action.NONE
                alarms.append(Alarm(row, change, escalation.text, action))
        return alarms
