"""The route of the least time or charge in a current, or off the shore, in place of the shortest one."""

import contextlib
import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
import shapely
from scipy.ndimage import map_coordinates

from companion.core.geo import Point, path_length_m
from mission_tools.assembly.plan_options import PlanOptions
from mission_tools.assembly.timetable import Timetable, Tried, fixed_route, tried_of
from mission_tools.costs.cheapest import DETOUR, CheapestRoute, cheapest_route
from mission_tools.costs.current import STILL_WATER, Current
from mission_tools.costs.current_source import open_current
from mission_tools.costs.departure import Departure
from mission_tools.costs.time_search import WAIT_STEP_S
from mission_tools.costs.travel import (
    BoatSpeed,
    Charge,
    Floats,
    InZones,
    OpenWater,
    Travel,
    TravelTime,
    speed_zones,
)
from mission_tools.errors import NoRoute, UsageError
from mission_tools.maps.chart import Chart
from mission_tools.planning.planner import Plan
from mission_tools.wording import duration

ROOM_CELLS = 60_000  # as many as the lattice on which the route is searched
PLANNED_DEPARTURES = 5  # of a window, on a coarser lattice: their routes are timed for many more
COARSER = 2.0
OPEN_WATER_WEIGHT = 2.0  # a metre at the shore costs three times one in open water


def cheapest(
    chart: Chart, found: Plan, stops: Sequence[Point], options: PlanOptions
) -> tuple[Plan, Timetable]:
    """The plan with its legs made cheapest, from stop to stop, and its times, by the best departure of a
    window. Raises NoRoute: a current that cannot be stemmed; names the place. UsageError: a cost that needs
    to know the boat, or a departure that does not go with the current.
    """
    current = current_of(chart, options)
    departure = Departure.of(options.depart, current.times)
    travel = travel_of(chart, found.points, options, current)
    legs = _between_stops(found.points, stops)

    def sailed(depart_s: float, coarser: float = 1.0) -> CheapestRoute:
        return _sailed(chart, legs, found.settings.required_m, travel, depart_s, coarser)

    tried: tuple[Tried, ...] = ()
    depart_s = departure.begin_s
    if departure.is_window:
        routes = []
        for begin_s in np.linspace(departure.begin_s, departure.latest_s, PLANNED_DEPARTURES):
            with contextlib.suppress(NoRoute):
                routes.append(sailed(float(begin_s), COARSER).points)
        tried = tried_of(travel, routes or [found.points], departure)
        depart_s = min(tried, key=lambda one: one.cost).depart_s
    best = sailed(depart_s)
    leaves_s = depart_s + best.wait_s
    timetable = fixed_route(travel, best.points, Departure(leaves_s, leaves_s, departure.is_dated))
    plan = replace(
        found,
        points=best.points,
        length_m=path_length_m(best.points),
        min_clearance_m=min(chart.leg_clearance_m(a, b) for a, b in pairwise(best.points)),
        notes=(*found.notes, _note(travel, best, options), *timetable.notes(current.times)),
    )
    return plan, replace(timetable, tried=tried, wait_s=best.wait_s)


def _sailed(
    chart: Chart,
    legs: Sequence[tuple[Point, ...]],
    required_m: float,
    travel: Travel,
    depart_s: float,
    coarser: float,
) -> CheapestRoute:
    """The cheapest routes from stop to stop; where a later one has to wait, all leave later."""
    points, now_s = [legs[0][0]], depart_s
    cost = shortest = wait_s = 0.0
    for number, leg in enumerate(legs):
        best = cheapest_route(chart, leg, required_m, travel, now_s, coarser)
        if best.wait_s and number:
            wait_s += best.wait_s + WAIT_STEP_S
            later = _sailed(chart, legs, required_m, travel, depart_s + wait_s, coarser)
            return replace(later, wait_s=later.wait_s + wait_s)
        points += best.points[1:]
        wait_s += best.wait_s
        cost, shortest, now_s = cost + best.cost, shortest + best.shortest_cost, best.arrive_s
    return CheapestRoute(tuple(points), cost - wait_s, shortest, wait_s, now_s)


def current_of(chart: Chart, options: PlanOptions) -> Current:
    """What --current says. Raises UsageError, MapError: it is none."""
    return STILL_WATER if options.current is None else open_current(options.current, chart.frame)


