"""Speed limits near obstacles: the boat must be able to stop before them.

In sight-limited mode it must also be able to stop within the observed water: always, or for a while after an
unmapped obstacle.
"""

import math
from typing import Final

from msgspec.structs import replace

from companion.config.boat_config import BoatConfig
from companion.control.speed import feed_forward
from companion.core.intent import Drive, Stop
from companion.core.state import Demand, NavState
from companion.core.units import wrap_pi
from companion.obstacles.perception.looked_at import allowed_speed_m_s
from companion.obstacles.perception.perception import ObstaclePerception
from companion.obstacles.planning.scene import Scene

_SURPRISE: Final = 0.9  # of the slowest speed with steerage way: excess speed that triggers a crash stop
_STEADIES, _LEAST_STEERING = 0.5, 0.2


def crash_stop(nav: NavState, config: BoatConfig) -> Drive:
    """Full reverse on both propellers, holding the heading."""
    steering = min(max(-_STEADIES * nav.yaw_rate_rad_s, -_LEAST_STEERING), _LEAST_STEERING)
    return Drive(-config.speed.max_throttle, steering)


class SafeSpeed:
    """ahead_m_s and astern_m_s: the limits, infinite for none."""

    def __init__(self) -> None:
        self.ahead_m_s = self.astern_m_s = math.inf
        self._solid_m_s = math.inf  # limit from solid obstacles alone

    def clear(self) -> None:
        """Remove the limits."""
        self.ahead_m_s = self.astern_m_s = self._solid_m_s = math.inf

    def reduce_to(self, limit_m_s: float) -> None:
        """Lower the limit ahead."""
        self.ahead_m_s = min(self.ahead_m_s, limit_m_s)

    def raise_to(self, speed_m_s: float) -> None:
        """Raise the limit ahead: a slow boat stays longer near a moving obstacle."""
        self.ahead_m_s = max(self.ahead_m_s, speed_m_s)

    def update(self, scene: Scene, perception: ObstaclePerception) -> None:
        """Compute the limits."""
        heading = scene.nav.heading_rad
        sight_m_s = allowed_speed_m_s(scene.nav, scene.config, perception.water, scene.bounds, scene.now_s)
        room_m = min(scene.room_ahead_m(), scene.room_m(heading))
        self._solid_m_s = scene.stopping_speed_m_s(room_m) if room_m < math.inf else math.inf
        self.ahead_m_s = min(sight_m_s, self._solid_m_s)
        astern_m = scene.room_m(heading + math.pi)
        self.astern_m_s = math.inf if astern_m == math.inf else scene.stopping_speed_m_s(astern_m)

    def limit(
        self, steered: Demand | Drive | Stop, nav: NavState | None, config: BoatConfig
    ) -> Demand | Drive | Stop:
        """Apply the limits."""
        limit = self.ahead_m_s
        if limit == math.inf and self.astern_m_s == math.inf:
            return steered
        if isinstance(steered, Demand):
            if (
                nav is not None
                and nav.surge_m_s > self._solid_m_s + _SURPRISE * config.guidance.min_speed_m_s
            ):
                return crash_stop(nav, config)
            speed = max(min(steered.speed_m_s, limit), -self.astern_m_s)
            if nav is not None and speed < steered.speed_m_s and self._turns_astern(steered, nav, config):
                speed = -min(config.guidance.min_speed_m_s, self.astern_m_s)
            return steered if speed == steered.speed_m_s else replace(steered, speed_m_s=speed)
        if isinstance(steered, Drive) and nav is not None and steered.throttle > 0.0 and limit < math.inf:
            most = feed_forward(limit, config.speed) + config.speed.kp * (limit - nav.surge_m_s)
            return Drive(max(min(steered.throttle, most), -1.0), steered.steering)
        return steered

    def _turns_astern(self, wanted: Demand, nav: NavState, config: BoatConfig) -> bool:
        """Whether a boat that cannot turn on the spot turns away by going astern: it has no room ahead."""
        off_rad = abs(wrap_pi(wanted.heading_rad - nav.heading_rad))
        has_room = self.ahead_m_s >= config.guidance.min_speed_m_s
        return not (config.drive.can_pivot or has_room) and off_rad > 0.5 * config.guidance.pivot_angle_rad
