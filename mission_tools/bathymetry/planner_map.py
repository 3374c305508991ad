"""The lake's map with the charted depths: `mission-plan FILE --draught M` keeps out of what is less deep."""

from collections.abc import Callable
from itertools import pairwise
from typing import Any, Final

import contourpy
import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import mapping

from mission_tools.bathymetry.depth_chart import DepthChart
from mission_tools.geojson import collection, feature
from mission_tools.maps.chart import DEPTH, Feature
from mission_tools.overwrite_guard import CREATOR

Shapes = NDArray[np.object_]
LEVELS_M: Final = (*(0.1 * n for n in range(20)), *(2.0 + 0.5 * n for n in range(7)))
"""Of draughts that boats have; what is deeper than the last has no depth in the map."""


def planner_map(chart: DepthChart, to_degrees: Callable[[Shapes], Shapes]) -> dict[str, Any]:
    """GeoJSON in WGS 84: all features of the lake's map, and areas of water with `depth_m`, the least depth
    in each by the lower end of its 90 % band. What was not surveyed has no depth.
    """
    source = chart.chart
    features = [*source.features, *depth_areas(chart)]
    if not source.is_open and all(one.kind != "water" for one in source.features):
        features.insert(0, Feature(source.name, "water", source.water))
    shapes = to_degrees(np.array([one.shape for one in features], dtype=object))
    rows = []
    for one, shape in zip(features, shapely.transform(shapes, lambda places: places.round(8)), strict=True):
        named = mapping(shape)
        said = {**one.properties, "name": one.name, "kind": one.kind}
        rows.append(feature(named["type"], named["coordinates"], **said))
    return collection(rows, generator=CREATOR)


def depth_areas(chart: DepthChart) -> list[Feature]:
    """Where the water is at least so deep, level by level, in the chart's frame."""
    surface = chart.surface
    least_m = np.ma.masked_invalid(surface.depth_m - surface.band_m)
    generator = contourpy.contour_generator(
        *surface.grid.middles, least_m.clip(0.0), fill_type=contourpy.FillType.OuterOffset
    )
    found = []
    for low_m, high_m in pairwise(LEVELS_M):
        for points, offsets in zip(*generator.filled(low_m, high_m), strict=True):
            rings = [points[begin:end] for begin, end in pairwise(offsets)]
            area = shapely.Polygon(rings[0], rings[1:]).simplify(0.5 * surface.grid.cell_m)
            if area.area > surface.grid.cell_m**2:
                found.append(Feature("", "water", area, {DEPTH: round(low_m, 1)}))
    return found
