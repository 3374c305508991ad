"""The pass along the shore: where the tracks of a survey end, closed lines cover what lies between them.

A pass at the clearance would cover land. It runs so far out that the footprint still reaches the shore, and
goes into those coves and narrows that it would otherwise leave out: all but a few of the smallest,
MOST_LEFT_OUT together.
"""

import math
from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from mission_tools.maps.chart import Chart
from mission_tools.tasks.room import polygons, simplified

Array = NDArray[np.float64]
CORNER_INSET = 0.5 * math.sqrt(0.5)  # of the footprint: so near to an edge, its square corners are covered
RING_ERROR = 0.02  # of the footprint: how far a pass may cut its corners,
FINE_RING_ERROR = 0.003  # and where the footprint does not reach the shore anyway
MOST_LEFT_OUT = 0.002  # of the target
_QUADRANT_SEGMENTS = 4
_REACH = 0.52  # of the footprint: from water left out, a little beyond the pass that leaves it out


def water_within_pass(
    chart: Chart, water: Sequence[Polygon], target: BaseGeometry, swath_m: float
) -> list[Polygon]:
    """The part of the water whose outline is the pass along the shore.

    water: what the boat may use. target: what is to be covered.
    """
    whole = MultiPolygon(water)
    inset = chart.navigable.buffer(-CORNER_INSET * swath_m, quad_segs=_QUADRANT_SEGMENTS)
    offshore = inset.intersection(whole)
    left_out = target.difference(offshore.buffer(0.5 * swath_m, quad_segs=_QUADRANT_SEGMENTS))
    gaps = sorted(polygons(left_out), key=lambda gap: gap.area)
    areas_m2 = np.cumsum([gap.area for gap in gaps])
    gaps = gaps[int(np.searchsorted(areas_m2, MOST_LEFT_OUT * target.area, side="right")) :]
    if not gaps:
        return polygons(offshore)
    around = shapely.union_all([gap.buffer(_REACH * swath_m, quad_segs=_QUADRANT_SEGMENTS) for gap in gaps])
    return polygons(offshore.union(whole.intersection(around)))


def passes_along(chart: Chart, water: Sequence[Polygon], clearance_m: float, swath_m: float) -> list[Array]:
    """The closed outlines as (east, north), with few corners."""
    error_m = (RING_ERROR if clearance_m < CORNER_INSET * swath_m else FINE_RING_ERROR) * swath_m
    inset = polygons(MultiPolygon(water).buffer(-error_m, quad_segs=_QUADRANT_SEGMENTS)) or water
    outlines = [shapely.get_coordinates(ring) for ring in shapely.get_rings(inset)]
    return [simplified(outline, chart.shores, clearance_m, error_m) for outline in outlines]
