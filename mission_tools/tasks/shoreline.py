"""Along a shore at a distance, as for an inspection: round an island, or along the outer shore."""

import math
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
import shapely
from numpy.typing import NDArray

from companion.core.geo import Point
from mission_tools.errors import NoRoute, UsageError
from mission_tools.maps.chart import Chart
from mission_tools.planning.planner import PlanSettings
from mission_tools.tasks.room import simplified, water_clear_of_shores
from mission_tools.tasks.task_route import TaskLeg, TaskRoute, Transits, joined

Array = NDArray[np.float64]
ERROR_SHARE = 0.1  # of the distance: the default of error_m


@dataclass(frozen=True, slots=True)
class ShoreSettings:
    """Which shore, and how it is followed.

    near: a place near the shore to follow. distance_m: from it, at least the clearance. error_m: how much
    farther or nearer than that a leg may be, None: a tenth of it; never nearer than the clearance. shore_to:
    the side of the boat that the shore is on. first, last: follow only the stretch between the places of the
    shore's line that are nearest to these two; None: all of it, back to where it began. Raises UsageError:
    values that make no sense.
    """

    near: Point
    distance_m: float
    plan: PlanSettings = field(default_factory=PlanSettings)
    error_m: float | None = None
    shore_to: Literal["port", "starboard"] = "starboard"
    first: Point | None = None
    last: Point | None = None

    def __post_init__(self) -> None:
        if not self.plan.clearance_m <= self.distance_m < math.inf:
            raise UsageError(
                f"distance from the shore is {self.distance_m:g} m: expected the clearance of "
                f"{self.plan.clearance_m:g} m or more"
            )
        if self.error_m is not None and not 0.0 < self.error_m < math.inf:
            raise UsageError(f"error is {self.error_m:g} m: expected more than 0")
        if self.shore_to not in {"port", "starboard"}:
            raise UsageError(f"the shore is to {self.shore_to!r}: expected port or starboard")
        if (self.first is None) != (self.last is None):
            raise UsageError("a stretch of a shore needs both its ends")


def follow_shore(chart: Chart, start: Point | None, settings: ShoreSettings) -> TaskRoute:
    """The route from start to the shore and along it; the legs of kind "shore" follow it.

    start: where the boat is, None: begin on the line, nearest to `near`. Raises NoRoute: the water round this
    shore is too narrow for the distance. NoRouteError: no way leads there.
    """
    line = _line_along(chart, settings)
    if settings.first is not None and settings.last is not None:
        points = _stretch(line, settings.first, settings.last)
    else:
        begin = start or settings.near
        points = begun_at(line, shapely.Point(begin.east_m, begin.north_m))
    along = tuple(Point(float(north_m), float(east_m)) for east_m, north_m in points)
    legs = [TaskLeg("shore", along)]
    if start is not None and start != along[0]:
        legs.insert(0, TaskLeg("transit", Transits(chart, settings.plan).route(start, along[0])))
    return joined(legs)


def _line_along(chart: Chart, settings: ShoreSettings) -> Array:
    """The closed line round the shore nearest to the place, with the shore on the side asked for."""
    distance_m = settings.distance_m
    if chart.shores.is_empty:
        raise NoRoute("there is no shore here to follow")
    error_m = ERROR_SHARE * distance_m if settings.error_m is None else settings.error_m
    pieces = water_clear_of_shores(chart, distance_m)
    if not pieces:
        raise NoRoute(f"no water here is {distance_m:g} m from every shore")
    at = shapely.Point(settings.near.east_m, settings.near.north_m)
    shore = shapely.shortest_line(at, chart.shores).coords[-1]
    outlines = shapely.get_rings(pieces)
    nearest = outlines[int(np.argmin(shapely.distance(outlines, shapely.Point(shore))))]
    nearest_m = max(settings.plan.clearance_m, distance_m - error_m)
    line = simplified(shapely.get_coordinates(nearest), chart.shores, nearest_m, error_m)
    # Water lies on the left of an outline that runs counter-clockwise, and on the right of an island's.
    is_outer = any(nearest.equals(piece.exterior) for piece in pieces)
    water_on_left = shapely.is_ccw(shapely.LinearRing(line)) == is_outer
    return line if water_on_left == (settings.shore_to == "starboard") else line[::-1]


def begun_at(line: Array, place: shapely.Point) -> Array:
    """The closed line, begun and ended at its point nearest to a place."""
    at_m = shapely.LineString(line).project(place)
    return _between(line, at_m, at_m)


def _stretch(line: Array, first: Point, last: Point) -> Array:
    """The part of the closed line from its point nearest to one place to that nearest to another."""
    ring = shapely.LineString(line)
    from_m, to_m = (ring.project(shapely.Point(place.east_m, place.north_m)) for place in (first, last))
    return _between(line, from_m, to_m)


def _between(line: Array, from_m: float, to_m: float) -> Array:
    """Along the closed line from one distance to another, across its seam where that lies between."""
    ring = shapely.LineString(line)
    along_m = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))))[:-1]
    first, last = (shapely.get_coordinates(ring.interpolate(at_m))[0] for at_m in (from_m, to_m))
    order = np.argsort(np.mod(along_m - from_m, ring.length), kind="stable")
    ahead_m = np.mod(along_m - from_m, ring.length)[order]
    reach_m = float(np.mod(to_m - from_m, ring.length)) or ring.length
    inner = line[:-1][order][(ahead_m > 1e-6) & (ahead_m < reach_m - 1e-6)]
    return np.vstack((first, inner, last))
