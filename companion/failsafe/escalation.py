"""One failsafe under way: when it fires, which step it is on, when it is over."""

import math
from enum import Enum

from companion.config.tuning import Failsafe
from companion.failsafe.actions import Action
from companion.failsafe.table import Row, Step


class Change(Enum):
    """What has just changed."""

    STAYS = 0
    FIRES = 1
    ESCALATES = 2  # the condition has lasted: the next step
    ENDS = 3


class Escalation:
    """One row's timing: since when its condition has held, or not. action: what the present step asks for."""

    def __init__(self, row: Row) -> None:
        self.row = row
        self._ended_s = -math.inf
        self._next = 0
        self.reset()

    def reset(self) -> None:
        """Forget everything but when it ended, in case it comes back."""
        self.text = ""  # the condition in words, as last seen
        self.action = Action.NONE
        self.is_active = False
        self.is_overruled = False  # the operator has chosen a mode since it fired
        self._since_s = self._calm_s = math.nan
        self._step_s = 0.0

    def update(self, text: str, setting: Failsafe, now_s: float) -> Change:
        """Take what the condition says now, "" while nothing is wrong."""
        if not text:
            if not self.is_active:
                self._since_s = math.nan
                return Change.STAYS
            if math.isnan(self._calm_s):
                self._calm_s = now_s
            if now_s - self._calm_s < self.row.clear_s:
                return Change.STAYS
            self.reset()
            self._ended_s = now_s
            return Change.ENDS
        self._calm_s = math.nan
        self.text = text
        if self.is_active:
            return self._escalate(setting, now_s)
        if math.isnan(self._since_s):
            self._since_s = now_s
        if now_s - self._since_s < _seconds(self.row.after, setting):
            return Change.STAYS
        self.is_active, self._step_s = True, now_s
        steps, first = _steps(self.row, setting), _action(self.row.action, setting)
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

    def _take(self, step: Step, setting: Failsafe) -> None:
        self.action = _action(step.action, setting)
        self._next += 1


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
