"""The water's motion as the planner knows it: uniform, a river's profile, a grid from a file, or their sum.

Every field answers for arrays of places at once, in metres of the chart's frame, with the velocity of the
water over ground, north and east in m/s. A current is named by where it flows *to*.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from companion.core.geo import Point
from mission_tools.costs.current_file import CurrentTable, Floats
from mission_tools.costs.departure import KnownTimes


class Current(Protocol):
    """A velocity at every place and time."""

    def at(self, north_m: Floats, east_m: Floats, time_s: Floats) -> tuple[Floats, Floats]:
        """North and east velocity of the water, m/s, each of the shape of the places.

        time_s: on the current's clock, of the same shape or one that broadcasts to it.
        """
        ...

    @property
    def times(self) -> KnownTimes | None:
        """For when it is known; None: it does not change with time."""
        ...


@dataclass(frozen=True, slots=True)
class UniformCurrent:
    """The same velocity everywhere."""

    north_m_s: float = 0.0
    east_m_s: float = 0.0
    times: None = None

    @classmethod
    def towards(cls, speed_m_s: float, to_deg: float) -> "UniformCurrent":
        """A speed and where it flows to, degrees clockwise from north."""
        to_rad = math.radians(to_deg)
        return cls(speed_m_s * math.cos(to_rad), speed_m_s * math.sin(to_rad))

    def at(self, north_m: Floats, east_m: Floats, time_s: Floats) -> tuple[Floats, Floats]:  # noqa: ARG002
        return np.full_like(north_m, self.north_m_s), np.full_like(east_m, self.east_m_s)


STILL_WATER = UniformCurrent()


@dataclass(frozen=True, slots=True)
class River:
    """A channel that flows along its middle line, from the first point to the last.

    The profile is the parabola of laminar and, nearly, of turbulent open channels: full speed on the middle
    line, none at width_m / 2 from it and beyond. Raises ValueError: fewer than two points, or a width that is
    not positive.
    """

    middle: tuple[Point, ...]
    width_m: float
    speed_m_s: float
    times: None = None

    def __post_init__(self) -> None:
        if len(self.middle) < 2 or not self.width_m > 0.0:
            raise ValueError("a river needs two points of its middle line and a width above 0")

    def at(self, north_m: Floats, east_m: Floats, time_s: Floats) -> tuple[Floats, Floats]:  # noqa: ARG002
        """The profile at the distance from the nearest piece of the middle line, in the piece's direction."""
        nearest = np.full_like(north_m, np.inf)
        north_m_s, east_m_s = np.zeros_like(north_m), np.zeros_like(north_m)
        last = len(self.middle) - 2
        for number, (begin, end) in enumerate(zip(self.middle, self.middle[1:], strict=False)):
            north, east = end.north_m - begin.north_m, end.east_m - begin.east_m
            square = north * north + east * east
            if square == 0.0:
                continue
            along = ((north_m - begin.north_m) * north + (east_m - begin.east_m) * east) / square
            # The channel goes on straight beyond the ends of its middle line
            along = np.clip(along, -np.inf if number == 0 else 0.0, np.inf if number == last else 1.0)
            off = np.hypot(north_m - begin.north_m - along * north, east_m - begin.east_m - along * east)
            nearer = off < nearest
            nearest = np.where(nearer, off, nearest)
            length = math.sqrt(square)
            north_m_s = np.where(nearer, north / length, north_m_s)
            east_m_s = np.where(nearer, east / length, east_m_s)
        share = 2.0 * nearest / self.width_m
        speed = self.speed_m_s * np.maximum(0.0, 1.0 - share * share)
        return speed * north_m_s, speed * east_m_s


@dataclass(frozen=True, slots=True)
class GriddedCurrent:
    """Velocities on a rectangular grid, linear in between and between times, as at the edge beyond."""

    table: CurrentTable

    def at(self, north_m: Floats, east_m: Floats, time_s: Floats) -> tuple[Floats, Floats]:
        """The velocities by linear interpolation in time and along both axes of the grid."""
        table = self.table
        row, up = _piece(table.north_m, north_m)
        column, right = _piece(table.east_m, east_m)
        rows, columns = len(table.north_m), len(table.east_m)
        at = row * columns + column
        beside, above = np.minimum(column + 1, columns - 1) - column, np.minimum(row + 1, rows - 1) - row
        above *= columns
        parts = [part.ravel() for part in (table.current_north_m_s, table.current_east_m_s)]

        def in_sheets(number: NDArray[np.intp] | int) -> list[Floats]:
            here = at + number * (rows * columns)
            there = here + above
            return [
                (1.0 - up) * ((1.0 - right) * part.take(here) + right * part.take(here + beside))
                + up * ((1.0 - right) * part.take(there) + right * part.take(there + beside))
                for part in parts
            ]

        if len(table.time_s) == 1:
            north_m_s, east_m_s = in_sheets(0)
            return north_m_s, east_m_s
        sheet, later = _piece(table.time_s, time_s)
        before, after = in_sheets(sheet), in_sheets(sheet + 1)
        return before[0] + later * (after[0] - before[0]), before[1] + later * (after[1] - before[1])

    @property
    def times(self) -> KnownTimes | None:
        first_s, last_s = float(self.table.time_s[0]), float(self.table.time_s[-1])
        return KnownTimes(first_s, last_s, self.table.is_dated) if first_s < last_s else None


def _piece(marks: Floats, value: Floats) -> tuple[NDArray[np.intp], Floats]:
    """The piece between two marks that holds each value, and how far along it lies, 0..1."""
    if len(marks) == 1:
        return np.zeros(value.shape, dtype=np.intp), np.zeros_like(value)
    piece = np.clip(np.searchsorted(marks, value, side="right") - 1, 0, len(marks) - 2)
    return piece, np.clip((value - marks[piece]) / (marks[piece + 1] - marks[piece]), 0.0, 1.0)


@dataclass(frozen=True, slots=True)
class Currents:
    """The sum of several, on one clock. Raises ValueError: some times are dates, others are not."""

    parts: Sequence[Current]

    def __post_init__(self) -> None:
        if len({part.times.is_dated for part in self.parts if part.times is not None}) > 1:
            raise ValueError("some of its parts have dates and others seconds: expected one clock")

    def at(self, north_m: Floats, east_m: Floats, time_s: Floats) -> tuple[Floats, Floats]:
        velocities = [part.at(north_m, east_m, time_s) for part in self.parts]
        zero = np.zeros_like(north_m)
        return sum((one[0] for one in velocities), zero), sum((one[1] for one in velocities), zero)

    @property
    def times(self) -> KnownTimes | None:
        known = [part.times for part in self.parts if part.times is not None]
        if not known:
            return None
        return KnownTimes(max(one[0] for one in known), min(one[1] for one in known), known[0].is_dated)
