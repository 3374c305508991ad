"""A chart with a fence on it: what the fence does not allow is water to keep out of.

The allowed water is inside every inclusion and outside every exclusion, as the vehicle has it.
"""

import math
from dataclasses import replace
from pathlib import Path

import shapely
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from companion.core.geo import LatLon, LocalFrame
from mission_tools.errors import MapError, PlanFileError
from mission_tools.maps.chart import Chart, Feature, build_chart
from mission_tools.mission.mission import Fence, FenceCircle, FencePolygon
from mission_tools.mission.plan_file import load_mission
from mission_tools.mission.wire import FENCE_COMMANDS, fence_from

BEYOND_M = 50.0  # of open water round an inclusion that is still on the chart
OUTSIDE = "the water outside the fence"
_SEGMENTS_PER_QUARTER = 32


def fenced(chart: Chart, fence: Fence, source: str) -> Chart:
    """The chart, to be planned on inside the fence. `source` names the fence in messages. Raises MapError: an
    area that is no area or far from the chart, or a fence that leaves no water.
    """
    inside: BaseGeometry | None = None
    features = list(chart.features)
    for label, area in _labelled(fence):
        shape = _shape(chart, area, f"{source}: {label}")
        if not area.inclusion:
            features.append(Feature(f"the {label}", "keep_out", shape))
        else:
            inside = shape if inside is None else shapely.intersection(inside, shape)
    water = None if chart.is_open else chart.water
    if inside is not None:
        if inside.is_empty:
            raise MapError(f"{source}: its inclusions have no water in common: a boat must be inside of all")
        if water is None:
            west, south, east, north = inside.bounds
            water = shapely.box(west - BEYOND_M, south - BEYOND_M, east + BEYOND_M, north + BEYOND_M)
        features.append(Feature(OUTSIDE, "keep_out", water.difference(inside)))
    try:
        return build_chart(chart.name, chart.frame, water, features, chart.notes)
    except MapError:
        raise MapError(f"{source}: leaves no water of {chart.name} to sail on") from None


def _labelled(fence: Fence) -> list[tuple[str, FencePolygon | FenceCircle]]:
    polygons = [(f"fence polygon {n}", polygon) for n, polygon in enumerate(fence.polygons, start=1)]
    return [*polygons, *((f"fence circle {n}", circle) for n, circle in enumerate(fence.circles, start=1))]


def _shape(chart: Chart, area: FencePolygon | FenceCircle, where: str) -> Polygon:
    if isinstance(area, FencePolygon):
        shape = Polygon([_at(chart, corner, where) for corner in area.corners])
        if not shape.is_valid or shape.area == 0.0:
            raise MapError(f"{where}: not a valid polygon: its line crosses itself or encloses nothing")
        return shape
    # Corners never on the wrong side of the true line
    grown = 1.0 if area.inclusion else 1.0 / math.cos(math.pi / (4 * _SEGMENTS_PER_QUARTER))
    centre = shapely.Point(_at(chart, area.centre, where))
    return centre.buffer(area.radius_m * grown, quad_segs=_SEGMENTS_PER_QUARTER)


def _at(chart: Chart, place: LatLon, where: str) -> tuple[float, float]:
    if not chart.reaches(place):
        origin = chart.frame.origin
        raise MapError(
            f"{where}: {place.lat_deg:.6f},{place.lon_deg:.6f} is nowhere near {chart.name} "
            f"at {origin.lat_deg:.6f},{origin.lon_deg:.6f}"
        )
    point = chart.frame.to_local(place)
    return point.east_m, point.north_m


def fence_area(chart: Chart, fence: Fence, source: str) -> BaseGeometry:
    """Everything inside one of the inclusions and outside the exclusions, in the chart's frame. Raises
    MapError: an area that is no area, or far from the chart.
    """
    shapes = [(area.inclusion, _shape(chart, area, f"{source}: {label}")) for label, area in _labelled(fence)]
    inside = shapely.union_all([shape for is_inclusion, shape in shapes if is_inclusion])
    return inside.difference(shapely.union_all([shape for is_inclusion, shape in shapes if not is_inclusion]))


def load_mission_map(path: Path, origin: LatLon | None = None) -> Chart:
    """The water inside a file's fence, or round exclusions. Raises MapError: unreadable, or no fence."""
    try:
        mission = load_mission(path)
        stray = [item for item in mission.items if item.command in FENCE_COMMANDS]  # of Mission Planner
        fence = fence_from(stray) if stray else mission.fence
    except (PlanFileError, ValueError) as error:
        raise MapError(str(error)) from None
    places = [corner for polygon in fence.polygons for corner in polygon.corners]
    places += [circle.centre for circle in fence.circles]
    if not places:
        raise MapError(f"{path}: a mission without a fence says nothing about where the water is")
    chart = build_chart(path.stem, LocalFrame(origin or places[0]), None, ())
    return replace(fenced(chart, fence, str(path)), name=path.stem)
