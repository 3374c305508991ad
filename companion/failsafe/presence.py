"""When the operator and the planner were last heard."""

import math


class Operator:
    """The operator's heartbeats. Silence counts only after the first one."""

    def __init__(self) -> None:
        self.last_heard_s = math.nan

    def heard(self, now_s: float) -> None:
        """A heartbeat of the operator has come."""
        self.last_heard_s = now_s


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
