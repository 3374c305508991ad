"""A task cut into parts, each from home and back within one pack.

Route first, cluster second: the task's own order is kept, and dynamic programming finds the best places to
cut it (J. E. Beasley, "Route first–cluster second methods for vehicle routing", *Omega* 11, 1983; C. Prins,
*Computers & Operations Research* 31, 2004), exact for this order. Tracks are arcs that must be sailed, as in
capacitated arc routing (B. L. Golden and R. T. Wong, *Networks* 11, 1981). Fewest parts first, then fewest
tracks that are cut in the middle, then the least way.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import accumulate, pairwise, takewhile
from typing import NamedTuple

import numpy as np

from companion.core.geo import Point, distance_m, path_length_m
from mission_tools.assembly.planned_mission import PlannedMission
from mission_tools.contract.budget import Budget, budget_of, planned_budget
from mission_tools.contract.ways_home import ways_home_m
from mission_tools.costs.boat import NO_DRAW, Boat, load_boat
from mission_tools.costs.current import STILL_WATER, Current
from mission_tools.costs.current_source import open_current
from mission_tools.errors import BeyondRange, UsageError
from mission_tools.mission.mission import Command, Mission
from mission_tools.planning.planner import PlanSettings
from mission_tools.tasks.task_route import TaskLeg, TaskRoute, Transits, joined, mission_of
from mission_tools.wording import counted, distance, duration

HEADROOM = 0.1
"""Share of the pack that parts leave unused: what a planned charge may be off (docs/planner.md, Budget)."""
GRAIN = 16
"""A leg may be cut at so many places a pack: what a part leaves unused for want of a place is a sixteenth."""
_ROUNDING_M = 1e-6


class Part(NamedTuple):
    """From home over a part of the work and back. budget: from a full pack."""

    planned: PlannedMission
    budget: Budget


@dataclass(frozen=True, slots=True)
class Split:
    """whole: all parts in order. work_mah: the charge of the work, without ways to it and between legs."""

    whole: PlannedMission
    parts: tuple[Part, ...]
    work_mah: float

    @property
    def least(self) -> int:
        """No fewer packs hold the charge of the work."""
        return max(1, math.ceil(self.work_mah / self.parts[0].budget.usable_mah - 1e-9))

    def lines(self) -> list[str]:
        """The parts as lines of output."""
        said = f"{counted(len(self.parts), 'part')}; the work alone takes {self.work_mah:.0f} mAh, "
        said += f"the usable charge of {counted(self.least, 'pack')}"
        return [said, *(words for words, _ in self.whole.parts)]


def split(planned: PlannedMission, boat: Boat | str, current: Current | str | None = None) -> Split:
    """The fewest parts that each come home with the reserve and with the margin at which the boat would turn
    home by itself. boat, current: as for `planned_budget`.

    Raises BeyondRange: a piece of the work that no pack reaches. UsageError: the boat's draw is not known, or
    a mission from a file that is more than waypoints. NoRouteError: no way home, or a leg that cannot be
    sailed against the current.
    """
    boat = load_boat(boat) if isinstance(boat, str) else boat
    current = open_current(current, planned.chart.frame) if isinstance(current, str) else current
    if not boat.knows_its_draw:
        raise UsageError(f"--split: {NO_DRAW}")
    if current is not None and current.times is not None:
        raise UsageError("--split: only in a current that stays, as nobody knows when each pack is changed")
    cautious = replace(boat, capacity_mah=boat.capacity_mah * (1.0 - HEADROOM))
    work = _Work(planned, cautious, current or STILL_WATER)
    parts = tuple(
        Part(part, planned_budget(part, boat, current))
        for part in (_sailing(planned, work.route(first, end)) for first, end in work.best_cuts())
    )
    lines: list[tuple[str, tuple[Point, ...]]] = []
    legs: list[TaskLeg] = []
    for n, (part, budget) in enumerate(parts, 1):
        budget.check()
        said = f"part {n}: {distance(budget.length_m)}, {duration(budget.time_s)}"
        lines.append((f"{said}, {budget.charge_mah:.0f} of {budget.usable_mah:.0f} mAh", part.points))
        legs += part.task.legs if part.task is not None else ()
    whole = replace(_sailing(planned, TaskRoute(tuple(legs))), parts=lines)
    return Split(whole, parts, work.charge_mah)


def rest_of(part: PlannedMission, item: int, boat: Boat, current: str | None = None) -> Part:
    """What a part leaves once its mission item was reached: straight back there from home, and on. Raises
    UsageError: nothing is left after it, or no such item. NoRouteError, BeyondRange: as `split`.
    """
    waypoints = () if part.task is None else part.task.waypoints
    reached = sum(one.place is not None for one in part.mission.items[:item])
    if not 0 < item <= len(part.mission.items) or reached >= len(waypoints) - 1:
        most = len(part.mission.items) - 1
        raise UsageError(f"--resume: after item {item} nothing is left: expected 1 to {most}")
    way = _transits(part).route(waypoints[0][0], waypoints[reached][0])
    legs = () if part.task is None else part.task.legs
    rest = [
        TaskLeg(leg.kind, leg.points[max(reached - start, 0) :], leg.hold_s)
        for leg, (start, end) in zip(legs, pairwise(_waypoints_before(legs)), strict=True)
        if end > reached
    ]
    planned = _sailing(part, joined([TaskLeg("transit", way), *rest]))
    budget = planned_budget(planned, boat, current)
    budget.check()
    return Part(planned, budget)


def _transits(planned: PlannedMission) -> Transits:
    """With the room that the task keeps; with the usual room for a mission from a file, which keeps none."""
    settings = PlanSettings(planned.clearance_m, margin_m=planned.margin_m)
    return Transits(planned.chart, PlanSettings() if planned.clearance_m == 0.0 else settings)


def _sailing(planned: PlannedMission, route: TaskRoute) -> PlannedMission:
    """The mission along such a route, with fence, rally points and speed of the whole."""
    mission = mission_of(route, planned.chart.frame, trigger=planned.trigger)
    speeds = takewhile(lambda item: item.command == Command.DO_CHANGE_SPEED, planned.mission.items)
    survey = None if planned.survey is None else replace(planned.survey, route=route)
    mission = replace(planned.mission, items=(*speeds, *mission.items), home=mission.home)
    return replace(planned, mission=mission, plan=None, task=route, survey=survey, timetable=None)


def _waypoints_before(legs: Sequence[TaskLeg]) -> list[int]:
    """How many waypoints come before each leg's end; first, before the first leg."""
    return [0, *accumulate(sum(a != b for a, b in pairwise(leg.points)) for leg in legs)]


