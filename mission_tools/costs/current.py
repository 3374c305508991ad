"""The water's motion as the planner knows it: uniform, a river's profile, a grid from a file, or their sum.

Every field answers for arrays of places at once, in metres of the chart's frame, with the velocity of the
water over ground, north and east in m/s. A current is named by where it flows *to*.
"""

import csv
import math
import zipfile
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple, Protocol

import numpy as np
from numpy.lib.npyio import NpzFile
from numpy.typing import NDArray

from companion.core.errors import ConfigError
from companion.core.geo import LatLon, LocalFrame, Point

Floats = NDArray[np.float64]
METRES = ("east_m", "north_m")
DEGREES = ("lon_deg", "lat_deg")
VELOCITY = ("current_east_m_s", "current_north_m_s")


class CurrentTable(NamedTuple):
    """What a file holds: axes of k, m and n numbers, velocities of shape (k, m, n)."""

    time_s: Floats
    north_m: Floats
    east_m: Floats
    current_north_m_s: Floats
    current_east_m_s: Floats


def read_current_table(path: Path, frame: LocalFrame | None = None) -> CurrentTable:
    """Read a current from a file; positions in metres of the chart's frame, velocities in m/s.

    With a frame, lat_deg and lon_deg may stand in place of north_m and east_m, as a forecast has them.

    .csv: a header and one line per grid point with the columns east_m, north_m, current_east_m_s and
    current_north_m_s, in any order, every point of a rectangular grid once.
    .npz: arrays east_m (n), north_m (m), current_east_m_s and current_north_m_s (m, n), or with time_s (k)
    both of shape (k, m, n). Axes rise.

    Raises ConfigError: the file cannot be read, or is not such a grid; it says what is wrong.
    """
    try:
        table = _read_npz(path, frame) if path.suffix.lower() == ".npz" else _read_csv(path, frame)
        _check(table)
    except OSError as error:
        raise ConfigError(f"{path}: cannot be read: {error.strerror}") from None
    except (ValueError, UnicodeDecodeError, zipfile.BadZipFile) as error:
        raise ConfigError(f"{path}: not a current: {error}") from None
    return table


def _check(table: CurrentTable) -> None:
    for name in ("time_s", "north_m", "east_m"):
        axis = getattr(table, name)
        if (
            axis.ndim != 1
            or not len(axis)
            or not np.all(np.isfinite(axis))
            or not np.all(np.diff(axis) > 0.0)
        ):
            raise ValueError(f"{name}: expected a row of rising numbers")
    shape = (len(table.time_s), len(table.north_m), len(table.east_m))
    for name in ("current_north_m_s", "current_east_m_s"):
        values = getattr(table, name)
        if values.shape != shape:
            raise ValueError(f"{name}: expected shape {shape}, not {values.shape}")
        if not np.all(np.isfinite(values)):
            raise ValueError(f"{name}: expected finite numbers")


def _columns(names: Collection[str], frame: LocalFrame | None) -> tuple[str, str, str, str]:
    """The columns of east, north and the velocity's parts: in metres or, given a frame, in degrees. Raises
    ValueError: one is missing.
    """
    axes = DEGREES if frame is not None and set(DEGREES) <= set(names) else METRES
    missing = [name for name in (*axes, *VELOCITY) if name not in names]
    if missing:
        raise ValueError(f"it has no {', '.join(missing)}")
    return (*axes, *VELOCITY)


def _local(east: Floats, north: Floats, is_degrees: bool, frame: LocalFrame | None) -> tuple[Floats, Floats]:
    """Both axes in metres of the frame: over a chart, meridians and parallels are a rectangular grid."""
    if frame is None or not is_degrees:
        return east, north
    lat_deg, lon_deg = frame.origin.lat_deg, frame.origin.lon_deg
    easts = [frame.to_local(LatLon(lat_deg, float(lon))).east_m for lon in east]
    norths = [frame.to_local(LatLon(float(lat), lon_deg)).north_m for lat in north]
    return np.asarray(easts), np.asarray(norths)


def _read_npz(path: Path, frame: LocalFrame | None) -> CurrentTable:
    try:
        with path.open("rb") as opened, NpzFile(opened) as file:
            columns = _columns(file.files, frame)
            wanted = [name for name in (*columns, "time_s") if name in file.files]
            arrays = {name: file[name].astype(np.float64, casting="same_kind") for name in wanted}
    except OSError:
        raise
    except Exception as error:  # of many kinds, where an archive is damaged
        raise ValueError(str(error)) from None
    east, north = _local(arrays[columns[0]], arrays[columns[1]], columns[0] == DEGREES[0], frame)
    east_m_s, north_m_s = arrays[columns[2]], arrays[columns[3]]
    if "time_s" not in arrays:
        return CurrentTable(np.zeros(1), north, east, north_m_s[np.newaxis], east_m_s[np.newaxis])
    return CurrentTable(arrays["time_s"], north, east, north_m_s, east_m_s)


