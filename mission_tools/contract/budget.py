"""Time and charge of a route, out and home, and the point of no return.

The way home is counted as the boat counts it under way (`companion/failsafe/endurance.py`): the charge for
the straight way in the current, at the mean draw and speed of the last half minute, corners included, times
the length of the way by water over that of the straight way. The boat turns back by itself once less than
margin times this is left, so a plan is good only if more is left everywhere on it.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from companion.core.geo import Point, distance_m, path_length_m
from mission_tools.assembly.planned_mission import PlannedMission
from mission_tools.contract.ways_home import home_along_m, ways_home_m
from mission_tools.costs.boat import NO_DRAW, Boat, load_boat
from mission_tools.costs.current import STILL_WATER, Current
from mission_tools.costs.current_source import open_current
from mission_tools.costs.departure import Departure
from mission_tools.costs.legs import route_costs
from mission_tools.costs.manoeuvres import manoeuvres_s, turns_rad
from mission_tools.costs.travel import Floats, Travel, TravelTime
from mission_tools.errors import BeyondRange, NoRoute, UsageError
from mission_tools.wording import distance, duration

STEPS = 200
"""The route is looked at in at most this many places more than it has points."""
TURN_DRAW_S = 4.0
"""A turn by one radian draws what the motors draw in so many seconds at cruise (an emulated survey with 45
sharp corners, lake boat)."""
LEARN_S = 30.0
"""Over so long the boat averages what sailing draws (`Endurance.learn`)."""


@dataclass(frozen=True, slots=True)
class Budget:
    """Times in s, charges in mAh; charges are NaN where the boat's file does not say what it draws.

    home_s, home_mah: from the end of the route straight home by water; 0 where it ends at home, infinite
    where current or wind is too strong. left_mah: at the end, the reserve left out. no_return_m: how far
    along the route the boat may still turn back, None: from everywhere. reached_m: how far it comes at all,
    None: to the end. under_way_s: at each waypoint, before its hold; drawn_mah: after it.
    """

    length_m: float
    time_s: float
    charge_mah: float
    home_m: float
    home_s: float
    home_mah: float
    usable_mah: float
    margin: float
    no_return_m: float | None = None
    reached_m: float | None = None
    capacity_mah: float = math.nan
    under_way_s: tuple[float, ...] = ()
    drawn_mah: tuple[float, ...] = ()

    @property
    def suffices(self) -> bool | None:
        """Whether the boat comes to the end and home; None where its file does not say what it draws."""
        if math.isnan(self.charge_mah):
            return None
        return self.reached_m is None and self.no_return_m is None

    def lines(self) -> list[str]:
        """The budget as lines of output: under way, home, point of no return."""
        said = f"budget: {duration(self.time_s)}"
        home = "from there no way home against current or wind"
        if math.isfinite(self.home_s):
            home = f"home from there {distance(self.home_m)}, {duration(self.home_s)}"
        if math.isnan(self.charge_mah):
            return [f"{said}; {home}; no charge: {NO_DRAW}"]
        out = f"{said}, {self.charge_mah:.0f} of {self.usable_mah:.0f} mAh"
        if math.isinf(self.home_s):
            out += f"; {home}"
        elif self.home_m > 0.0:
            out += f"; {home}, {self.home_mah:.0f} mAh"
        if self.reached_m is not None:
            return [out, f"the charge lasts for {distance(self.reached_m)} of {distance(self.length_m)}"]
        if self.no_return_m is not None:
            return [out, f"point of no return: after {distance(self.no_return_m)}"]
        return [out, f"comes home from everywhere on it with {self.margin:g} times the charge for the way"]

    def check(self, *, one_way: bool = False) -> None:
        """See that the boat comes home; one_way: to the end. Raises BeyondRange: says how far it comes."""
        if self.reached_m is not None:
            raise BeyondRange(
                f"the charge lasts for {distance(self.reached_m)} of {distance(self.length_m)}: "
                f"{self.charge_mah:.0f} mAh are needed, {self.usable_mah:.0f} can be used"
            )
        if self.no_return_m is not None and not one_way:
            raise BeyondRange(
                f"the boat does not come home: its point of no return is {distance(self.no_return_m)} along "
                f"a route of {distance(self.length_m)} (way home times {self.margin:g}); plan a shorter "
                "route, or add --one-way"
            )


def budget_of(
    points: Sequence[Point],
    holds_s: Sequence[float],
    ways_home_m: Sequence[float],
    boat: Boat,
    speed_m_s: float | None = None,
    current: Current = STILL_WATER,
    depart_s: float = 0.0,
) -> Budget:
    """The budget of a route from a full pack.

    points: start, which is home, and the waypoints. holds_s: at each waypoint, so one less. ways_home_m: from
    each point by water. speed_m_s: over ground, None: the boat's cruise speed. depart_s: on the current's
    clock. Raises NoRoute: a leg that the boat cannot sail against current or wind. UsageError: a speed beyond
    the boat's.
    """
    at, legs = _stations(points)
    speed = boat.speed(speed_m_s)
    starts, ends = at[:-1], at[1:]
    lengths_m = np.hypot(*(ends - starts).T)
    last = np.append(np.flatnonzero(np.diff(legs)), len(legs) - 1)  # the last piece of each leg
    when_s = np.zeros(len(at))
    if current.times is not None:
        when_s = _when_s(at, last, holds_s, TravelTime(speed, current), depart_s)
    time_s, mah = _sailed(starts, ends, boat, speed_m_s, current, when_s[:-1])
    if not np.isfinite(time_s).all():
        first = int(np.flatnonzero(~np.isfinite(time_s))[0])
        there = slice(first, first + 1)
        _, *flow = _flow(starts[there], ends[there], current, when_s[there])
        raise NoRoute(f"leg {int(legs[first]) + 1} cannot be sailed {speed.too_strong(*flow)}")
    turns = turns_rad(points)
    extra_s, under_way = manoeuvres_s(turns, holds_s, boat, speed.over_ground_m_s)
    north, east = current.at(ends[:, 0], ends[:, 1], when_s[1:])
    plain_mah = mah.copy()
    time_s[last] += np.array(extra_s)
    cruising_a = boat.drawn_a(np.array([speed.over_ground_m_s]))[0]
    water = zip(north[last], east[last], holds_s, strict=True)
    held_a = [boat.held_a(float(math.hypot(n, e))) if hold_s else 0.0 for n, e, hold_s in water]
    mah[last] += np.array(extra_s) * cruising_a / 3.6
    mah[last] += np.array(turns) * TURN_DRAW_S * boat.motors_a / 3.6
    learns = np.full(len(legs), fill_value=True)
    learns[last] = under_way
    believed = _believed(time_s, np.where(learns, mah, plain_mah), plain_mah)
    time_s[last] += np.array(holds_s)
    mah[last] += np.array(holds_s) * np.array(held_a) / 3.6
    along_m = np.concatenate(([0.0], np.cumsum(lengths_m)))
    left_mah = boat.usable_mah - np.concatenate(([0.0], np.cumsum(mah)))
    home_m = home_along_m(points, ways_home_m, at, legs)
    home_s, home_mah = _homeward(at, home_m, points[0], boat, speed_m_s, current, when_s)
    is_known = boat.knows_its_draw
    beyond = left_mah < boat.margin * believed * home_mah - 1e-9 if is_known else np.isinf(home_s)
    short = np.flatnonzero(beyond)
    empty = np.flatnonzero(left_mah < 0.0) if is_known else np.zeros(0, dtype=int)
    return Budget(
        length_m=float(along_m[-1]),
        time_s=float(time_s.sum()),
        charge_mah=float(mah.sum()) if is_known else math.nan,
        home_m=float(home_m[-1]),
        home_s=float(home_s[-1]),
        home_mah=float(home_mah[-1]) if is_known else math.nan,
        usable_mah=boat.usable_mah,
        margin=boat.margin,
        no_return_m=float(along_m[max(short[0] - 1, 0)]) if len(short) else None,
        reached_m=float(along_m[max(empty[0] - 1, 0)]) if len(empty) else None,
        capacity_mah=boat.capacity_mah,
        under_way_s=tuple((np.cumsum(time_s)[last] - np.array(holds_s)).tolist()),
        drawn_mah=tuple(np.cumsum(mah)[last].tolist()) if is_known else (),
    )


def _stations(points: Sequence[Point]) -> tuple[Floats, Floats]:
    """The route's points and places between them, and the number of the leg of each piece."""
    total_m = path_length_m(points)
    step_m = max(total_m / STEPS, 1e-6)
    at: list[tuple[float, float]] = [(points[0].north_m, points[0].east_m)]
    legs: list[int] = []
    for number, (a, b) in enumerate(pairwise(points)):
        pieces = max(1, math.ceil(distance_m(a, b) / step_m))
        for n in range(1, pieces + 1):
            share = n / pieces
            at.append((a.north_m + share * (b.north_m - a.north_m), a.east_m + share * (b.east_m - a.east_m)))
            legs.append(number)
    return np.array(at), np.array(legs)


