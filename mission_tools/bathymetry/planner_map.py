"""The lake's map with the charted depths: `mission-plan FILE --draught M` keeps out of what is less deep."""

from itertools import pairwise
from typing import Any, Final

import contourpy
import numpy as np
import shapely
from shapely.geometry import mapping

from companion.core.geo import Point
from mission_tools.bathymetry.depth_chart import DepthChart
from mission_tools.geojson import collection, feature
from mission_tools.maps.chart import DEPTH, Feature
from mission_tools.overwrite_guard import CREATOR

LEVELS_M: Final = (*(0.1 * n for n in range(20)), *(2.0 + 0.5 * n for n in range(7)))
"""Of draughts that boats have; what is deeper than the last has no depth in the map."""


def planner_map(chart: DepthChart) -> dict[str, Any]:
    """GeoJSON in WGS 84: all features of the lake's map, and areas of water with `depth_m`, the least depth
    in each by the lower end of its 90 % band. What was not surveyed has no depth.
    """
    source, to_global = chart.chart, chart.chart.frame.to_global
    features = list(source.features)
    if not source.is_open:
        features.insert(0, Feature(source.name, "water", source.water))
    features += depth_areas(chart)

    def degrees(xy: np.ndarray[Any, np.dtype[np.float64]]) -> list[list[float]]:
        places = [to_global(Point(north_m, east_m)) for east_m, north_m in xy.tolist()]
        return [[round(place.lon_deg, 8), round(place.lat_deg, 8)] for place in places]

    rows = []
    for one in features:
        named = mapping(shapely.transform(one.shape, degrees))
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
