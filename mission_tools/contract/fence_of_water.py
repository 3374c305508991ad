"""A fence from the map of a route: never over land, with room round the route, within the boat's capacity.

The water is made smaller by more than a simplification can move its outline, then simplified; so the lines
lie in the water whatever corners are left out. Where that has too many corners, the water far from the route
is simplified in larger steps, and narrow waters there are left out.
"""

from collections.abc import Sequence

import shapely
from shapely.geometry import LineString, Polygon
from shapely.geometry.base import BaseGeometry

from companion.core.geo import LatLon, LocalFrame, Point
from mission_tools.errors import NoRoute
from mission_tools.maps.chart import Chart
from mission_tools.mission.mission import Fence, FencePolygon

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
    most_items: corners that the boat holds.

    Raises:
        NoRoute: no fence of so few corners holds the route.
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