def _when_s(
    at: Floats, last: NDArray[np.intp], holds_s: Sequence[float], travel: Travel, depart_s: float
) -> Floats:
    """When the boat is at each station."""
    held_s = np.zeros(len(at))
    held_s[last + 1] = holds_s
    stations = [Point(north_m, east_m) for north_m, east_m in at.tolist()]
    return route_costs(travel, stations, math.inf, np.array([depart_s]), held_s.tolist())[1][:, 0]


def _sailed(
    starts: Floats, ends: Floats, boat: Boat, speed_m_s: float | None, current: Current, when_s: Floats
) -> tuple[Floats, Floats]:
    """Seconds and mAh of straight pieces; infinite where current or wind is too strong."""
    length_m, *flow = _flow(starts, ends, current, when_s)
    speed = boat.speed(speed_m_s)
    good = speed.made_good_m_s(*flow)
    still = np.minimum(speed.still_m_s(good, *flow), boat.top_m_s)
    with np.errstate(divide="ignore", invalid="ignore"):
        time_s = np.where(length_m > 0.0, length_m / good, 0.0)
    return time_s, boat.drawn_a(still) * time_s / 3.6


def _flow(
    starts: Floats, ends: Floats, current: Current, when_s: Floats
) -> tuple[Floats, Floats, Floats, Floats]:
    """Lengths of straight pieces, the current along and across them, and their courses."""
    way = ends - starts
    length_m = np.hypot(way[:, 0], way[:, 1])
    middle = 0.5 * (starts + ends)
    north, east = current.at(middle[:, 0], middle[:, 1], when_s)
    safe_m = np.where(length_m > 0.0, length_m, 1.0)
    along = (north * way[:, 0] + east * way[:, 1]) / safe_m
    across = (east * way[:, 0] - north * way[:, 1]) / safe_m
    return length_m, along, across, np.arctan2(way[:, 1], way[:, 0])


