"""One failsafe under way: when it fires, which step it is on, when it is over."""

import math
from enum import Enum

from companion.config.failsafe import Failsafe
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

    __slots__ = (
        "_calm_s",
        "_ended_s",
        "_next",
        "_since_s",
        "_step_s",
        "action",
        "is_active",
        "is_overruled",
        "row",
        "text",
    )

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
        step, first = self._next_step(setting), _action(self.row.action, setting)
        is_relapse = now_s - self._ended_s < self.row.relapse_s
        if step is not None and is_relapse and first is not Action.NONE:
            self._next += 1  # what was done before has not lasted
            self.action = _action(step.action, setting)
        else:
            self._next, self.action = 0, first
        return Change.FIRES

    def _escalate(self, setting: Failsafe, now_s: float) -> Change:
        step = self._next_step(setting)
        if step is None or self.is_overruled or self.action is Action.NONE:
            return Change.STAYS
        wait_s = _seconds(step.after, setting)
        if wait_s <= 0.0 or now_s - self._step_s < wait_s:
            return Change.STAYS
        self._next += 1
        self._step_s = now_s
        self.action = _action(step.action, setting)
        return Change.ESCALATES

    def _next_step(self, setting: Failsafe) -> Step | None:
        """The step to come. The propellers are cleared as often as is set."""
        steps = self.row.then
        if not steps or steps[0].action is not Action.CLEAR_PROPELLERS:
            return steps[self._next] if self._next < len(steps) else None
        begun = _action(self.row.action, setting)
        again = 0
        if begun in (Action.CLEAR_PROPELLERS, Action.CHECK_MOTORS):
            again = setting.clearing_tries - (begun is Action.CLEAR_PROPELLERS)
        if self._next < again:
            return steps[0]
        place = self._next - again + 1
        return steps[place] if place < len(steps) else None


def _seconds(value: float | str, setting: Failsafe) -> float:
    return float(getattr(setting, value)) if isinstance(value, str) else value


def _action(value: Action | str, setting: Failsafe) -> Action:
    return Action(getattr(setting, value)) if isinstance(value, str) else value
