"""A current from a file: velocities on a grid, read from CSV or NPZ."""

import csv
from bisect import bisect_right
from pathlib import Path
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from companion.core.errors import ConfigError

COLUMNS = ("east_m", "north_m", "current_east_m_s", "current_north_m_s")
Floats = npt.NDArray[np.float64]


class Table(NamedTuple):
    """What a file holds: axes of k, m and n numbers, velocities of shape (k, m, n)."""

    time_s: Floats
    north_m: Floats
    east_m: Floats
    current_north_m_s: Floats
    current_east_m_s: Floats


class Grid:
    """Velocities on a rectangular grid, and at times if there is more than one; outside it as at its edge.

    In between they are linear. velocities[i][j][k] is (north, east) at times_s[i], norths_m[j], easts_m[k].
    """

    def __init__(
        self,
        times_s: list[float],
        norths_m: list[float],
        easts_m: list[float],
        velocities: list[list[list[tuple[float, float]]]],
    ) -> None:
        self._times_s, self._norths_m, self._easts_m = times_s, norths_m, easts_m
        self._velocities = velocities

    def at(self, north_m: float, east_m: float, time_s: float) -> tuple[float, float]:
        """North and east velocity."""
        when, later = _piece(self._times_s, time_s)
        row, up = _piece(self._norths_m, north_m)
        column, right = _piece(self._easts_m, east_m)
        north_m_s = east_m_s = 0.0
        for i, output_at in ((when, 1.0 - later), (when + 1, later)):
            for j, in_north in ((row, 1.0 - up), (row + 1, up)):
                for k, in_east in ((column, 1.0 - right), (column + 1, right)):
                    weight = output_at * in_north * in_east
                    if weight > 0.0:
                        north, east = self._velocities[i][j][k]
                        north_m_s += weight * north
                        east_m_s += weight * east
        return north_m_s, east_m_s


def _piece(marks: list[float], value: float) -> tuple[int, float]:
    """The piece between two marks that holds a value, and how far along it lies, 0..1."""
    last = len(marks) - 1
    if last == 0 or value <= marks[0]:
        return 0, 0.0
    if value >= marks[last]:
        return last - 1, 1.0
    piece = bisect_right(marks, value) - 1
    return piece, (value - marks[piece]) / (marks[piece + 1] - marks[piece])


def read_grid(path: Path) -> Grid:
    """Read a current from a file; positions in metres of the scenario's frame, velocities in m/s.

    .csv: a header and one line per grid point with the columns east_m, north_m, current_east_m_s and
    current_north_m_s, in any order, every point of a rectangular grid once.
    .npz: arrays east_m (n), north_m (m), current_east_m_s and current_north_m_s (m, n), or with time_s (k)
    both of shape (k, m, n). Axes rise.

    Raises:
        ConfigError: the file cannot be read, or is not such a grid; it says what is wrong.
    """
    try:
        table = _read_npz(path) if path.suffix == ".npz" else _read_csv(path)
        _check(table)
    except (OSError, ValueError, UnicodeDecodeError) as error:
        raise ConfigError(f"{path}: not a current: {error}") from None
    pairs = np.stack([table.current_north_m_s, table.current_east_m_s], axis=-1).tolist()
    velocities = [[[(north, east) for north, east in row] for row in sheet] for sheet in pairs]
    return Grid(table.time_s.tolist(), table.north_m.tolist(), table.east_m.tolist(), velocities)


def _check(table: Table) -> None:
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


def _read_npz(path: Path) -> Table:
    with np.load(path, allow_pickle=False) as file:
        arrays = {name: np.asarray(file[name], dtype=np.float64) for name in file.files}
    missing = [name for name in COLUMNS if name not in arrays]
    if missing:
        raise ValueError(f"it has no {', '.join(missing)}")
    north_m_s, east_m_s = arrays["current_north_m_s"], arrays["current_east_m_s"]
    if "time_s" not in arrays:
        return Table(
            np.zeros(1), arrays["north_m"], arrays["east_m"], north_m_s[np.newaxis], east_m_s[np.newaxis]
        )
    return Table(arrays["time_s"], arrays["north_m"], arrays["east_m"], north_m_s, east_m_s)


def _read_csv(path: Path) -> Table:
    with path.open(newline="", encoding="utf-8") as file:
        reader = csv.DictReader(file)
        missing = [name for name in COLUMNS if name not in (reader.fieldnames or ())]
        if missing:
            raise ValueError(f"it has no column {', '.join(missing)}")
        points: dict[tuple[float, float], tuple[float, float]] = {}
        for number, row in enumerate(reader, start=2):
            try:
                east, north, east_m_s, north_m_s = (float(row[name]) for name in COLUMNS)
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
    return Table(np.zeros(1), np.asarray(norths), np.asarray(easts), sheet[..., 0], sheet[..., 1])
