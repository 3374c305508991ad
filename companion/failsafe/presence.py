"""When the planner was last heard, and whether it steers."""

import math


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
