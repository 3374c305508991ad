"""Rally points for a route: places near it where a boat can wait, with room, apart from one another."""

import math
from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import LineString
from shapely.geometry.base import BaseGeometry

from companion.core.geo import Point
from mission_tools.maps.chart import Chart
from mission_tools.mission.mission import Rally

SPACING_M = 300.0  # of route, for each rally point
MOST = 10
ROOM_CLEARANCES = 3.0  # more room than this is worth nothing
REACH_CLEARANCES = 10.0  # from the route
SAMPLES = 40  # along each stretch of the route

Floats = NDArray[np.float64]


def rally_points(
    chart: Chart, route: Sequence[Point], clearance_m: float, most: int, fence: BaseGeometry | None = None
) -> tuple[Rally, ...]:
    """One place for each stretch of the route; the start, where the boat goes home to, is not one of them.

    Each is at least the clearance off every shore (and line of the fence, where there is one), and the
    straight way there from the route is clear. Of those, the one with the most room, up to three times the
    clearance, that is nearest to the middle of the stretch. most: what the boat holds.
    """
    line = LineString([(point.east_m, point.north_m) for point in route])
    count = min(MOST, most, max(1, math.ceil(line.length / SPACING_M)))
    keep = chart.shores if fence is None else chart.shores.union(fence)
    found: list[Point] = []
    for n in range(count):
        begin, end = n / count * line.length, (n + 1) / count * line.length
        best = _best(chart, line, (begin, end), clearance_m, keep, found)
        if best is not None:
            found.append(best)
    return tuple(Rally(chart.frame.to_global(point)) for point in found)


def _best(
    chart: Chart,
    line: LineString,
    stretch: tuple[float, float],
    clearance_m: float,
    keep: BaseGeometry,
    taken: Sequence[Point],
) -> Point | None:
    along_m = np.linspace(*stretch, SAMPLES)
    on_route = shapely.get_coordinates(shapely.line_interpolate_point(line, along_m))
    way = np.gradient(on_route, axis=0)
    lengths = np.maximum(np.hypot(way[:, 0], way[:, 1]), 1e-9)
    abeam = np.column_stack((way[:, 1], -way[:, 0])) / lengths[:, None]
    offsets_m = np.array([0.0, 0.25, -0.25, 0.5, -0.5, 1.0, -1.0]) * REACH_CLEARANCES * clearance_m
    places = (on_route[None] + offsets_m[:, None, None] * abeam[None]).reshape(-1, 2)
    from_route = np.broadcast_to(on_route[None], (len(offsets_m), *on_route.shape)).reshape(-1, 2)
    points = shapely.points(places)
    room_m = np.full(len(places), np.inf) if keep.is_empty else shapely.distance(points, keep)
    room = np.minimum(room_m, ROOM_CLEARANCES * clearance_m)
    is_fit = shapely.contains(chart.navigable, points) & (room_m >= clearance_m)
    ways = shapely.linestrings(np.stack((from_route, places), axis=1))
    if not keep.is_empty:
        is_fit &= shapely.distance(ways, keep) >= 0.99 * clearance_m
    if taken:
        others = shapely.multipoints([(point.east_m, point.north_m) for point in taken])
        is_fit &= shapely.distance(points, others) >= min(0.25 * line.length, 0.5 * SPACING_M)
    start = shapely.Point(line.coords[0])
    is_fit &= shapely.distance(points, start) >= 2.0 * clearance_m
    if not is_fit.any():
        return None
    middle = line.interpolate(0.5 * sum(stretch))
    away = shapely.distance(points, middle) / max(stretch[1] - stretch[0], 1e-9)
    score = np.where(is_fit, room / max(ROOM_CLEARANCES * clearance_m, 1e-9) - away, -np.inf)
    east_m, north_m = places[int(np.argmax(score))]
    return Point(float(north_m), float(east_m))
