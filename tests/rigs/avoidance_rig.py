"""Avoidance over water whose obstacles and bounds a test sets."""

import math

from boat_rig import nav_at
from msgspec.structs import replace

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point
from companion.core.intent import FollowLeg, HoldCourse, Intent
from companion.core.state import NavState
from companion.core.status_text import StatusText
from companion.geofence.fence import Fence
from companion.obstacles.perception.occupancy import SWEEP_S, Beam
from companion.obstacles.perception.perception import ObstaclePerception
from companion.obstacles.perception.track import Track
from companion.obstacles.planning.clearance import ClearanceBounds
from companion.obstacles.planning.planner import LocalPlanner, Stage

CONFIG = BoatConfig()
NORTH = HoldCourse(0.0, 2.0)
LEG = FollowLeg(Point(0.0, 0.0), Point(50.0, 0.0), 1.0)
WALL = [Point(3.0, -9.0 + 0.2 * step) for step in range(91)]


class Chart(ObstaclePerception):
    """What is known of the water is set by the test."""

    def __init__(self, *solid: Point) -> None:
        super().__init__(CONFIG.avoidance)
        self.reach_m = 4.0
        self.rocks = list(solid)
        self.seen_once: list[Point] = []
        self.is_within_sight = True

    @property
    def is_empty(self) -> bool:
        return False

    def is_near(self, at: Point) -> bool:
        return self.is_within_sight

    def solid(self) -> list[Point]:
        return self.rocks

    def suspects(self) -> list[Point]:
        return self.rocks + self.seen_once


class Lines:
    """Bounds to port and to starboard of a boat on its way north."""

    is_active = True
    version = 1

    def __init__(self, west_m: float, east_m: float) -> None:
        self.west_m, self.east_m = west_m, east_m

    def room_m(self, point: Point, course_rad: float, reach_m: float) -> float:
        east = math.sin(course_rad)
        line_m = self.east_m if east > 0.0 else self.west_m
        return reach_m if abs(east) < 1e-9 else min((line_m - point.east_m) / east, reach_m)

    def is_near(self, point: Point, reach_m: float) -> bool:
        return self.margin_within_m(*point, reach_m) < reach_m

    def margin_within_m(self, north_m: float, east_m: float, limit_m: float) -> float:
        return min(east_m - self.west_m, self.east_m - east_m, limit_m)

    def is_charted(self, point: Point) -> bool:
        return False


def mover(
    north_m: float, east_m: float, north_m_s: float = 0.0, east_m_s: float = 0.0, now_s: float = 0.9
) -> Track:
    """At this place and velocity at now_s, known to a centimetre."""
    start = Point(north_m - now_s * north_m_s, east_m - now_s * east_m_s)
    track = Track(1, 0.0, start, 0.4)
    for look in range(10):
        time_s = now_s * look / 9.0
        track.predict(time_s, 0.0)
        at = Point(start.north_m + north_m_s * time_s, start.east_m + east_m_s * time_s)
        for axis in ((1.0, 0.0), (0.0, 1.0)):
            track.correct(at, *axis, 1e-3)
        if look:
            track.complete_observation(0.4, 1.0, 0.0)
    track.is_mover = True
    return track


def ring(radius_m: float) -> list[Point]:
    angles = [math.radians(10.0 * step) for step in range(36)]
    return [Point(radius_m * math.cos(angle), radius_m * math.sin(angle)) for angle in angles]


def boat(
    north_m: float = 0.0, east_m: float = 0.0, speed_m_s: float = 1.0, heading_rad: float = 0.0
) -> NavState:
    return replace(
        nav_at(north_m, east_m),
        north_m_s=speed_m_s * math.cos(heading_rad),
        east_m_s=speed_m_s * math.sin(heading_rad),
        surge_m_s=speed_m_s,
        heading_rad=heading_rad,
    )


ROCK = [Point(3.5 + n, e) for n, e in (*ring(0.3), Point(0.0, 0.0))]


class Voyage:
    """One avoidance, asked at literal times."""

    def __init__(self, *solid: Point, config: BoatConfig = CONFIG) -> None:
        self.texts: list[StatusText] = []
        self.planner = LocalPlanner(self.texts)
        self.chart, self.config = Chart(*solid), config
        self.bounds: ClearanceBounds = Fence()
        self.now_s = 0.0

    def at(
        self,
        now_s: float,
        nav: NavState | None = None,
        intent: Intent = NORTH,
        *,
        is_by_hand: bool = False,
    ) -> Intent:
        self.now_s = now_s
        return self.planner.update(
            intent, nav or boat(), self.config, self.chart, self.bounds, is_by_hand=is_by_hand, now_s=now_s
        )

    def after_a_sweep(self, nav: NavState | None = None, intent: Intent = NORTH) -> Intent:
        """The decision when the extent of what was met is known."""
        self.at(self.now_s, nav, intent)
        here = (nav or boat()).point
        for bearing_rad in [math.radians(15.0 * step) for step in range(24)]:
            self.chart.water.add(Beam(self.now_s, here, bearing_rad, 0.26, math.inf, 4.0))
        return self.at(self.now_s + SWEEP_S + 0.1, nav, intent)

    def stage(self) -> Stage:
        return self.planner.stage

    @property
    def said(self) -> list[str]:
        return [one.text for one in self.texts]

    @property
    def limit_m_s(self) -> float:
        return self.planner.limit.ahead_m_s

    def is_wary(self, east_m: float = 0.0) -> bool:
        return self.chart.water.is_limited(Point(0.0, east_m), 2, self.bounds)
