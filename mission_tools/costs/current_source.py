"""From the text of --current to a current: `0.5,90`, a grid in .csv or .npz, or a .toml file.

0.5,90                        0.5 m/s that flows to 90°, east
forecast.csv, forecast.npz    a grid (see `read_current_table`), in degrees or in metres of the map's frame
flow.toml                     a sum of what it names:
    speed_m_s = 0.2           a uniform current
    to_deg = 90
    file = "forecast.csv"     a grid, beside this file
    [river]                   a channel that flows along its middle line, from the first point to the last
    speed_m_s = 1.0           on the middle line; none at half the width from it
    width_m = 40
    middle = [[50.0010, -1.2000], [50.0012, -1.1950]]      latitude, longitude
"""

import csv
import re
import zipfile
from collections.abc import Collection
from pathlib import Path
from typing import Annotated, NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt
from msgspec import Meta
from numpy.lib.npyio import NpzFile

from companion.core.errors import ConfigError
from companion.core.geo import LatLon, LocalFrame
from companion.core.toml_text import parse_toml
from mission_tools.costs.current import Current, Currents, GriddedCurrent, River, UniformCurrent
from mission_tools.errors import MapError, UsageError

FORMS = "SPEED,TO_DEG such as 0.5,90, or a .csv, .npz or .toml file"
_UNIFORM = re.compile(r"\s*(\d+\.?\d*|\.\d+)\s*,\s*([+-]?(?:\d+\.?\d*|\.\d+))\s*", re.ASCII)
_FASTEST_M_S = 20.0

_Speed = Annotated[float, Meta(ge=0.0, le=_FASTEST_M_S)]
_LatLon = tuple[Annotated[float, Meta(ge=-90.0, le=90.0)], Annotated[float, Meta(ge=-180.0, le=180.0)]]


class _River(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    speed_m_s: _Speed
    width_m: Annotated[float, Meta(gt=0.0)]
    middle: Annotated[tuple[_LatLon, ...], Meta(min_length=2)]


class _Flow(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    speed_m_s: _Speed = 0.0
    to_deg: float = 0.0
    file: str = ""
    river: _River | None = None


def open_current(text: str, frame: LocalFrame) -> Current:
    """Read a current in a chart's frame.

    Raises:
        UsageError: none of the forms.
        MapError: a file that cannot be used; says what is wrong in it.
    """
    uniform = _UNIFORM.fullmatch(text)
    if uniform is not None:
        speed_m_s = float(uniform[1])
        if speed_m_s > _FASTEST_M_S:
            raise UsageError(f"--current {text}: {speed_m_s:g} m/s: expected at most {_FASTEST_M_S:g}")
        return UniformCurrent.towards(speed_m_s, float(uniform[2]))
    path = Path(text)
    suffix = path.suffix.lower()
    if suffix in (".csv", ".npz"):
        return _gridded(path, frame)
    if suffix == ".toml":
        return _from_toml(path, frame)
    raise UsageError(f"--current {text}: expected {FORMS}")


def _gridded(path: Path, frame: LocalFrame) -> GriddedCurrent:
    try:
        return GriddedCurrent(read_current_table(path, frame))
    except ConfigError as error:
        raise MapError(str(error)) from None


def _from_toml(path: Path, frame: LocalFrame) -> Current:
    try:
        flow = msgspec.convert(parse_toml(path.read_text(encoding="utf-8")), _Flow)
    except OSError as error:
        raise MapError(f"{path}: cannot be read: {error.strerror}") from None
    except (ConfigError, ValueError) as error:
        raise MapError(f"{path}: not a current: {error}") from None
    parts: list[Current] = []
    if flow.speed_m_s:
        parts.append(UniformCurrent.towards(flow.speed_m_s, flow.to_deg))
    if flow.river is not None:
        middle = tuple(frame.to_local(LatLon(*place)) for place in flow.river.middle)
        parts.append(River(middle, flow.river.width_m, flow.river.speed_m_s))
    if flow.file:
        parts.append(_gridded(path.parent / flow.file, frame))
    if not parts:
        raise MapError(f"{path}: names no current: expected speed_m_s and to_deg, [river] or file")
    return Currents(parts)


METRES = ("east_m", "north_m")
DEGREES = ("lon_deg", "lat_deg")
VELOCITY = ("current_east_m_s", "current_north_m_s")
Floats = npt.NDArray[np.float64]


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

    Raises:
        ConfigError: the file cannot be read, or is not such a grid; it says what is wrong.
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
    """The columns of east, north and the velocity's parts: in metres or, given a frame, in degrees.

    Raises:
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
