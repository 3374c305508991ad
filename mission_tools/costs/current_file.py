"""Currents from files: velocities on a rectangular grid, and at times if there is more than one."""

import csv
import zipfile
from collections.abc import Callable, Collection
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.lib.npyio import NpzFile
from numpy.typing import NDArray

from companion.core.errors import ConfigError
from companion.core.geo import LatLon, LocalFrame
from mission_tools.costs.departure import posix_s

Floats = NDArray[np.float64]
METRES = ("east_m", "north_m")
DEGREES = ("lon_deg", "lat_deg")
SECONDS, DATES = "time_s", "time_utc"
VELOCITY = ("current_east_m_s", "current_north_m_s")


class CurrentTable(NamedTuple):
    """What a file holds: axes of k, m and n numbers, velocities of shape (k, m, n).

    is_dated: time_s counts from 1970 (UTC), not from a beginning that the file leaves open.
    """

    time_s: Floats
    north_m: Floats
    east_m: Floats
    current_north_m_s: Floats
    current_east_m_s: Floats
    is_dated: bool = False


def read_current_table(
    path: Path,
    frame: LocalFrame | None = None,
    read: Callable[[Path, LocalFrame | None], CurrentTable] | None = None,
) -> CurrentTable:
    """Read a current from a file; positions in metres of the chart's frame, velocities in m/s.

    With a frame, lat_deg and lon_deg may stand in place of north_m and east_m, as a forecast has them.

    .csv: a header and one line per grid point with the columns east_m, north_m, current_east_m_s and
    current_north_m_s, in any order, every point of a rectangular grid once; with a column time_s (seconds) or
    time_utc (2026-06-01T08:00Z), once at every time.
    .npz: arrays east_m (n), north_m (m), current_east_m_s and current_north_m_s (m, n), or with time_s or
    time_utc (k, of datetime64) both of shape (k, m, n). Axes rise.

    read: another format, which raises OSError or ValueError.
    Raises ConfigError: the file cannot be read, or is not such a grid; it says what is wrong.
    """
    try:
        table = (read or (_read_npz if path.suffix.lower() == ".npz" else _read_csv))(path, frame)
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
    """Columns of east, north, velocity: metres, degrees with a frame. Raises ValueError: one is missing."""
    axes = DEGREES if frame is not None and set(DEGREES) <= set(names) else METRES
    missing = [name for name in (*axes, *VELOCITY) if name not in names]
    if missing:
        raise ValueError(f"it has no {', '.join(missing)}")
    return (*axes, *VELOCITY)


def _clock(names: Collection[str]) -> str | None:
    """The column of the time; None where the current does not change."""
    return next((name for name in (DATES, SECONDS) if name in names), None)


def _seconds(times: NDArray[Any], *, is_dated: bool) -> Floats:
    if is_dated:
        return times.astype("datetime64[us]", casting="same_kind").astype(np.float64) / 1e6
    return times.astype(np.float64, casting="same_kind")


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
            columns, when = _columns(file.files, frame), _clock(file.files)
            arrays = {name: file[name].astype(np.float64, casting="same_kind") for name in columns}
            if when is not None:
                arrays[when] = _seconds(file[when], is_dated=when == DATES)
    except OSError:
        raise
    except Exception as error:  # of many kinds, where an archive is damaged
        raise ValueError(str(error)) from None
    east, north = _local(arrays[columns[0]], arrays[columns[1]], columns[0] == DEGREES[0], frame)
    east_m_s, north_m_s = arrays[columns[2]], arrays[columns[3]]
    if when is None:
        return CurrentTable(np.zeros(1), north, east, north_m_s[np.newaxis], east_m_s[np.newaxis])
    return CurrentTable(arrays[when], north, east, north_m_s, east_m_s, when == DATES)


def _read_csv(path: Path, frame: LocalFrame | None) -> CurrentTable:
    with path.open(newline="", encoding="utf-8-sig") as file:
        reader = csv.DictReader(file)
        names = reader.fieldnames or ()
        columns, when = _columns(names, frame), _clock(names)
        numbers = "four numbers" if when is None else f"four numbers and {when}"
        points: dict[tuple[float, float, float], tuple[float, float]] = {}
        for number, row in enumerate(reader, start=2):
            try:
                time_s = 0.0 if when is None else (posix_s if when == DATES else float)(row[when])
                east, north, east_m_s, north_m_s = (float(row[name]) for name in columns)
            except (AttributeError, TypeError, ValueError):
                raise ValueError(f"line {number}: expected {numbers}") from None
            if (time_s, north, east) in points:
                raise ValueError(f"line {number}: the point ({east:g}, {north:g}) comes twice")
            points[time_s, north, east] = north_m_s, east_m_s
    times, norths, easts = (sorted({point[axis] for point in points}) for axis in range(3))
    if not points or len(points) != len(times) * len(norths) * len(easts):
        at_times = "" if when is None else f" at {len(times)} times"
        raise ValueError(f"{len(points)} points are no grid of {len(easts)} × {len(norths)}{at_times}")
    values = np.array([[[points[t, n, e] for e in easts] for n in norths] for t in times], dtype=np.float64)
    east_axis, north_axis = _local(np.asarray(easts), np.asarray(norths), columns[0] == DEGREES[0], frame)
    is_dated = when == DATES
    return CurrentTable(np.asarray(times), north_axis, east_axis, values[..., 0], values[..., 1], is_dated)
