"""Which part of a chart a picture shows."""

from collections.abc import Sequence

import shapely
from shapely.geometry.base import BaseGeometry

from companion.core.geo import Point
from mission_tools.drawing.legend import View
from mission_tools.maps.chart import Chart

MARGIN_SHARE = 0.16
WHOLE_CHART_RATIO = 4.0
PART_COLOURS = ("#d55e00", "#0072b2", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000")
"""Of lines beside each other (M. Okabe and K. Ito, *Color Universal Design*, 2008; yellow is too light)."""


def view_of(
    chart: Chart, route: Sequence[Point] | None, track: Sequence[Point] | None, aspect: float | None = None
) -> View:
    """What of a chart a picture shows, for an aspect of width ÷ height; None: as it comes.

    The whole chart, or the surroundings of route and track where those are far smaller.
    """
    points = [*(route or ()), *(track or ())]
    shown: list[BaseGeometry] = [shapely.Point(point.east_m, point.north_m) for point in points]
    if chart.is_open:
        shown += [feature.shape for feature in chart.features]
    elif not shown or not _is_far_larger(chart, shown):
        shown.append(chart.water)
    west, south, east, north = shapely.union_all(shown).bounds if shown else (-50.0, -50.0, 50.0, 50.0)
    is_whole = len(shown) > len(points) and not chart.is_open
    width, height = max(east - west, 1e-3), max(north - south, 1e-3)
    margin = (0.035 if is_whole else MARGIN_SHARE) * max(width, height)
    width, height = width + 2.0 * margin, height + 2.0 * margin
    if aspect is not None:
        width, height = max(width, height * aspect), max(height, width / aspect)
    middle_east, middle_north = 0.5 * (west + east), 0.5 * (south + north)
    return (
        middle_east - 0.5 * width,
        middle_north - 0.5 * height,
        middle_east + 0.5 * width,
        middle_north + 0.5 * height,
    )


def _is_far_larger(chart: Chart, shown: list[BaseGeometry]) -> bool:
    def extent(bounds: View) -> float:
        return max(bounds[2] - bounds[0], bounds[3] - bounds[1])

    route = shapely.union_all(shown).bounds
    return extent(chart.water.bounds) > WHOLE_CHART_RATIO * max(extent(route), 1e-3)
