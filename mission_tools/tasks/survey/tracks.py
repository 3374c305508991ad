"""Parallel tracks over the water that is left to cover, and the cells that they form.

The water is cut into strips, one a track. Of each piece of a strip, the track is as long as needed:
a point of the piece at (across, along) from the track's line is covered by the footprint w of a track that
comes as near as sqrt((w/2)² - across²) along the line. The extremes of that over a polygon lie at its
corners, so the shortest track that covers the piece is known exactly.

Neighbouring tracks form a cell as long as strips neither split nor merge (the boustrophedon cells of H.
Choset, "Coverage of known spaces", *Autonomous Robots* 9, 2000). A cell is sailed to and fro without a
transit.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from mission_tools.errors import UsageError
from mission_tools.tasks.room import polygons

Array = NDArray[np.float64]
MOST_STRIPS = 5000  # a boat holds as many waypoints at most
ANGLES = 180  # candidates for the best course
_TOUCH_M = 1e-6


class Track(NamedTuple):
    """A line from `low` to `high` along the course, at `across` to its right."""

    across_m: float
    low_m: float
    high_m: float


class Tracks(NamedTuple):
    """All tracks of a survey in the frame of its course, and the cells: indices of neighbours in order."""

    course_rad: float
    tracks: tuple[Track, ...]
    cells: tuple[tuple[int, ...], ...]
    spacing_m: float = 0.0  # as it came out

    def ends(self) -> Array:
        """The low end of every track, then the high end of every track, as (east, north)."""
        across, low, high = np.array(self.tracks, dtype=np.float64).reshape(-1, 3).T
        ends = np.vstack((np.column_stack((across, low)), np.column_stack((across, high))))
        return _turned(ends, self.course_rad, back=True)


def fewest_turns_rad(water: Sequence[Polygon]) -> float:
    """The course with the fewest track ends, to a degree, in [0, π).

    Lines cross an outline as often as its edges are wide across the lines (Cauchy and Crofton), so the number
    of track ends is the sum of those widths over the spacing, whatever the spacing. The tracks' whole length
    does not depend on the course.
    """
    edges = np.vstack([np.diff(shapely.get_coordinates(ring), axis=0) for ring in shapely.get_rings(water)])
    courses = np.arange(ANGLES) * (math.pi / ANGLES)
    across_m = edges[:, :1] * np.cos(courses) - edges[:, 1:] * np.sin(courses)
    return float(courses[int(np.argmin(np.abs(across_m).sum(axis=0)))])


def lay_tracks(
    water: Sequence[Polygon],
    course_rad: float,
    spacing_m: float,
    swath_m: float,
    within: BaseGeometry | None = None,
) -> Tracks:
    """The shortest tracks along a course that cover the water, at most spacing_m apart, evenly spread.

    within: where tracks may lie, None: they will lie in the water. A track that leaves it is cut into what is
    left; where that is nothing, the track goes through the nearest place there.
    """
    turned = shapely.transform(shapely.MultiPolygon(list(water)), lambda xy: _turned(xy, course_rad))
    room = None if within is None else shapely.transform(within, lambda xy: _turned(xy, course_rad))
    shapely.prepare(room)
    west, south, east, north = turned.bounds
    strips = max(1, math.ceil((east - west) / spacing_m - 1e-9))
    if strips > MOST_STRIPS:
        raise UsageError(
            f"{strips} tracks {spacing_m:g} m apart are too many, {MOST_STRIPS} are possible: "
            "choose a wider spacing or a smaller area"
        )
    width_m = (east - west) / strips
    tracks: list[Track] = []
    onward: list[list[int]] = []
    back: list[list[int]] = []
    before: list[tuple[int, Array]] = []
    for strip in range(strips):
        left_m, right_m = west + strip * width_m, west + (strip + 1) * width_m
        here: list[tuple[int, Array]] = []
        for piece in polygons(shapely.clip_by_rect(turned, left_m, south - 1.0, right_m, north + 1.0)):
            corners = shapely.get_coordinates(piece)
            left_sides, right_sides = _sides(corners, left_m), _sides(corners, right_m)
            for track in _parts_of(piece, 0.5 * (left_m + right_m), swath_m, room):
                number = len(tracks)
                tracks.append(track)
                onward.append([])
                back.append([])
                here.append((number, right_sides))
                for other, sides in before:
                    if _overlap(left_sides, sides):
                        onward[other].append(number)
                        back[number].append(other)
        before = here
    return Tracks(course_rad, tuple(tracks), _cells(onward, back), width_m)


def together(groups: Sequence[Tracks]) -> Tracks:
    """Tracks of one course, laid apart."""
    tracks, cells = list[Track](), list[tuple[int, ...]]()
    for group in groups:
        cells += [tuple(number + len(tracks) for number in cell) for cell in group.cells]
        tracks += group.tracks
    return Tracks(groups[0].course_rad, tuple(tracks), tuple(cells), max(one.spacing_m for one in groups))


def lines_across(water: Sequence[Polygon], course_rad: float, spacing_m: float) -> Tracks:
    """Lines along a course through the water, spacing_m apart, each a cell of its own; one at least."""
    turned: BaseGeometry = shapely.transform(
        shapely.MultiPolygon(list(water)), lambda xy: _turned(xy, course_rad)
    )
    west, south, east, north = turned.bounds
    count = max(1, round((east - west) / spacing_m))
    across = west + (np.arange(count) + 0.5) * (east - west) / count
    lines = shapely.linestrings([[(x, south - 1.0), (x, north + 1.0)] for x in across])
    tracks = []
    for pieces in shapely.intersection(lines, turned):
        for part in shapely.get_parts(pieces):
            if part.geom_type == "LineString" and part.length > 0.0:
                (x, one), (_, other) = part.coords[0], part.coords[-1]
                tracks.append(Track(x, min(one, other), max(one, other)))
    return Tracks(course_rad, tuple(tracks), tuple((number,) for number in range(len(tracks))))


def _track(corners: Array, across_m: float, swath_m: float) -> Track:
    half = np.sqrt(np.maximum(0.25 * swath_m * swath_m - (corners[:, 0] - across_m) ** 2, 0.0))
    low, high = float(np.min(corners[:, 1] + half)), float(np.max(corners[:, 1] - half))
    if low > high:  # one point covers it all
        low = high = 0.5 * (low + high)
    return Track(across_m, low, high)


def _parts_of(piece: Polygon, across_m: float, swath_m: float, room: BaseGeometry | None) -> list[Track]:
    """What lies in the room of the track that covers a piece of a strip."""
    corners = shapely.get_coordinates(piece)
    found = _inside(_track(corners, across_m, swath_m), room)
    if room is None or found:
        return found
    nearest = shapely.shortest_line(room, piece.centroid)
    (x, y), _ = shapely.get_coordinates(nearest)
    return _inside(_track(corners, x, swath_m), room) or [Track(x, y, y)]


def _inside(track: Track, room: BaseGeometry | None) -> list[Track]:
    line = shapely.LineString([(track.across_m, track.low_m), (track.across_m, track.high_m)])
    if room is None or room.covers(line):
        return [track]
    return [
        Track(track.across_m, part.bounds[1], part.bounds[3])
        for part in shapely.get_parts(line.intersection(room))
        if part.length > 0.0
    ]


def _sides(corners: Array, across_m: float) -> Array:
    """The stretches (low, high) of a piece's outline on a strip's side."""
    on = np.abs(corners[:, 0] - across_m) < _TOUCH_M
    edges = np.flatnonzero(on[:-1] & on[1:])
    return np.sort(np.column_stack((corners[edges, 1], corners[edges + 1, 1])), axis=1)


def _overlap(one: Array, other: Array) -> bool:
    low = np.maximum(one[:, None, 0], other[None, :, 0])
    high = np.minimum(one[:, None, 1], other[None, :, 1])
    return bool(np.any(high - low > _TOUCH_M))


def _cells(onward: list[list[int]], back: list[list[int]]) -> tuple[tuple[int, ...], ...]:
    """Runs of tracks, each with one neighbour onward that has one neighbour back."""
    cells, taken = [], set()
    for first in range(len(onward)):
        if first in taken:
            continue
        cell = [first]
        while len(onward[cell[-1]]) == 1 and len(back[onward[cell[-1]][0]]) == 1:
            cell.append(onward[cell[-1]][0])
        taken.update(cell)
        cells.append(tuple(cell))
    return tuple(cells)


def _turned(xy: Array, course_rad: float, *, back: bool = False) -> Array:
    """(east, north) to (across, along) the course; or back."""
    cos, sin = math.cos(course_rad), math.sin(course_rad)
    turn = np.array([[cos, sin], [-sin, cos]])
    found: Array = xy @ (turn.T if back else turn)
    return found
