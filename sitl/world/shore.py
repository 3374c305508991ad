"""The shore as line segments, found fast: what a sonar's ray hits, and whether a step runs aground.

Coordinates are east and north metres of the scenario's frame. A square grid is laid over the plane; the
segments within reach of a cell are looked up once in a spatial index, when a boat first enters that cell.
Out on open water a query is then one dictionary look-up, whatever the length of the shoreline.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import shapely

from mission_tools.maps.chart import Chart


class Segment(NamedTuple):
    """A stretch of shore from (east_m, north_m) along (d_east_m, d_north_m).

    radius_m: how round it is. Of what lies in the water, that of the circle with the outline's length, or
    more where its corners turn less; infinite for the bank.
    """

    east_m: float
    north_m: float
    d_east_m: float
    d_north_m: float
    radius_m: float = math.inf


class Shore:
    """The edge of a body of water, obstacles included.

    reach_m is the longest ray or step that will be asked for.
    """

    def __init__(self, chart: Chart, reach_m: float) -> None:
        """Index the edge of the chart's water. Areas to keep out of are water like any other."""
        self._reach_m = reach_m
        self._cells: dict[tuple[int, int], tuple[Segment, ...]] = {}
        lines, radii_m = _boundary_segments(chart)
        self._tree = shapely.STRtree(shapely.linestrings(lines)) if len(lines) else None
        self._segments = [
            Segment(start[0], start[1], end[0] - start[0], end[1] - start[1], radius_m)
            for (start, end), radius_m in zip(lines.tolist(), radii_m, strict=True)
        ]

    def near(self, east_m: float, north_m: float) -> tuple[Segment, ...]:
        """Every segment within reach of a point, and some beyond."""
        if self._tree is None:
            return ()
        cell = math.floor(east_m / self._reach_m), math.floor(north_m / self._reach_m)
        found = self._cells.get(cell)
        if found is None:
            found = self._cells[cell] = self._look_up(cell)
        return found

    def _look_up(self, cell: tuple[int, int]) -> tuple[Segment, ...]:
        assert self._tree is not None  # noqa: S101  (near() has asked)
        reach = self._reach_m
        west, south = (cell[0] - 1) * reach, (cell[1] - 1) * reach
        around = shapely.box(west, south, west + 3.0 * reach, south + 3.0 * reach)
        return tuple(
            self._segments[i] for i in sorted(self._tree.query(around, predicate="intersects").tolist())
        )

    def range_m(
        self, east_m: float, north_m: float, bearings_rad: Sequence[float], max_range_m: float
    ) -> float:
        """The nearest echo of a fan of rays from one point; infinite when there is none within max_range_m.

        As for `echoes`.
        """
        echoes = self.echoes(east_m, north_m, bearings_rad, max_range_m)
        return min((range_m for range_m, _ in echoes), default=math.inf)

    def echoes(
        self,
        east_m: float,
        north_m: float,
        bearings_rad: Sequence[float],
        max_range_m: float,
        grazing: float = 0.0,
    ) -> list[tuple[float, float]]:
        """Range and radius of what each ray of a fan from one point meets; none if nothing is near.

        The range is infinite without an echo within max_range_m. The bearings come in clockwise order and
        span less than a half turn; max_range_m is within reach. grazing: sine of the angle between ray and
        shore below which the shore mirrors a ray away.
        """
        segments = self.near(east_m, north_m)
        if not segments:
            return []
        rays = [(math.sin(bearing), math.cos(bearing)) for bearing in bearings_rad]
        (first_east, first_north), (last_east, last_north) = rays[0], rays[-1]
        nearest = [(math.inf, math.inf)] * len(rays)
        for at_east, at_north, d_east, d_north, radius in segments:
            to_east, to_north = at_east - east_m, at_north - north_m
            # Most segments lie wholly to one side of the fan.
            side = to_east * first_north - to_north * first_east
            if side < 0.0 and side + d_east * first_north - d_north * first_east < 0.0:
                continue
            side = to_east * last_north - to_north * last_east
            if side > 0.0 and side + d_east * last_north - d_north * last_east > 0.0:
                continue
            area = to_east * d_north - to_north * d_east
            for ray, (ray_east, ray_north) in enumerate(rays):
                across = ray_east * d_north - ray_north * d_east
                if across != 0.0 and 0.0 <= (to_east * ray_north - to_north * ray_east) / across <= 1.0:
                    distance = area / across
                    if 0.0 <= distance < abs(nearest[ray][0]):
                        is_mirrored = abs(across) < grazing * math.hypot(d_east, d_north)
                        # A mirrored ray is lost, yet nothing behind it echoes.
                        nearest[ray] = (-distance if is_mirrored else distance, radius)
        return [(range_m if 0.0 <= range_m <= max_range_m else math.inf, of) for range_m, of in nearest]

    def room_m(self, east_m: float, north_m: float) -> float:
        """Distance to the nearest shore, or the reach where that is less."""
        nearest = self._reach_m * self._reach_m
        for at_east, at_north, d_east, d_north, _ in self.near(east_m, north_m):
            to_east, to_north = east_m - at_east, north_m - at_north
            along = (to_east * d_east + to_north * d_north) / (d_east * d_east + d_north * d_north)
            along = 0.0 if along < 0.0 else min(along, 1.0)
            gap_east, gap_north = to_east - along * d_east, to_north - along * d_north
            nearest = min(nearest, gap_east * gap_east + gap_north * gap_north)
        return math.sqrt(nearest)

    def clearances_m(self, east_m: Sequence[float], north_m: Sequence[float]) -> list[float]:
        """How far each point is from the nearest shore; infinite on open water."""
        if self._tree is None:
            return [math.inf] * len(east_m)
        points = shapely.points(np.asarray(east_m), np.asarray(north_m))
        _, distances = self._tree.query_nearest(points, return_distance=True, all_matches=False)
        return [float(distance) for distance in distances]


_STRAIGHT_RAD = 1e-3
_Lines = np.ndarray[tuple[int, int, int], np.dtype[np.float64]]


def _boundary_segments(chart: Chart) -> tuple[_Lines, list[float]]:
    """Start and end of each stretch of shore, shape (n, 2, 2), in (east, north), and its radius."""
    parts, radii_m = [np.empty((0, 2, 2))], []
    for area in shapely.get_parts(chart.water):
        rings = shapely.get_rings(area)
        for ring in rings[1:] if chart.is_open else rings:  # open water's outer ring only stands for the sea
            corners = shapely.get_coordinates(ring)
            lines = np.stack([corners[:-1], corners[1:]], axis=1)
            lines = lines[np.any(lines[:, 0] != lines[:, 1], axis=1)]  # a repeated corner is no stretch
            parts.append(lines)
            least_m = math.inf if ring is rings[0] else ring.length / math.tau
            radii_m += _radii_m(lines, least_m)
    return np.concatenate(parts), radii_m


def _radii_m(lines: _Lines, least_m: float) -> list[float]:
    """Of a closed outline's stretches: the length over what the outline turns at its ends, shared by both."""
    ways = lines[:, 1] - lines[:, 0]
    lengths_m, bearings = np.hypot(ways[:, 0], ways[:, 1]), np.arctan2(ways[:, 1], ways[:, 0])
    turns = np.abs((np.diff(bearings, append=bearings[:1]) + math.pi) % math.tau - math.pi)
    shared = 0.5 * (turns + np.roll(turns, 1))
    radii_m: list[float] = np.maximum(lengths_m / np.maximum(shared, _STRAIGHT_RAD), least_m).tolist()
    return radii_m
