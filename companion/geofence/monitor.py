"""Counts the breaches of the fence."""

from companion.config.tuning import MotorLimits
from companion.core.state import NavState, lacks_position
from companion.geofence.fence import Fence


class FenceMonitor:
    """beyond_m: distance outside, 0 inside. breaches: number since boot, the last at breached_s.

    Without a position the last state is kept.
    """

    def __init__(self) -> None:
        self.is_active = False
        self.beyond_m = 0.0
        self.breaches = 0
        self.breached_s = 0.0

    @property
    def is_outside(self) -> bool:
        """Whether the boat is outside."""
        return self.beyond_m > 0.0

    def update(self, fence: Fence, nav: NavState | None, setting: MotorLimits, now_s: float) -> None:
        """Evaluate one tick."""
        self.is_active = fence.is_active
        if not fence.is_active:
            self.beyond_m = 0.0
        elif nav is not None and not lacks_position(nav, setting.estimate_timeout_s):
            was_outside = self.beyond_m > 0.0
            self.beyond_m = max(-fence.margin_m(nav.point), 0.0) if fence.is_outside(nav.point) else 0.0
            if self.beyond_m > 0.0 and not was_outside:
                self.breaches += 1
                self.breached_s = now_s
