"""The route of the least time or charge in a current, or off the shore, in place of the shortest one."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
import shapely
from scipy.ndimage import map_coordinates

from companion.core.geo import Point, path_length_m
from mission_tools.assembly.plan_options import PlanOptions
from mission_tools.costs.cheapest import DETOUR, cheapest_route
from mission_tools.costs.current import STILL_WATER
from mission_tools.costs.current_source import open_current
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
from mission_tools.errors import UsageError
from mission_tools.maps.chart import Chart
from mission_tools.planning.planner import Plan
from mission_tools.wording import duration

ROOM_CELLS = 60_000  # as many as the lattice on which the route is searched
OPEN_WATER_WEIGHT = 2.0  # a metre at the shore costs three times one in open water


def cheapest(chart: Chart, found: Plan, stops: Sequence[Point], options: PlanOptions) -> Plan:
    """The plan with its legs made cheapest, from stop to stop. Raises NoRoute: a current that cannot be
    stemmed; names the place. UsageError: a cost that needs to know the boat.
    """
    travel = _travel(chart, found.points, options)
    points: list[Point] = [found.points[0]]
    cost = shortest = 0.0
    for leg in _between_stops(found.points, stops):
        best = cheapest_route(chart, leg, found.settings.required_m, travel)
        points += best.points[1:]
        cost, shortest = cost + best.cost, shortest + best.shortest_cost
    return replace(
        found,
        points=tuple(points),
        length_m=path_length_m(points),
        min_clearance_m=min(chart.leg_clearance_m(a, b) for a, b in pairwise(points)),
        notes=(*found.notes, _note(travel, cost, shortest, options)),
    )


def _travel(chart: Chart, route: Sequence[Point], options: PlanOptions) -> Travel:
    current = STILL_WATER if options.current is None else open_current(options.current, chart.frame)
    boat = None
    if options.boat is None:
        speed = BoatSpeed(over_ground_m_s=options.speed_m_s or BoatSpeed().over_ground_m_s)
    else:
        from mission_tools.costs.boat import load_boat  # noqa: PLC0415 - seldom needed

        boat = load_boat(options.boat)
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


def _note(travel: Travel, cost: float, shortest: float, options: PlanOptions) -> str:
    if options.open_water_m is not None:
        return f"off the shore: a metre there costs up to {1.0 + OPEN_WATER_WEIGHT:g} times one in open water"
    said: Callable[[float], str] = duration if travel.unit == "s" else "{:.0f} mAh".format
    other = said(shortest) if shortest < np.inf else "cannot be sailed"
    return f"takes {said(cost)} in this current; the shortest route {other}"