class _Piece(NamedTuple):
    """A stretch of a leg that is work; parts begin and end with whole pieces."""

    leg: int
    start_m: float
    end_m: float


class _Work:
    """The legs of a task, and the pieces that they are cut into."""

    def __init__(self, planned: PlannedMission, boat: Boat, current: Current) -> None:
        self._planned, self._boat, self._current = planned, boat, current
        legs = _legs_of(planned)
        self._legs = tuple(leg for leg, _ in legs)
        self._home: Point = self._legs[0].points[0]
        self._transits = _transits(planned)
        self._ways_m: dict[Point, float] = {}
        whole = self._budget(TaskRoute(self._legs))
        drawn_mah = [0.0, *whole.drawn_mah]
        spent = zip(legs, pairwise(_waypoints_before(self._legs)), strict=True)
        self.charge_mah = sum(
            drawn_mah[end] - drawn_mah[start] for (_, is_work), (start, end) in spent if is_work
        )
        grain_m = whole.usable_mah / whole.charge_mah * whole.length_m / GRAIN
        self._pieces = [
            _Piece(number, leg.length_m * n / count, leg.length_m * (n + 1) / count)
            for number, (leg, is_work) in enumerate(legs)
            if is_work
            for count in [max(1, math.ceil(leg.length_m / grain_m))]
            for n in range(count)
        ]

    def best_cuts(self) -> list[tuple[int, int]]:
        """The pieces of each part, as (first, end)."""
        pieces, count = self._pieces, len(self._pieces)
        before_m = [0.0, *accumulate(leg.length_m for leg in self._legs)]
        out_m = [path_length_m(self._way_to(self._ends(n)[0])) for n in range(count)]
        back_m = [path_length_m(self._way_to(self._ends(n)[1])) for n in range(count)]
        best: list[tuple[int, int, float, int]] = [(0, 0, 0.0, 0)]
        best += [(count + 1, 0, 0.0, 0)] * count
        end = 0
        for first in range(count):
            while end > first and not self._fits(first, end):
                end -= 1
            while end < count and self._fits(first, end + 1):
                end += 1
            if end == first:
                at = self._planned.chart.frame.to_global(self._ends(first)[0])
                raise BeyondRange(
                    f"no pack takes the boat to {at.lat_deg:.6f},{at.lon_deg:.6f} and home with "
                    f"{self._boat.margin:g} times the charge for the way home left: start nearer or skip it"
                )
            parts, cuts, way_m, _ = best[first]
            cuts += first > 0 and pieces[first - 1].leg == pieces[first].leg
            way_m += out_m[first] - before_m[pieces[first].leg] - pieces[first].start_m
            for last in range(first, end):
                sailed_m = before_m[pieces[last].leg] + pieces[last].end_m + back_m[last]
                best[last + 1] = min(best[last + 1], (parts + 1, cuts, way_m + sailed_m, first))
        found, end = [], count
        while end:
            found.append((best[end][3], end))
            end = best[end][3]
        return found[::-1]

    def route(self, first: int, end: int) -> TaskRoute:
        """From home over these pieces, by the ways that the task has between them, and back."""
        start, last = self._pieces[first], self._pieces[end - 1]
        legs = []
        for number in range(start.leg, last.leg + 1):
            leg = self._legs[number]
            from_m = start.start_m if number == start.leg else 0.0
            to_m = last.end_m if number == last.leg else leg.length_m
            legs.append(_stretch(leg, from_m, to_m))
        out, back = self._way_to(legs[0].points[0]), self._way_to(legs[-1].points[-1])[::-1]
        return joined([TaskLeg("transit", out), *legs, TaskLeg("transit", back)])

    def _ends(self, number: int) -> tuple[Point, Point]:
        piece = self._pieces[number]
        points = _stretch(self._legs[piece.leg], piece.start_m, piece.end_m).points
        return points[0], points[-1]

    def _way_to(self, place: Point) -> tuple[Point, ...]:
        return self._transits.route(self._home, place)

    def _fits(self, first: int, end: int) -> bool:
        return bool(self._budget(self.route(first, end)).suffices)

    def _budget(self, route: TaskRoute) -> Budget:
        points, planned = route.points, self._planned
        holds_s = [hold_s for _, hold_s in route.waypoints[1:]]
        ways_m = ways_home_m(planned.chart, points, planned.clearance_m, self._ways_m)
        return budget_of(points, holds_s, ways_m, self._boat, planned.mission.speed_m_s, self._current)


