"""What every task gives: a route in legs, each with a kind, and the times to hold at their ends."""

import contextlib
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

from companion.core.geo import LatLon, LocalFrame, Point, path_length_m
from companion.planning.visibility import NoWay
from mission_tools.errors import NoRouteError, UsageError
from mission_tools.maps.chart import Chart
from mission_tools.mission.mission import Mission, MissionItem
from mission_tools.mission.route import with_speed
from mission_tools.mission.trigger import Trigger
from mission_tools.planning.exact_planner import fitted, water_of
from mission_tools.planning.planner import PlanSettings, plan

LegKind = Literal["transit", "track", "shore", "cross"]
Parts = Sequence[tuple[str, Sequence[Point]]]
"""Of a mission that was split: each in words, and its line."""
LONGEST_HOLD_S = 65_535.0  # ArduPilot keeps the hold time of a waypoint in 16 bits, in whole seconds


@dataclass(frozen=True, slots=True)
class Stop:
    """A place to sail to. hold_s: how long the boat holds there. name: for messages."""

    place: Point
    hold_s: float = 0.0
    name: str = ""

    def __post_init__(self) -> None:
        if not 0.0 <= self.hold_s <= LONGEST_HOLD_S:
            raise UsageError(
                f"hold time is {self.hold_s:g} s: expected 0 to {LONGEST_HOLD_S:g} s, the most there is"
            )


@dataclass(frozen=True, slots=True)
class TaskLeg:
    """A part of a route, at least two points long, or one where the boat already is at its end.

    kind: transit, between two places; track, of a survey; shore, along a shore; cross, a survey's cross line.
    hold_s: how long to hold at its end.
    """

    kind: LegKind
    points: tuple[Point, ...]
    hold_s: float = 0.0

    @property
    def length_m(self) -> float:
        """The length along its points."""
        return path_length_m(self.points)


@dataclass(frozen=True, slots=True)
class TaskRoute:
    """Legs in the order of sailing; each begins where the one before it ends, the first at the start.

    notes: what a person should know.
    """

    legs: tuple[TaskLeg, ...]
    notes: tuple[str, ...] = ()

    @property
    def points(self) -> tuple[Point, ...]:
        """The whole route, each point once."""
        return tuple(point for point, _ in self.waypoints)

    @property
    def waypoints(self) -> tuple[tuple[Point, float], ...]:
        """The whole route with the hold time of each point; the first is where the boat starts."""
        return tuple((point, hold_s) for point, hold_s, _ in self.ahead)

    @property
    def ahead(self) -> tuple[tuple[Point, float, LegKind], ...]:
        """The whole route with the hold time of each point and the kind of the leg after it."""
        found: list[tuple[Point, float, LegKind]] = []
        for leg in self.legs:
            if found and len(leg.points) > 1:
                found[-1] = *found[-1][:2], leg.kind
            for point in leg.points:
                if not found or point != found[-1][0]:
                    found.append((point, 0.0, leg.kind))
            if leg.hold_s > 0.0:
                place, hold_s, kind = found[-1]
                found[-1] = place, max(hold_s, leg.hold_s), kind
        return tuple(found)

    @property
    def length_m(self) -> float:
        """The length of all legs together."""
        return sum(leg.length_m for leg in self.legs)

    @property
    def hold_s(self) -> float:
        """The time at all stops together."""
        return sum(leg.hold_s for leg in self.legs)

    def length_of_m(self, kind: LegKind) -> float:
        """Of the legs of one kind."""
        return sum(leg.length_m for leg in self.legs if leg.kind == kind)

    def min_clearance_m(self, chart: Chart) -> float:
        """Smallest distance from the route to a shore; infinite in open water."""
        water, points = water_of(chart), self.points
        return min((water.leg_distance_m(a, b) for a, b in pairwise(points)), default=math.inf)


def mission_of(
    route: TaskRoute, frame: LocalFrame, speed_m_s: float | None = None, trigger: Trigger | None = None
) -> Mission:
    """The route as a mission: its first point is home, the others are waypoints.

    A hold is the first parameter of its NAV_WAYPOINT, which ArduPilot, PX4, QGroundControl and this project's
    boat all read as seconds to wait there. ArduPilot keeps whole seconds: a fraction is rounded up. trigger:
    its items stand where legs begin that are no transits, and where they end. Raises UsageError: fewer than
    two points, or a speed out of range.
    """
    waypoints = route.ahead
    if len(waypoints) < 2:
        raise UsageError(f"a route needs a start and a goal, got {len(waypoints)} point(s)")
    items: list[MissionItem] = []
    is_on = False
    for number, (place, hold_s, kind) in enumerate(waypoints):
        begins = kind != "transit" and number < len(waypoints) - 1
        if number > 0 or (trigger and begins):
            params = (float(-int(-hold_s // 1)), 0.0, 0.0, 0.0)
            items.append(MissionItem.at(frame.to_global(place), params=params))
        if trigger is not None and begins != is_on:
            items.append(trigger.begin if begins else trigger.end)
            is_on = begins
    home: LatLon = frame.to_global(waypoints[0][0])
    return with_speed(Mission(tuple(items), home=home), speed_m_s)


def joined(legs: Iterable[TaskLeg], notes: Sequence[str] = ()) -> TaskRoute:
    """A route of these legs, without those that lead nowhere and hold for no time."""
    return TaskRoute(tuple(leg for leg in legs if len(set(leg.points)) > 1 or leg.hold_s > 0.0), tuple(notes))


ROUNDING = 1e-9  # of the clearance: the ends of tracks lie at the clearance itself


class Transits:
    """Plans the way between two places, and remembers it."""

    def __init__(self, chart: Chart, settings: PlanSettings) -> None:
        self._chart = chart
        self._settings = settings
        self._routes = water_of(chart).routes(settings.required_m * (1.0 - ROUNDING))
        self._found: dict[tuple[Point, Point], tuple[Point, ...] | NoRouteError] = {}

    def route(self, start: Point, goal: Point) -> tuple[Point, ...]:
        """The points of the way, both ends included. Raises NoRouteError: there is none."""
        found = self._found.get((start, goal))
        if found is None:
            found = self._found[start, goal] = self._plan(start, goal)
            if not isinstance(found, NoRouteError):
                self._found.setdefault((goal, start), found[::-1])
        if isinstance(found, NoRouteError):
            raise found
        return found

    def lengths_m(self, start: Point, goals: Sequence[Point]) -> list[float]:
        """Of the way to each goal; infinite where there is none."""
        lengths = []
        for goal in goals:
            length_m = math.inf
            with contextlib.suppress(NoRouteError):
                length_m = path_length_m(self.route(start, goal))
            lengths.append(length_m)
        return lengths

    def _plan(self, start: Point, goal: Point) -> tuple[Point, ...] | NoRouteError:
        if start == goal:
            return (start,)
        with contextlib.suppress(NoWay):
            return fitted(self._routes.route(start, goal), self._routes, self._settings.required_m)
        try:  # with less of a margin, or from a jetty; else it says why not
            return plan(self._chart, start, goal, self._settings).points
        except NoRouteError as error:
            return error
