"""Avoidance over water whose obstacles and bounds a test sets."""

import math

import pytest
from boat_rig import nav_at
from msgspec.structs import replace

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point
from companion.core.intent import (
    HoldCourse,
    Intent,
)
from companion.core.state import NavState
from companion.core.status_text import StatusText
from companion.geofence.fence import Fence
from companion.obstacles.perception.perception import ObstaclePerception
from companion.obstacles.planning.avoidance import Avoidance, Stage
from companion.obstacles.planning.free_space import ChartedBounds

CONFIG = BoatConfig()
NORTH = HoldCourse(0.0, 2.0)


class Chart(ObstaclePerception):
    """What is known of the water is set by the test."""

    def __init__(self, *solid: Point) -> None:
        super().__init__(CONFIG.avoidance)
        self.reach_m = 4.0
        self.rocks = list(solid)
        self.seen_once: list[Point] = []
        self.is_within_sight = True
        self.has_new = False

    @property
    def is_empty(self) -> bool:
        return False

    def is_near(self, at: Point) -> bool:
        return self.is_within_sight

    def solid(self, now_s: float) -> list[Point]:
        return self.rocks

    def suspects(self, now_s: float) -> list[Point]:
        return self.rocks + self.seen_once

    def has_unclassified(self, now_s: float) -> bool:
        return self.has_new


class Lines:
    """Bounds to port and to starboard of a boat on its way north."""

    is_active = True

    def __init__(self, west_m: float, east_m: float) -> None:
        self.west_m, self.east_m = west_m, east_m

    def is_charted(self, point: Point) -> bool:
        return False

    def room_m(self, point: Point, course_rad: float, reach_m: float) -> float:
        east = math.sin(course_rad)
        line_m = self.east_m if east > 0.0 else self.west_m
        return reach_m if abs(east) < 1e-9 else min((line_m - point.east_m) / east, reach_m)


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


class Voyage:
    """One avoidance, asked at literal times."""

    def __init__(self, *solid: Point, config: BoatConfig = CONFIG) -> None:
        self.texts: list[StatusText] = []
        self.avoidance = Avoidance(self.texts)
        self.chart, self.config = Chart(*solid), config
        self.bounds: ChartedBounds = Fence()
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
        return self.avoidance.update(
            intent, nav or boat(), self.config, self.chart, self.bounds, is_by_hand=is_by_hand, now_s=now_s
        )

    def stage(self) -> Stage:
        return self.avoidance.stage

    @property
    def said(self) -> list[str]:
        return [one.text for one in self.texts]

    @property
    def limit_m_s(self) -> float:
        return self.avoidance.safe_speed.ahead_m_s

    def is_wary(self, east_m: float = 0.0) -> bool:
        return self.chart.water.is_limited(Point(0.0, east_m), 2, self.bounds)


def is_course(found: Intent, deg: float, speed_m_s: float) -> bool:
    assert isinstance(found, HoldCourse)
    off = math.remainder(found.course_rad - math.radians(deg), math.tau)
    return abs(off) < 1e-9 and found.speed_m_s == pytest.approx(speed_m_s)
