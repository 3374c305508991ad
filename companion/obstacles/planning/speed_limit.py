"""Speed limits: what the boat can stop from before known cells, and within the water it has looked at.

In water that no chart knows, a crash stop must end a margin before the first place that was not seen free,
and before the first where a ranger may miss a small thing. The boat reacts after half the time between two
passes of the sweep over its course, and a second look. What it makes between two passes does not count, and
so the limit does not fall and rise with each pass.
"""

import math
from typing import Final

from msgspec.structs import replace

from companion.config.boat_config import BoatConfig
from companion.control.speed import feed_forward
from companion.core.geo import Point
from companion.core.intent import Drive, Stop
from companion.core.state import Demand, NavState
from companion.guidance.speed_profile import braking_speed_m_s
from companion.obstacles.perception.perception import ObstaclePerception
from companion.obstacles.perception.sonar_schedule import AHEAD_RAD
from companion.obstacles.planning.clearance import SOLID, ClearanceBounds, ClearanceField
from companion.obstacles.planning.motion import crash_stop_m, crash_stop_speed_m_s

_STEADIES: Final = 0.5  # steering per yaw rate of a crash stop,
_LEAST_STEERING: Final = 0.2  # and most of it: the thrust is for braking
_PASS_S: Final = 0.23  # per rad of the sector, from one look ahead to the next: a ping of 60 ms every 15°,
_LOOK_AGAIN_S: Final = 0.06  # and one more ping at what was met
_STOPS_S: Final = 3.5  # a crash stop takes, while a current carries the boat on
# Share of its reach in which a ranger finds small things: a wall's echo falls with the square of the range, a
# rock's with the fourth power (R. J. Urick, *Principles of Underwater Sound*, 1983, section 2.3). At three
# quarters a rock may be 5 dB weaker than the wall at the full reach
_FINDS: Final = 0.75
_FAR_ABOVE_M_S: Final = 0.5  # the limit of sight: the propellers turn astern for it
STILL_SHARE: Final = 0.25  # of the slowest speed with steerage way: slower, the course is noise
_GENTLE_SHARE: Final = 0.5  # of the room is for braking: near rest only the propellers brake, and weakly


def crash_stop(nav: NavState, config: BoatConfig) -> Drive:
    """Full reverse on both propellers, holding the heading."""
    steering = min(max(-_STEADIES * nav.yaw_rate_rad_s, -_LEAST_STEERING), _LEAST_STEERING)
    return Drive(-config.speed.max_throttle, steering)


class SpeedLimit:
    """ahead_m_s and astern_m_s: the limits, infinite for none; sight_m_s: by the water looked at."""

    def __init__(self) -> None:
        self.clear()

    def clear(self) -> None:
        """Remove the limits."""
        self.ahead_m_s = self.astern_m_s = self.sight_m_s = math.inf

    def release(self) -> None:
        """A rollout holds: it has looked ahead itself."""
        self.ahead_m_s = self.astern_m_s = math.inf

    def reduce_to(self, limit_m_s: float) -> None:
        """Lower the limit ahead."""
        self.ahead_m_s = min(self.ahead_m_s, limit_m_s)

    def update(
        self,
        nav: NavState,
        config: BoatConfig,
        perception: ObstaclePerception,
        field: ClearanceField,
        bounds: ClearanceBounds,
        now_s: float,
    ) -> None:
        """Compute the limits from the room ahead and astern."""
        self.clear()
        self.sight_m_s = allowed_speed_m_s(nav, config, perception, bounds, now_s)
        c, s = math.cos(nav.heading_rad), math.sin(nav.heading_rad)
        # Beyond its sight, a boat on a clear path will have turned
        steps = math.ceil(perception.reach_m / field.cell_m)
        ahead_m, astern_m = _room_m(field, nav.point, c, s, steps), _room_m(field, nav.point, -c, -s, steps)
        self.ahead_m_s = self.sight_m_s
        if ahead_m < math.inf:
            self.reduce_to(braking_speed_m_s(_GENTLE_SHARE * ahead_m, 0.0, config.guidance))
        if astern_m < math.inf:
            self.astern_m_s = braking_speed_m_s(_GENTLE_SHARE * astern_m, 0.0, config.guidance)

    def apply(
        self, steered: Demand | Drive | Stop, nav: NavState | None, config: BoatConfig
    ) -> Demand | Drive | Stop:
        """Apply the limits."""
        limit = self.ahead_m_s
        if limit == math.inf and self.astern_m_s == math.inf:
            return steered
        if isinstance(steered, Demand):
            speed = max(min(steered.speed_m_s, limit), -self.astern_m_s)
            if speed == steered.speed_m_s:
                return steered
            is_gentle = limit == self.sight_m_s and nav is not None and nav.surge_m_s < limit + _FAR_ABOVE_M_S
            return replace(steered, speed_m_s=speed, brakes=steered.brakes and not is_gentle)
        if isinstance(steered, Drive) and nav is not None and steered.throttle > 0.0 and limit < math.inf:
            most = feed_forward(limit, config.speed) + config.speed.kp * (limit - nav.surge_m_s)
            return Drive(max(min(steered.throttle, most), -1.0), steered.steering)
        return steered


def allowed_speed_m_s(
    nav: NavState, config: BoatConfig, perception: ObstaclePerception, bounds: ClearanceBounds, now_s: float
) -> float:
    """The highest speed in this water; infinite where it is not limited, never below min_speed_m_s."""
    water = perception.water
    if not water.is_limited(nav.point, config.avoidance.by_sight, bounds):
        return math.inf
    least_m_s, speed_m_s = config.guidance.min_speed_m_s, math.hypot(nav.north_m_s, nav.east_m_s)
    is_still = speed_m_s < STILL_SHARE * least_m_s
    course_rad = nav.heading_rad if is_still else math.atan2(nav.east_m_s, nav.north_m_s)
    port_rad, starboard_rad = perception.sector
    pass_s = _PASS_S * min(max(starboard_rad - port_rad, 2.0 * AHEAD_RAD), math.pi)
    reaction_s = 0.5 * pass_s + _LOOK_AGAIN_S
    stops_m = crash_stop_m(config.handling.top_speed_m_s, reaction_s, config)
    margin_m = config.avoidance.margin_m + _STOPS_S * max(nav.current_along_m_s(course_rad), 0.0)
    between_m = 2.0 * pass_s * speed_m_s  # at the edge of the sector
    room_m = water.room_m(nav.point, course_rad, margin_m + stops_m, now_s, between_m)
    seen_m = min(room_m, _FINDS * perception.reach_m)
    return max(crash_stop_speed_m_s(seen_m - margin_m, reaction_s, config), least_m_s)


def _room_m(field: ClearanceField, here: Point, north: float, east: float, steps: int) -> float:
    """Distance along a direction to where the hull would touch something certain; infinite for none."""
    if field.at(*here) & SOLID:
        return math.inf  # turning away, not slowing down, helps
    for step in range(1, steps + 1):
        away_m = step * field.cell_m
        if field.at(here.north_m + away_m * north, here.east_m + away_m * east) & SOLID:
            return away_m
    return math.inf
