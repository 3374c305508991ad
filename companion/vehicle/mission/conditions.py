"""Conditional commands: they wait for a condition, and are dropped if the leg ends first."""

from collections import deque

from companion.core.geo import Point, distance_m
from companion.vehicle.mission.steps import AfterDelay, Condition, Done, WithinDistance


class ConditionalCommand:
    """The waiting steps in order, a condition first. since_s: when the first one became active."""

    def __init__(self) -> None:
        self._steps: deque[Condition | Done] = deque()
        self._since_s = 0.0

    @property
    def is_empty(self) -> bool:
        """Whether no step waits."""
        return not self._steps

    def wait_for(self, condition: Condition, now_s: float) -> None:
        """Let the steps that follow wait for a condition."""
        if not self._steps:
            self._since_s = now_s
        self._steps.append(condition)

    def holds_back(self, step: Done) -> bool:
        """Whether a step must wait, too: it does behind any other that waits."""
        if self._steps:
            self._steps.append(step)
        return bool(self._steps)

    def clear(self) -> None:
        """Drop all waiting steps."""
        self._steps.clear()

    def take_due(self, at: Point, leg_end: Point | None, now_s: float) -> list[Done]:
        """The steps due now, up to the next condition that is not met.

        leg_end: where the boat is under way to; None: it has come there.
        """
        due: list[Done] = []
        steps = self._steps
        while steps:
            step = steps[0]
            if isinstance(step, AfterDelay):
                if now_s < self._since_s + step.delay_s:
                    break
                self._since_s = now_s
            elif isinstance(step, WithinDistance):
                if leg_end is not None and distance_m(at, leg_end) > step.distance_m:
                    break
                self._since_s = now_s
            else:
                due.append(step)
            steps.popleft()
        return due
