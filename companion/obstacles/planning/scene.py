"""Input of the avoidance decisions at one moment: boat, intent and obstacles."""

import math
from collections.abc import Sequence

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point, bearing_rad, distance_m
from companion.core.intent import FollowCircle, FollowLeg, HoldCourse, HoldHeading, Intent, KeepStation
from companion.core.state import NavState
from companion.core.units import wrap_pi
from companion.guidance.speed_profile import braking_speed_m_s
from companion.obstacles.perception.perception import ObstaclePerception
from companion.obstacles.perception.track import Track
from companion.obstacles.planning.free_space import ChartedBounds, FreeSpace, clear_m
from companion.obstacles.planning.way_ahead import way_ahead

WIDER = 1.2  # a detour keeps this times the margin, so that its end does not start another
HULL = 0.6  # of the margin: the boat stops for obstacles this near ahead
_DRIFT_S = 0.8  # how long the current carries a turning boat
_STILL_SHARE = 0.4  # of the slowest speed with steerage way: weaker currents are ignored
_FAR_M = 1000.0  # end of a course
_SPREAD = 0.6  # of the margin: spread of a mover's echoes in the grid
_IN_VIEW_S = 1.0  # a mover not observed for longer is known by its echoes only
_CONE = 0.7  # cosine of 45°
_GENTLE_SHARE = 0.5  # of the room is planned for braking: near rest only the propellers brake, and weakly


