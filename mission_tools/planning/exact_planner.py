"""Exact routes: the shortest among the polygons, made fit for a boat, and what to say when there is none."""

import math
from collections.abc import Sequence
from functools import lru_cache
from itertools import islice, pairwise

import shapely
from shapely.geometry import LinearRing, Polygon
from shapely.geometry.base import BaseGeometry

from companion.core.geo import Point, path_length_m
from companion.planning.visibility import NoWay, Route, Routes
from companion.planning.water import Shore, Water
from mission_tools.errors import GoalBlocked, MapError, NoRoute, StartBlocked
from mission_tools.geojson import KEPT_OUT, SOLID
from mission_tools.maps.chart import CLEARANCE, OPEN_WATER_HALF_SIDE_M, Chart, property_number
from mission_tools.planning.plan_settings import Plan, PlanSettings
from mission_tools.planning.smooth import (
    CORNER_CLEARANCES,
    MIN_LEG_CLEARANCES,
    merge_short_legs,
    widen_corners,
)
from mission_tools.planning.wording import nearest_free, place, stop_names, too_near, way_out_note

MAX_MERGE_EXCESS = 0.005
"""Short legs are merged while the route stays within half a percent of the shortest."""
MAX_EXITS = 40  # of a start without the clearance that are tried where the nearest leads nowhere


@lru_cache(maxsize=4)
def water_of(chart: Chart) -> Water:
    """The navigable water of a chart with all its rings; the graphs built for it are kept."""
    rings = [
        ring
        for part in shapely.get_parts(chart.navigable)
        for ring in (part.exterior, *part.interiors)
        # The square that stands for the sea is no shore
        if not (chart.is_open and max(map(abs, ring.bounds)) >= OPEN_WATER_HALF_SIDE_M)
    ]
    asking = own_clearances(chart)
    own_m = [next((own for shape, own in asking if _is_outline(ring, shape)), None) for ring in rings]
    water = Water(
        [Shore(_corners(ring), own) for ring, own in zip(rings, own_m, strict=True)], is_open=chart.is_open
    )
    # What is one with a longer shore keeps the clearance of that shore, and its own where that is larger
    return water.with_shores(
        [
            Shore(_corners(part.exterior), clearance_m)
            for shape, clearance_m in asking
            if not any(_is_outline(ring, shape) for ring in rings)
            for part in shapely.get_parts(shape)
        ]
    )


def own_clearances(chart: Chart) -> list[tuple[BaseGeometry, float]]:
    """The shapes that ask for a clearance of their own, in metres. Raises MapError: one is no number, or
    negative; names the feature.
    """
    found = []
    for feature in chart.features:
        clearance_m = property_number(feature, CLEARANCE) if feature.kind in SOLID | KEPT_OUT else None
        if clearance_m is not None and clearance_m < 0.0:
            raise MapError(f"{feature.described}: {CLEARANCE} is {clearance_m:g}: expected 0 or more")
        if clearance_m is not None:
            found.append((feature.shape, clearance_m))
    return found


def _is_outline(ring: LinearRing, shape: BaseGeometry) -> bool:
    return any(Polygon(ring).equals(Polygon(part.exterior)) for part in shapely.get_parts(shape))


def _corners(ring: LinearRing) -> list[Point]:
    return [Point(north, east) for east, north in shapely.get_coordinates(ring)[:-1].tolist()]


def plan_exactly(chart: Chart, stops: Sequence[Point], settings: PlanSettings) -> Plan:
    """Plan with the whole margin. Raises StartBlocked, GoalBlocked, NoRoute: as `plan`."""
    water = water_of(chart)
    routes = water.routes(settings.required_m)
    clearance_m = settings.required_m
    way_out: Point | None = None
    check_stops(chart, routes, stops, clearance_m)
    legs: list[Route] = []
    for start, goal in pairwise(stops):
        if not legs and not routes.is_free(start):
            way_out, leg = _from_its_berth(chart, routes, start, goal, clearance_m)
        else:
            leg = _leg(chart, routes, start, goal, clearance_m)
        legs.append(leg)
    ways = [fitted(leg, routes, clearance_m) for leg in legs]
    points = (*(point for way in ways for point in way[:-1]), stops[-1])
    min_clearance_m = min(water.leg_distance_m(a, b) for a, b in pairwise(points))
    return Plan(
        points=points if way_out is None else (stops[0], *points),
        found=tuple(point for leg in legs for point in leg.points),
        length_m=path_length_m(points if way_out is None else (stops[0], *points)),
        straight_m=path_length_m(stops),
        min_clearance_m=min_clearance_m,
        cell_m=None,
        expanded=sum(leg.expanded for leg in legs),
        settings=settings,
        notes=() if way_out is None else (way_out_note(chart, stops[0], way_out, settings.clearance_m),),
    )


