"""A planned mission leg by leg: lengths, times, and where each passes nearest to something."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import shapely

from companion.core.geo import Point, bearing_rad, distance_m
from mission_tools.assembly.planned_mission import PlannedMission
from mission_tools.maps.chart import Chart
from mission_tools.mission.qgc_plan import DEFAULT_SPEED_M_S


@dataclass(frozen=True, slots=True)
class Leg:
    """From one waypoint to the next.

    number: of the waypoint where it ends. clearance_m: infinite in open water; nearest and worst say what the
    leg passes at that distance, and where on the leg that is. arrive_s: from the start, before hold_s.
    """

    number: int
    start: Point
    end: Point
    length_m: float
    course_deg: float
    clearance_m: float
    nearest: str
    worst: Point
    hold_s: float
    arrive_s: float


@dataclass(frozen=True, slots=True)
class Itinerary:
    """All legs. speed_m_s: through the whole route; is_assumed: the mission does not say it."""

    legs: tuple[Leg, ...]
    speed_m_s: float
    is_assumed: bool

    @property
    def length_m(self) -> float:
        """The length of all legs together."""
        return sum(leg.length_m for leg in self.legs)

    @property
    def duration_s(self) -> float:
        """Until the end of the last hold."""
        return self.legs[-1].arrive_s + self.legs[-1].hold_s if self.legs else 0.0

    def worst(self, count: int) -> list[Leg]:
        """The legs that pass nearest to something, the nearest first; one for each place."""
        found: list[Leg] = []
        for leg in sorted(self.legs, key=lambda leg: leg.clearance_m):
            is_new = all(distance_m(leg.worst, other.worst) > leg.clearance_m for other in found)
            if math.isfinite(leg.clearance_m) and is_new:
                found.append(leg)
        return found[:count]


def itinerary(planned: PlannedMission) -> Itinerary:
    """The legs of a mission on its chart."""
    mission, points = planned.mission, planned.points
    speed_m_s = mission.speed_m_s or DEFAULT_SPEED_M_S
    holds = [item.hold_s for item in mission.items if item.place is not None]
    holds = [0.0] * (len(points) - len(holds)) + holds
    legs: list[Leg] = []
    clock_s = 0.0
    for number, ((start, end), hold_s) in enumerate(zip(pairwise(points), holds[1:], strict=True), 1):
        length_m = distance_m(start, end)
        clock_s += length_m / speed_m_s
        clearance_m, nearest, worst = _tightest(planned.chart, start, end)
        course_deg = math.degrees(bearing_rad(start, end)) % 360.0
        legs.append(
            Leg(number, start, end, length_m, course_deg, clearance_m, nearest, worst, hold_s, clock_s)
        )
        clock_s += hold_s
    return Itinerary(tuple(legs), speed_m_s, mission.speed_m_s is None)


def _tightest(chart: Chart, start: Point, end: Point) -> tuple[float, str, Point]:
    if chart.shores.is_empty:
        return math.inf, "", start
    line = shapely.LineString([(start.east_m, start.north_m), (end.east_m, end.north_m)])
    ends: Sequence[tuple[float, float]] = shapely.shortest_line(line, chart.shores).coords
    (east_m, north_m), (shore_east_m, shore_north_m) = ends
    nearest = chart.nearest_feature(Point(shore_north_m, shore_east_m))
    clearance_m = math.hypot(shore_east_m - east_m, shore_north_m - north_m)
    return clearance_m, nearest, Point(north_m, east_m)
