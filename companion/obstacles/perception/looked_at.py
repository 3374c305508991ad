"""Water that is known to be free: inside an uploaded inclusion fence, and where two pings met nothing.

`planning/speed_limit.py` has the speed that it allows.
"""

import math
from collections.abc import Iterator, Sequence
from typing import Final, Protocol

from companion.core.geo import Point, distance_m
from companion.obstacles.perception.occupancy import Beam

NEVER, ALWAYS, AFTER_MEETING, UNCHARTED = range(4)  # AVOID_SIGHT
WARY_M: Final = 40.0  # ten sights of 4 m: what was drawn wrongly once is drawn wrongly beside it, too
_LOOKS: Final = 2  # a single ping can miss: a smooth wall at an angle returns no echo
_CELL_M: Final = 0.5
_MAX_CELLS: Final = 20_000  # 5,000 m², and about 2 MB
_SECTORS: Final = 24  # of 15°, a beam's width
_FRESH_S: Final = 1.0  # a sector looked at longer ago is not in sight: a full sweep takes 1.4 s


class ChartedWater(Protocol):
    """A fence that may contain the water."""

    def is_charted(self, point: Point) -> bool:
        """Whether the place is inside an uploaded inclusion fence."""


class LookedAtWater:
    """Cells of water that the rangers saw through, and the time of the last clear beam in each direction."""

    def __init__(self) -> None:
        self._looks: dict[tuple[int, int], int] = {}
        self._clear: list[Beam | None] = [None] * _SECTORS
        self._unmapped_at: Point | None = None
        self.has_ranger = False  # some ranger was heard: a boat without one cannot look
        self.distrusts_chart = False  # on this voyage: it lacks what barred a way that was planned by it
        self.is_used = False  # whether the speed was limited when it was last asked for

    def clear(self) -> None:
        """Forget all: the local frame has moved."""
        self._looks.clear()
        self._clear = [None] * _SECTORS
        self._unmapped_at = None

    def note_unmapped_obstacle(self, here: Point) -> None:
        """The chart is wrong here: trust the rangers alone for WARY_M."""
        self._unmapped_at = here

    def is_limited(self, here: Point, by_sight: int, bounds: ChartedWater) -> bool:
        """Whether the speed is limited to known water at a place."""
        if by_sight < AFTER_MEETING:
            self.is_used = by_sight == ALWAYS
        else:
            at = self._unmapped_at
            is_wary = at is not None and distance_m(here, at) < WARY_M
            self.is_used = is_wary or self.distrusts_chart or self.is_uncharted(here, by_sight, bounds)
        return self.is_used

    def is_uncharted(self, here: Point, by_sight: int, bounds: ChartedWater) -> bool:
        """Whether it is limited for want of a fence."""
        return by_sight == UNCHARTED and self.has_ranger and not bounds.is_charted(here)

    def add(self, beam: Beam) -> None:
        """Mark what a beam saw through."""
        if not beam.is_echo:
            sector = _sector(beam.bearing_rad)
            last = self._clear[sector]
            if last is None or beam.reach_m >= last.reach_m or beam.time_s - last.time_s > _FRESH_S:
                self._clear[sector] = beam
        (from_n, from_e), looks, floor = beam.at, self._looks, math.floor
        steps = range(int(min(beam.range_m, beam.reach_m) / _CELL_M))
        for side in (-0.25, 0.25):  # two rays leave no gap between beams at 4 m
            bearing = beam.bearing_rad + side * beam.width_rad
            step_n, step_e = _CELL_M * math.cos(bearing), _CELL_M * math.sin(bearing)
            for step in steps:
                cell = floor((from_n + step * step_n) / _CELL_M), floor((from_e + step * step_e) / _CELL_M)
                looks[cell] = looks.get(cell, 0) + 1
        while len(looks) > _MAX_CELLS:
            del looks[next(iter(looks))]

    def is_known(self, point: Point) -> bool:
        """Whether a place was looked at twice."""
        cell = (math.floor(point.north_m / _CELL_M), math.floor(point.east_m / _CELL_M))
        return self._looks.get(cell, 0) >= _LOOKS

    def are_known(self, norths_m: Sequence[float], easts_m: Sequence[float]) -> Iterator[list[bool]]:
        """Whether the places where these rows and columns cross were looked at once, row by row."""
        looks, columns = self._looks, [math.floor(east_m / _CELL_M) for east_m in easts_m]
        for north_m in norths_m:
            row = math.floor(north_m / _CELL_M)
            yield [(row, column) in looks for column in columns]

    def room_m(
        self, here: Point, course_rad: float, reach_m: float, now_s: float, between_m: float = 0.0
    ) -> float:
        """Distance of known water along a course, at most reach_m. between_m: what the boat makes between two
        looks, which does not count: the next look is due.
        """
        last, room_m = self._clear[_sector(course_rad)], 0.0
        if last is not None and now_s - last.time_s <= _FRESH_S:
            room_m = max(last.reach_m - max(distance_m(here, last.at) - between_m, 0.0), 0.0)
        ahead_n, ahead_e = math.cos(course_rad), math.sin(course_rad)
        while room_m < reach_m:
            at_m = room_m + 0.5 * _CELL_M
            if not self.is_known(Point(here.north_m + at_m * ahead_n, here.east_m + at_m * ahead_e)):
                break
            room_m += _CELL_M
        return min(room_m, reach_m)


def _sector(bearing_rad: float) -> int:
    return round(bearing_rad * _SECTORS / math.tau) % _SECTORS