def _read_csv(path: Path, frame: LocalFrame | None) -> CurrentTable:
    with path.open(newline="", encoding="utf-8-sig") as file:
        reader = csv.DictReader(file)
        columns = _columns(reader.fieldnames or (), frame)
        points: dict[tuple[float, float], tuple[float, float]] = {}
        for number, row in enumerate(reader, start=2):
            try:
                east, north, east_m_s, north_m_s = (float(row[name]) for name in columns)
            except (TypeError, ValueError):
                raise ValueError(f"line {number}: expected four numbers") from None
            if (north, east) in points:
                raise ValueError(f"line {number}: the point ({east:g}, {north:g}) comes twice")
            points[north, east] = north_m_s, east_m_s
    norths = sorted({north for north, _ in points})
    easts = sorted({east for _, east in points})
    if not points or len(points) != len(norths) * len(easts):
        raise ValueError(f"{len(points)} points are no grid of {len(easts)} × {len(norths)}")
    values = np.asarray([[points[north, east] for east in easts] for north in norths], dtype=np.float64)
    sheet = values[np.newaxis]
    east_axis, north_axis = _local(np.asarray(easts), np.asarray(norths), columns[0] == DEGREES[0], frame)
    return CurrentTable(np.zeros(1), north_axis, east_axis, sheet[..., 0], sheet[..., 1])


class Current(Protocol):
    """A velocity at every place and time."""

    def at(self, north_m: Floats, east_m: Floats, time_s: Floats) -> tuple[Floats, Floats]:
        """North and east velocity of the water, m/s, each of the shape of the places.

        time_s: on the current's clock, of the same shape or one that broadcasts to it.
        """
        ...

    @property
    def varies(self) -> bool:
        """Whether it changes with time."""
        ...


@dataclass(frozen=True, slots=True)
class UniformCurrent:
    """The same velocity everywhere."""

    north_m_s: float = 0.0
    east_m_s: float = 0.0

    @classmethod
    def towards(cls, speed_m_s: float, to_deg: float) -> "UniformCurrent":
        """A speed and where it flows to, degrees clockwise from north."""
        to_rad = math.radians(to_deg)
        return cls(speed_m_s * math.cos(to_rad), speed_m_s * math.sin(to_rad))

    def at(self, north_m: Floats, east_m: Floats, time_s: Floats) -> tuple[Floats, Floats]:  # noqa: ARG002
        return np.full_like(north_m, self.north_m_s), np.full_like(east_m, self.east_m_s)

    @property
    def varies(self) -> bool:
        return False


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

    @property
    def varies(self) -> bool:
        return False


@dataclass(frozen=True, slots=True)
class GriddedCurrent:
    """Velocities on a rectangular grid, linear in between and between times, as at the edge beyond."""

    table: CurrentTable

    def at(self, north_m: Floats, east_m: Floats, time_s: Floats) -> tuple[Floats, Floats]:
        """The velocities by linear interpolation in time and along both axes of the grid."""
        table = self.table
        row, up = _piece(table.north_m, north_m)
        column, right = _piece(table.east_m, east_m)
        above = np.minimum(row + 1, len(table.north_m) - 1)
        beside = np.minimum(column + 1, len(table.east_m) - 1)
        parts = (table.current_north_m_s, table.current_east_m_s)

        def in_sheets(number: NDArray[np.intp] | int) -> list[Floats]:
            return [
                (1.0 - up)
                * ((1.0 - right) * sheets[number, row, column] + right * sheets[number, row, beside])
                + up * ((1.0 - right) * sheets[number, above, column] + right * sheets[number, above, beside])
                for sheets in parts
            ]

        if not self.varies:
            north_m_s, east_m_s = in_sheets(0)
            return north_m_s, east_m_s
        sheet, later = _piece(table.time_s, time_s)
        before, after = in_sheets(sheet), in_sheets(sheet + 1)
        return before[0] + later * (after[0] - before[0]), before[1] + later * (after[1] - before[1])

    @property
    def varies(self) -> bool:
        return len(self.table.time_s) > 1


def _piece(marks: Floats, value: Floats) -> tuple[NDArray[np.intp], Floats]:
    """The piece between two marks that holds each value, and how far along it lies, 0..1."""
    if len(marks) == 1:
        return np.zeros(value.shape, dtype=np.intp), np.zeros_like(value)
    piece = np.clip(np.searchsorted(marks, value, side="right") - 1, 0, len(marks) - 2)
    return piece, np.clip((value - marks[piece]) / (marks[piece + 1] - marks[piece]), 0.0, 1.0)


@dataclass(frozen=True, slots=True)
class Currents:
    """The sum of several."""

    parts: Sequence[Current]

    def at(self, north_m: Floats, east_m: Floats, time_s: Floats) -> tuple[Floats, Floats]:
        velocities = [part.at(north_m, east_m, time_s) for part in self.parts]
        zero = np.zeros_like(north_m)
        return sum((one[0] for one in velocities), zero), sum((one[1] for one in velocities), zero)

    @property
    def varies(self) -> bool:
        return any(part.varies for part in self.parts)
