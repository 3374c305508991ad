"""The water contract: from one map the mission, its fence and its rally points, which go up together."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import LineString, Polygon
from shapely.geometry.base import BaseGeometry

from companion.core.geo import LatLon, LocalFrame, Point
from mission_tools.assembly.planned_mission import PlannedMission
from mission_tools.costs.boat import Boat
from mission_tools.errors import NoRoute, UsageError
from mission_tools.maps.chart import Chart
from mission_tools.mission.mission import Fence, FencePolygon, Rally
from mission_tools.wording import counted, distance


def with_contract(
    planned: PlannedMission, boat: Boat, *, with_fence: bool = True, with_rally: bool = True
) -> PlannedMission:
    """The mission with a fence and rally points from its own chart, and a note about them.

    boat: how much of them it holds, and how far inside its fence it stops. Raises UsageError: a mission from
    a file, which has no chart. NoRoute: no fence of so few corners holds the route.
    """
    if planned.plan is None and planned.task is None:
        raise UsageError(
            f"{planned.name} is a mission without a map: --fence FILE and --rally FILE go with it"
        )
    mission, notes = planned.mission, list[str]()
    route, clearance_m = planned.points, planned.clearance_m
    lines = None
    if with_fence:
        fence, near_m = fence_of_water(
            planned.chart, route, clearance_m, boat.fence_margin_m, boat.most_fence_items
        )
        mission = replace(mission, fence=fence)
        lines = fence_lines(planned.chart, fence)
        corners = sum(len(polygon.corners) for polygon in fence.polygons)
        said = f"fence: {counted(len(fence.polygons), 'polygon')}, {counted(corners, 'corner')}"
        notes.append(f"{said}, {distance(near_m)} from the route at least")
        if near_m < boat.fence_margin_m:
            notes.append(
                f"the boat stops {distance(boat.fence_margin_m)} inside its fence, more than the route "
                "has: plan with more --clearance"
            )
    if with_rally:
        rally = rally_points(planned.chart, route, clearance_m, boat.most_rally_items, lines)
        mission = replace(mission, rally=rally)
        notes.append(f"{counted(len(rally), 'rally point')}")
    return replace(planned, mission=mission, notes=(*planned.notes, *notes))


def fence_lines(chart: Chart, fence: Fence) -> shapely.MultiLineString:
    """The lines of a fence's polygons in the chart's frame."""
    rings = []
    for polygon in fence.polygons:
        places = map(chart.frame.to_local, polygon.corners)
        rings.append(Polygon([(at.east_m, at.north_m) for at in places]).exterior)
    return shapely.multilinestrings(rings)


ROUNDING_M = 0.02  # corners are rounded to 1e-7 degrees, 11 mm
SHRINK = 1.05  # over the step of the simplification: GEOS' buffer is off by 1 %
LEAST_STEP_SHARE = 0.05  # of the clearance, where the fence's margin leaves no room
CORRIDOR_CLEARANCES = 5.0  # to either side of the route, the water is kept in detail
COARSEST_M = 500.0
OPEN_MARGIN_M = 200.0  # of open water round a route without a shore


def fence_of_water(
    chart: Chart, route: Sequence[Point], clearance_m: float, margin_m: float, most_items: int
) -> tuple[Fence, float]:
    """The fence for a route on a chart, and how near the route comes to it in metres.

    clearance_m: that the route keeps from shores. margin_m: how far inside its fence the boat stops.
    most_items: corners that the boat holds. Raises NoRoute: no fence of so few corners holds the route.
    """
    line = LineString([(point.east_m, point.north_m) for point in route])
    if chart.is_open:
        water: BaseGeometry = line.buffer(OPEN_MARGIN_M).intersection(chart.navigable)
    else:
        water = chart.navigable
    spare_m = min(clearance_m, line.distance(chart.shores) if not chart.shores.is_empty else clearance_m)
    room_m = max(spare_m - margin_m, 0.0) or LEAST_STEP_SHARE * spare_m
    step_m = 0.5 * room_m / SHRINK - ROUNDING_M
    if step_m <= 0.0:
        step_m = max(0.25 * room_m, ROUNDING_M)
    near = _smaller(water, step_m)
    for area in (near, *_coarser(water, near, line, step_m, clearance_m)):
        found = _part_with(area, line)
        if found is not None and _corners(found) <= most_items:
            fence = _fence(found, chart.frame)
            near_m = _room_m(fence, chart, line)
            if near_m > 0.0:
                return fence, near_m
    raise NoRoute(f"no fence of at most {most_items} corners holds this route: plan a shorter one")


def _smaller(water: BaseGeometry, step_m: float) -> BaseGeometry:
    """The water without a rim of step_m, its outline simplified by as much."""
    shrunk = water.buffer(-(SHRINK * step_m + ROUNDING_M), quad_segs=4)
    return shrunk.simplify(step_m, preserve_topology=True)


def _coarser(
    water: BaseGeometry, near: BaseGeometry, line: LineString, step_m: float, clearance_m: float
) -> list[BaseGeometry]:
    """Fences with less and less detail away from the route; at last the route's surroundings alone."""
    corridor = line.buffer(CORRIDOR_CLEARANCES * max(clearance_m, 1e-3), quad_segs=2)
    kept = near.intersection(corridor.simplify(step_m))
    found = []
    coarse_m = 2.0 * step_m
    while coarse_m < COARSEST_M:
        found.append(_smaller(water, coarse_m).union(kept))
        coarse_m *= 2.0
    return [*found, kept, near.intersection(line.buffer(0.99 * clearance_m, quad_segs=1))]


def _part_with(area: BaseGeometry, line: LineString) -> Polygon | None:
    """The piece that the route lies in."""
    pieces = [part for part in shapely.get_parts(area) if isinstance(part, Polygon)]
    return next((piece for piece in pieces if piece.contains(line)), None)


def _corners(area: Polygon) -> int:
    return sum(len(ring.coords) - 1 for ring in (area.exterior, *area.interiors))


def _fence(area: Polygon, frame: LocalFrame) -> Fence:
    """The outline as an inclusion, the holes as exclusions."""
    polygons: list[FencePolygon] = []
    for ring in (area.exterior, *area.interiors):
        corners = tuple(_rounded(frame, north_m, east_m) for east_m, north_m in ring.coords[:-1])
        polygons.append(FencePolygon(corners, inclusion=not polygons))
    return Fence(tuple(polygons))


def _rounded(frame: LocalFrame, north_m: float, east_m: float) -> LatLon:
    """A corner as the wire carries it."""
    place = frame.to_global(Point(north_m, east_m))
    return LatLon(round(place.lat_deg, 7), round(place.lon_deg, 7))


def _room_m(fence: Fence, chart: Chart, line: LineString) -> float:
    """How near the route comes to the fence as it is sent; 0 where that would admit land or cut the route.

    (The parts of a fence with less detail may touch, and cross once their corners are rounded.)
    """
    outline, *holes = (
        [(at.east_m, at.north_m) for at in map(chart.frame.to_local, polygon.corners)]
        for polygon in fence.polygons
    )
    area = Polygon(outline, holes)
    if not area.is_valid or not chart.navigable.covers(area) or not area.contains(line):
        return 0.0
    return float(area.boundary.distance(line))


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
