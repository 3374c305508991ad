"""Passes along the shore: closed lines round the water, one inside the other; straight tracks cover the rest.

Direction-parallel tracks end at every shore, and each end costs a turn and what tracks and pass cover twice;
contour-parallel lines have no ends (M. Held, *On the Computational Geometry of Pocket Machining*, 1991). The
first passes take the ragged margin, as headland passes do in a field (T. Oksanen, A. Visala, "Coverage path
planning algorithms for agricultural field machines", *Journal of Field Robotics* 26, 2009), and leave the
tracks smooth water with few ends.
"""

from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from mission_tools.maps.chart import Chart
from mission_tools.tasks.room import polygons, simplified
from mission_tools.tasks.survey.settings import SurveySettings

Array = NDArray[np.float64]
RING_ERROR = 0.02  # of the footprint: how far a pass may cut its corners,
FINE_RING_ERROR = 0.003  # and where the footprint does not reach the shore anyway
MOST_LEFT_OUT = 0.004  # of the target
_QUADRANT_SEGMENTS = 4


def passes_along(
    chart: Chart, water: Sequence[Polygon], target: BaseGeometry, settings: SurveySettings
) -> tuple[list[Array], list[Polygon]]:
    """The closed passes as (east, north), and what they leave of the target but for its smallest pieces.

    water: where the boat may sail. The first pass is half a spacing off the shore, where there is so much
    water; each further one is a spacing inside of what came before it.
    """
    swath_m, spacing_m = settings.swath_m, settings.track_spacing_m
    whole, left, rings = MultiPolygon(water), target, []
    for number in range(settings.shore_passes or 0):
        inset_m = spacing_m - 0.5 * swath_m if number else 0.5 * spacing_m
        inset_m = min(inset_m, (0.5 - 2.0 * RING_ERROR) * swath_m)
        within = polygons(left.buffer(-inset_m, quad_segs=_QUADRANT_SEGMENTS).intersection(whole))
        new = _outlines(chart, within, settings.plan.required_m, inset_m, swath_m)
        if not new:
            break
        left = left.difference(shapely.MultiLineString(new).buffer(0.5 * swath_m))
        rings += new
    return rings, largest(left, MOST_LEFT_OUT * target.area)


def largest(shape: BaseGeometry, most_m2: float) -> list[Polygon]:
    """The polygons of a shape without the smallest, which have this area together at most."""
    pieces = sorted(polygons(shape), key=lambda piece: piece.area)
    areas_m2 = np.cumsum([piece.area for piece in pieces])
    return pieces[int(np.searchsorted(areas_m2, most_m2, side="right")) :]


def _outlines(
    chart: Chart, water: Sequence[Polygon], clearance_m: float, inset_m: float, swath_m: float
) -> list[Array]:
    """Of the water, with few corners; none that is shorter than a footprint, which a track covers as well."""
    error_m = (RING_ERROR if clearance_m < inset_m else FINE_RING_ERROR) * swath_m
    inset = polygons(MultiPolygon(water).buffer(-error_m, quad_segs=_QUADRANT_SEGMENTS)) or water
    outlines = [shapely.get_coordinates(ring) for ring in shapely.get_rings(inset) if ring.length > swath_m]
    return [simplified(outline, chart.shores, clearance_m, error_m) for outline in outlines]