def _homeward(
    at: Floats,
    home_m: Floats,
    home: Point,
    boat: Boat,
    speed_m_s: float | None,
    current: Current,
    when_s: Floats,
) -> tuple[Floats, Floats]:
    """Time and charge of the way home from each place: of the straight way, lengthened as the water is."""
    ends = np.broadcast_to(np.array([home.north_m, home.east_m]), at.shape)
    straight_m = np.hypot(*(ends - at).T)
    time_s, mah = _sailed(at, ends, boat, speed_m_s, current, when_s)
    stretch = np.where(straight_m > 0.0, home_m / np.maximum(straight_m, 1e-9), 1.0)
    return time_s * stretch, mah * stretch


def _believed(time_s: Floats, mah: Floats, plain_mah: Floats) -> Floats:
    """What the boat believes at each place that a metre takes, over what it takes on a straight line.

    time_s, mah: of the pieces, without holds, during which it learns nothing; plain_mah: without corners.
    """
    found, drawn_mah, needed_mah = [1.0], 0.0, 0.0
    for piece_s, piece_mah, straight_mah in zip(time_s, mah, plain_mah, strict=True):
        kept = math.exp(-piece_s / LEARN_S)
        drawn_mah, needed_mah = kept * drawn_mah + piece_mah, kept * needed_mah + straight_mah
        found.append(drawn_mah / needed_mah if needed_mah > 0.0 else 1.0)
    return np.array(found)


def planned_budget(planned: PlannedMission, boat: Boat | str, current: Current | str | None = None) -> Budget:
    """What a mission costs a boat. boat: its TOML or an emulated boat's name. current: also as in --current.
    Raises MapError: the current's file. UsageError: no such boat, or nowhere to go. NoRoute: a leg that
    cannot be sailed against current or wind.
    """
    boat = load_boat(boat) if isinstance(boat, str) else boat
    if isinstance(current, str):
        current = open_current(current, planned.chart.frame)
    points, mission = planned.points, planned.mission
    if mission.home is None or len(points) < 2:
        raise UsageError("--boat: a budget needs a home and a waypoint")
    holds_s = [item.hold_s for item in mission.items if item.place is not None]
    ways_m = ways_home_m(planned.chart, points, planned.clearance_m)
    current, table = current or STILL_WATER, planned.timetable
    depart_s = table.depart_s if table else Departure.of(None, current.times).begin_s
    return budget_of(points, holds_s, ways_m, boat, mission.speed_m_s, current, depart_s)