def _legs_of(planned: PlannedMission) -> list[tuple[TaskLeg, bool]]:
    """The legs of the whole, and which of them are work: a survey's and a shore's all but the transits, a
    mission's all but the first and one that leads home. A tour's work are its places.
    """
    if planned.task is not None and any(leg.kind != "transit" for leg in planned.task.legs):
        return [(leg, leg.kind != "transit" or leg.hold_s > 0.0) for leg in planned.task.legs]
    if planned.task is not None:
        found = [pair for leg in planned.task.legs for pair in _with_place(leg)]
    else:
        legs = _legs_of_file(planned.mission, planned.points)
        found = [*_with_place(legs[0]), *((leg, True) for leg in legs[1:])]
    if found[-1][0].points[-1] == found[0][0].points[0] and found[-1][0].hold_s == 0.0:
        found[-1] = found[-1][0], False
    return found


def _legs_of_file(mission: Mission, points: Sequence[Point]) -> list[TaskLeg]:
    if mission.home is None or len(points) < 2:
        raise UsageError("--split: parts begin and end at home: add --start-at LAT,LON")
    plain = {Command.NAV_WAYPOINT, Command.DO_CHANGE_SPEED}
    other = next((n for n, item in enumerate(mission.items, 1) if item.command not in plain), None)
    if other is not None:
        raise UsageError(f"--split: item {other} is no waypoint: only a mission of waypoints can be cut")
    holds_s = [item.hold_s for item in mission.items if item.place is not None]
    return [TaskLeg("track", pair, hold_s) for pair, hold_s in zip(pairwise(points), holds_s, strict=True)]


def _with_place(leg: TaskLeg) -> list[tuple[TaskLeg, bool]]:
    """The way to a place, and the place, which is work."""
    place = TaskLeg("transit", leg.points[-1:], leg.hold_s)
    return [(TaskLeg("transit", leg.points), False), (place, True)]


def _stretch(leg: TaskLeg, from_m: float, to_m: float) -> TaskLeg:
    """A leg from one length along it to another; its hold is at its end."""
    is_end = to_m >= leg.length_m - _ROUNDING_M
    if is_end and from_m <= _ROUNDING_M:
        return leg
    along_m = [0.0, *accumulate(distance_m(a, b) for a, b in pairwise(leg.points))]
    start, end = (
        Point(*(float(np.interp(at_m, along_m, axis)) for axis in zip(*leg.points, strict=True)))
        for at_m in (from_m, along_m[-1] if is_end else to_m)
    )
    between = [
        point
        for point, at_m in zip(leg.points, along_m, strict=True)
        if from_m + _ROUNDING_M < at_m < to_m - _ROUNDING_M
    ]
    return TaskLeg(leg.kind, (start, *between, end), leg.hold_s if is_end else 0.0)
