"""Search patterns that grow from a datum, where what is sought is most likely (IAMSAR Manual, volume II)."""

import math
from collections.abc import Sequence
from typing import Literal

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import MultiPolygon, Polygon

from mission_tools.errors import UsageError
from mission_tools.tasks.survey.postman import Visit
from mission_tools.tasks.survey.tracks import MOST_STRIPS

Array = NDArray[np.float64]
PatternName = Literal["expanding-square", "spiral"]
_CHORD_RAD = math.radians(20.0)  # of a spiral, from waypoint to waypoint: 1.5 % of the radius inside it


def pattern(
    name: PatternName, datum: Array | None, course_rad: float, spacing_m: float, water: Sequence[Polygon]
) -> list[Visit]:
    """The pattern's line through the water, from the datum until it lies all round it, cut where land is.

    datum: as (east, north), None: the middle of the water. course_rad: of the first leg, as a rule the drift;
    turns are to starboard. Raises UsageError: far too many turns.
    """
    room = MultiPolygon(list(water))
    datum = shapely.get_coordinates(room.centroid)[0] if datum is None else datum
    reach_m = float(np.hypot(*(shapely.get_coordinates(room) - datum).T).max()) + spacing_m
    if reach_m > 0.5 * MOST_STRIPS * spacing_m:
        raise UsageError(
            f"a {name} with {spacing_m:g} m from line to line has far too many turns: choose more"
        )
    outward = _square(reach_m, spacing_m) if name == "expanding-square" else _spiral(reach_m, spacing_m)
    cos, sin = math.cos(course_rad), math.sin(course_rad)
    line = shapely.LineString(datum + outward @ np.array([[cos, -sin], [sin, cos]]))
    parts = [part for part in shapely.get_parts(line.intersection(room)) if part.length > 0.0]
    along_m = np.array(
        [[line.project(shapely.get_point(part, end)) for end in (0, -1)] for part in parts]
    ).reshape(-1, 2)
    onward = [
        part if first < last else part.reverse() for part, (first, last) in zip(parts, along_m, strict=True)
    ]
    return [Visit("track", shapely.get_coordinates(onward[n])) for n in np.argsort(np.min(along_m, axis=1))]


def _square(reach_m: float, spacing_m: float) -> Array:
    """Legs of 1, 1, 2, 2, 3, 3, … spacings, ahead first, then always a right angle to starboard."""
    legs = np.arange(4 * math.ceil(reach_m / spacing_m) + 2)
    lengths_m, turn = spacing_m * (legs // 2 + 1), legs * (0.5 * math.pi)
    steps = lengths_m[:, None] * np.column_stack((np.sin(turn), np.cos(turn)))
    return np.vstack(([[0.0, 0.0]], np.cumsum(steps, axis=0)))


def _spiral(reach_m: float, spacing_m: float) -> Array:
    """Of Archimedes, a spacing from turn to turn."""
    turn = np.arange(0.0, math.tau * (reach_m / spacing_m + 1.0), _CHORD_RAD)
    radius_m = spacing_m * turn / math.tau
    found: Array = radius_m[:, None] * np.column_stack((np.sin(turn), np.cos(turn)))
    return found