def check_stops(chart: Chart, routes: Routes, stops: Sequence[Point], clearance_m: float) -> None:
    """See that a boat can leave the start, and that the others have the clearance. Raises StartBlocked,
    GoalBlocked: as `mission_tools.planning.planner.plan`.
    """
    if not routes.is_free(stops[0]):
        _raise_if_obstructed(chart, routes, stops[0], "start", clearance_m)
        _raise_if_shut_in(chart, routes, stops[0], clearance_m)
    for stop, name in zip(stops[1:], stop_names(stops), strict=True):
        if not routes.is_free(stop):
            _raise_if_obstructed(chart, routes, stop, name, clearance_m)
            raise GoalBlocked(
                too_near(chart, name, stop, clearance_m, _nearest(chart, routes, stop, clearance_m))
            )


def _raise_if_obstructed(chart: Chart, routes: Routes, point: Point, name: str, clearance_m: float) -> None:
    where = chart.obstruction(point)
    if where is None:
        return
    blocked = StartBlocked if name == "start" else GoalBlocked
    raise blocked(f"{name} {place(chart, point)} lies {where}: {_nearest(chart, routes, point, clearance_m)}")


def _raise_if_shut_in(chart: Chart, routes: Routes, start: Point, clearance_m: float) -> None:
    if next(routes.exits(start), None) is None:
        raise StartBlocked(
            f"start {place(chart, start)} is shut in: no straight way out leads to a clearance of "
            f"{clearance_m:g} m: {_nearest(chart, routes, start, clearance_m)}"
        )


def _nearest(chart: Chart, routes: Routes, point: Point, clearance_m: float) -> str:
    return nearest_free(chart, point, next(routes.exits(point, is_afloat=False), None), clearance_m)


def _from_its_berth(
    chart: Chart, routes: Routes, start: Point, goal: Point, clearance_m: float
) -> tuple[Point, Route]:
    """The nearest point with the clearance that a route leads on from, and that route."""
    tried: list[Point] = []
    for way_out in islice(routes.exits(start), MAX_EXITS):
        if any(routes.is_clear(way_out, other) for other in tried):
            continue  # in the same water as one that leads nowhere
        try:
            return way_out, routes.route(way_out, goal)
        except NoWay:
            tried.append(way_out)
    raise NoRoute(_no_route(chart, start, goal, clearance_m))


def _leg(chart: Chart, routes: Routes, start: Point, goal: Point, clearance_m: float) -> Route:
    try:
        return routes.route(start, goal)
    except NoWay:
        raise NoRoute(_no_route(chart, start, goal, clearance_m)) from None


def _no_route(chart: Chart, start: Point, goal: Point, clearance_m: float) -> str:
    return (
        f"no route from {place(chart, start)} to {place(chart, goal)}: no way between them keeps "
        f"{clearance_m:g} m clear of the shores: choose a smaller clearance, or another goal"
    )


def fitted(route: Route, routes: Routes, clearance_m: float) -> tuple[Point, ...]:
    """A route with few long legs, and with room at its corners for the boat's turns."""
    max_length_m = (1.0 + MAX_MERGE_EXCESS) * route.length_m
    merged = merge_short_legs(route.points, routes.is_clear, MIN_LEG_CLEARANCES * clearance_m, max_length_m)
    return widen_corners(merged, routes.is_clear, CORNER_CLEARANCES * clearance_m, math.inf)