class Scene:
    """solid: certain obstacles; obstacles: suspected ones as well; movers: moving or probably moving;
    has_unclassified: a track may turn out to move. margin_m: distance to keep, more in a current; sight_m:
    range of the sonar.
    """

    def __init__(
        self,
        intent: Intent,
        nav: NavState,
        config: BoatConfig,
        perception: ObstaclePerception,
        bounds: ChartedBounds,
        now_s: float,
    ) -> None:
        setting = config.avoidance
        self.intent = intent
        self.nav = nav
        self.here = nav.point
        self.config = config
        self.now_s = now_s
        self.sight_m = perception.reach_m or setting.lookahead_m
        self.margin_m = setting.margin_m + _DRIFT_S * math.hypot(nav.current_north_m_s, nav.current_east_m_s)
        self.speed_m_s = math.hypot(nav.north_m_s, nav.east_m_s)
        self.movers: Sequence[Track] = perception.tracks.likely(now_s)
        self.solid = self._still(perception.solid(now_s))
        self.obstacles = self._still(perception.suspects(now_s))
        self.has_unclassified = perception.has_unclassified(now_s)
        self.bounds = bounds
        self.water_known = perception.water
        self._water: FreeSpace | None = None

    def _still(self, obstacles: list[Point]) -> list[Point]:
        """The static obstacles: without the echoes of movers."""
        movers = [mover for mover in self.movers if mover.is_mover and self.now_s - mover.seen_s < _IN_VIEW_S]
        if not movers:
            return obstacles
        spread_m = _SPREAD * self.config.avoidance.margin_m
        return [
            obstacle
            for obstacle in obstacles
            if not any(mover.was_at(obstacle, mover.radius_m + spread_m) for mover in movers)
        ]

    @property
    def water(self) -> FreeSpace:
        """The courses open to a detour."""
        if self._water is None:
            self._water = FreeSpace(self.here, self.obstacles, WIDER * self.margin_m, self.sight_m)
            self._water.set_bounds(self.bounds, self.config.fence.margin_m)
        return self._water

    def clear_path_m(self, obstacles: Sequence[Point], share: float = 1.0, reaches: float = 1.0) -> float:
        """Distance free of obstacles by a share of the margin along the path, up to `reaches` sights
        ahead.
        """
        reach_m = reaches * self.sight_m
        way = way_ahead(self.intent, self.nav, self.config, reach_m)
        return clear_m(way, obstacles, share * self.margin_m, reach_m)

    def heading_for_rad(self, course_rad: float, speed_m_s: float) -> float:
        """The heading for a course and speed over ground in this current."""
        nav = self.nav
        return math.atan2(
            speed_m_s * math.sin(course_rad) - nav.current_east_m_s,
            speed_m_s * math.cos(course_rad) - nav.current_north_m_s,
        )

    def stopping_speed_m_s(self, room_m: float) -> float:
        """The speed from which the boat can stop in a distance."""
        return braking_speed_m_s(_GENTLE_SHARE * room_m, 0.0, self.config.guidance)

    def must_stop_to_turn(self, heading_rad: float) -> bool:
        """Whether to stop first: turning on the spot leaves no thrust for braking."""
        nav, guidance = self.nav, self.config.guidance
        if not self.config.drive.can_pivot:
            return False  # it turns under way
        turn = abs(wrap_pi(heading_rad - nav.heading_rad))
        return turn > guidance.pivot_angle_rad and nav.surge_m_s > 0.5 * guidance.min_speed_m_s

    def stop(self) -> HoldHeading:
        """Stop. In a current, the bow must point into it to hold against it; a boat that cannot turn on the
        spot stays as it lies, as turning would take it ahead.
        """
        nav, current_m_s = self.nav, math.hypot(self.nav.current_north_m_s, self.nav.current_east_m_s)
        is_still = current_m_s < _STILL_SHARE * self.config.guidance.min_speed_m_s
        if is_still or not self.config.drive.can_pivot:
            return HoldHeading(nav.heading_rad, 0.0)
        return HoldHeading(math.atan2(-nav.current_east_m_s, -nav.current_north_m_s), 0.0)

    def escape_course_rad(self) -> float | None:
        """The course directly away from an obstacle that is too near; None if there is none."""
        nearest = min(self.obstacles, key=self._distance_m, default=None)
        if nearest is None or self._distance_m(nearest) > HULL * self.margin_m:
            return None
        return bearing_rad(nearest, self.here)

    def _distance_m(self, obstacle: Point) -> float:
        return distance_m(self.here, obstacle)

    def room_ahead_m(self) -> float:
        """Distance that the hull can continue on its present course; infinite at rest."""
        nav = self.nav
        if self.speed_m_s < 0.25 * self.config.guidance.min_speed_m_s:
            return math.inf
        return self.room_m(math.atan2(nav.east_m_s, nav.north_m_s))

    def room_m(self, course_rad: float) -> float:
        """Room for the hull along a course; infinite beyond the sight."""
        reach_m = self.sight_m
        end = Point(
            self.here.north_m + reach_m * math.cos(course_rad),
            self.here.east_m + reach_m * math.sin(course_rad),
        )
        return clear_m([self.here, end], self.solid, HULL * self.margin_m, reach_m)

    def nearest_m(self, bearing_rad: float) -> float:
        """Distance to the nearest obstacle within 45° of a bearing; infinite for none."""
        nearest, ahead_n, ahead_e = math.inf, math.cos(bearing_rad), math.sin(bearing_rad)
        for obstacle in self.obstacles:
            north, east = obstacle.north_m - self.here.north_m, obstacle.east_m - self.here.east_m
            distance = math.sqrt(north * north + east * east)
            if distance < nearest and north * ahead_n + east * ahead_e > _CONE * distance:
                nearest = distance
        return nearest

    def goal(self) -> Point:
        """The destination of the intent."""
        if isinstance(self.intent, FollowLeg):
            return self.intent.end
        reach_m = _FAR_M if isinstance(self.intent, HoldCourse | HoldHeading) else self.sight_m
        return way_ahead(self.intent, self.nav, self.config, reach_m)[-1]

    def desired_course_and_speed(self, instead: Intent | None) -> tuple[float, float]:
        """Course and speed over ground of the intent, or of instead."""
        intent = self.intent if instead is None else instead
        if isinstance(intent, HoldCourse):
            return intent.course_rad, intent.speed_m_s
        if isinstance(intent, FollowLeg) and intent.line.length_m > 0.0:
            _, cross_m = intent.line.along_and_cross_track_m(self.here)
            back_rad = math.atan2(cross_m, self.config.guidance.lookahead_m)
            return wrap_pi(intent.line.course_rad - back_rad), self.requested_speed_m_s()
        way = way_ahead(intent, self.nav, self.config, self.sight_m)
        if len(way) < 2 or (isinstance(intent, KeepStation) and distance_m(way[0], way[1]) < self.margin_m):
            return self.nav.heading_rad, 0.0
        return bearing_rad(way[0], way[1]), self.requested_speed_m_s()

    def requested_speed_m_s(self) -> float:
        """The speed of the intent."""
        if isinstance(self.intent, FollowLeg | FollowCircle | HoldCourse | HoldHeading):
            return abs(self.intent.speed_m_s)
        return self.config.speed.cruise_m_s