def travel_of(chart: Chart, route: Sequence[Point], options: PlanOptions, current: Current) -> Travel:
    """What a metre costs near a route. Raises UsageError: a cost that needs to know the boat."""
    boat = None
    if options.boat is None:
        speed = BoatSpeed(over_ground_m_s=options.speed_m_s or BoatSpeed().over_ground_m_s)
    else:
        from mission_tools.costs.boat import load_boat  # noqa: PLC0415 - seldom needed

        boat = load_boat(options.boat, options.wind)
        speed = boat.speed(options.speed_m_s)
    travel: TravelTime | Charge = TravelTime(speed, current)
    if options.least == "charge":
        if boat is None:
            raise UsageError("--least charge: add --boat BOAT.toml, which says what the boat draws")
        if not boat.knows_its_draw:
            raise UsageError(f"--least charge: {options.boat} does not say battery.cruise_a or battery.draw")
        travel = Charge(speed, boat.drawn_a, current)
    zones = speed_zones(chart)
    slowed: Travel = InZones(travel, zones) if zones else travel
    if options.open_water_m is None:
        return slowed
    if not options.open_water_m > 0.0:
        raise UsageError(f"--open-water {options.open_water_m:g}: expected more than 0 metres")
    return OpenWater(slowed, room_to_shore(chart, route), OPEN_WATER_WEIGHT, options.open_water_m)


def room_to_shore(chart: Chart, route: Sequence[Point]) -> Callable[[Floats, Floats], Floats]:
    """The distance to the nearest shore round a route, infinite without one.

    Between the points of a grid it is interpolated: millions of places are asked for, and a preference needs
    no more than that.
    """
    if chart.shores.is_empty:
        return lambda north_m, _: np.full(np.shape(north_m), np.inf)
    east_m, north_m = (np.array([point[axis] for point in route]) for axis in (1, 0))
    reach_m = DETOUR * path_length_m(route) + 1.0
    low = np.array([north_m.min(), east_m.min()]) - reach_m
    high = np.array([north_m.max(), east_m.max()]) + reach_m
    if not chart.is_open:
        west, south, east, north = chart.navigable.bounds
        low, high = np.maximum(low, (south, west)), np.minimum(high, (north, east))
    cell_m = math.sqrt(float(np.prod(high - low)) / ROOM_CELLS)
    rows, columns = (np.arange(low[axis], high[axis] + cell_m, cell_m) for axis in (0, 1))
    room = _room_of(chart)(*np.meshgrid(rows, columns, indexing="ij"))

    def room_m(north_m: Floats, east_m: Floats) -> Floats:
        at = np.stack(((north_m - low[0]) / cell_m, (east_m - low[1]) / cell_m))
        found: Floats = map_coordinates(room, at, order=1, mode="nearest")
        return found

    return room_m


def _room_of(chart: Chart) -> Callable[[Floats, Floats], Floats]:
    """The distance to the nearest shore, from an index of its edges."""
    coordinates, line = shapely.get_coordinates(shapely.get_parts(chart.shores), return_index=True)
    is_edge = line[:-1] == line[1:]
    index = shapely.STRtree(
        shapely.linestrings(np.stack((coordinates[:-1][is_edge], coordinates[1:][is_edge]), axis=1))
    )

    def room_m(north_m: Floats, east_m: Floats) -> Floats:
        room = np.empty(np.shape(north_m))
        places = shapely.points(np.ravel(east_m), np.ravel(north_m))
        (which, _), near_m = index.query_nearest(places, return_distance=True, all_matches=False)
        room.ravel()[which] = near_m
        return room

    return room_m


def _between_stops(points: Sequence[Point], stops: Sequence[Point]) -> list[tuple[Point, ...]]:
    """The route's points from each stop to the next; stops begins with the start."""
    legs, begin = [], 0
    for stop in stops[1:]:
        end = next((n for n in range(begin + 1, len(points)) if points[n] == stop), len(points) - 1)
        legs.append(tuple(points[begin : end + 1]))
        begin = end
    return legs


def _note(travel: Travel, found: CheapestRoute, options: PlanOptions) -> str:
    if options.open_water_m is not None:
        return f"off the shore: a metre there costs up to {1.0 + OPEN_WATER_WEIGHT:g} times one in open water"
    said: Callable[[float], str] = duration if travel.unit == "s" else "{:.0f} mAh".format
    other = said(found.shortest_cost) if found.shortest_cost < np.inf else "cannot be sailed"
    flow = " and ".join(name for name in ("current", "wind") if getattr(options, name) is not None)
    return f"takes {said(found.cost)} in this {flow}; the shortest route {other}"
