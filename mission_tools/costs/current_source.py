"""From the text of --current to a current: `0.5,90`, a grid in .csv, .npz or .nc, or a .toml file.

0.5,90                        0.5 m/s that flows to 90°, east
forecast.csv, forecast.npz    a grid (see `current_file.py`), in degrees or in metres of the map's frame
forecast.nc                   NetCDF (see `netcdf.py`)
flow.toml                     a sum of what it names:
    speed_m_s = 0.2           a uniform current
    to_deg = 90
    file = "forecast.csv"     a grid, beside this file
    [river]                   a channel that flows along its middle line, from the first point to the last
    speed_m_s = 1.0           on the middle line; none at half the width from it
    width_m = 40
    middle = [[50.0010, -1.2000], [50.0012, -1.1950]]      latitude, longitude
    [[tide]]                  harmonic constants of a stream, one table a constituent (see `harmonics.py`)
    name = "M2"
    speed_m_s = 0.8
    to_deg = 70               where the flood flows
    phase_deg = 215           Greenwich phase lag of the strongest flood
    minor_m_s = 0.1           of the ellipse; positive where the stream turns anticlockwise [0]
"""

import re
from pathlib import Path
from typing import Annotated

import msgspec
from msgspec import Meta

from companion.cli.program_end import how_to_install
from companion.core.errors import ConfigError
from companion.core.geo import LatLon, LocalFrame
from companion.core.toml_text import parse_toml
from mission_tools.costs.current import (
    Current,
    Currents,
    GriddedCurrent,
    River,
    UniformCurrent,
)
from mission_tools.costs.current_file import read_current_table
from mission_tools.errors import MapError, UsageError

FORMS = "SPEED,TO_DEG such as 0.5,90, or a .csv, .npz, .nc or .toml file"
_UNIFORM = re.compile(r"\s*(\d+\.?\d*|\.\d+)\s*,\s*([+-]?(?:\d+\.?\d*|\.\d+))\s*", re.ASCII)
_FASTEST_M_S = 20.0

_Speed = Annotated[float, Meta(ge=0.0, le=_FASTEST_M_S)]
_LatLon = tuple[Annotated[float, Meta(ge=-90.0, le=90.0)], Annotated[float, Meta(ge=-180.0, le=180.0)]]


class _River(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    speed_m_s: _Speed
    width_m: Annotated[float, Meta(gt=0.0)]
    middle: Annotated[tuple[_LatLon, ...], Meta(min_length=2)]


class _Constituent(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    name: str
    speed_m_s: _Speed
    to_deg: float
    phase_deg: float
    minor_m_s: Annotated[float, Meta(ge=-_FASTEST_M_S, le=_FASTEST_M_S)] = 0.0


class _Flow(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    speed_m_s: _Speed = 0.0
    to_deg: float = 0.0
    file: str = ""
    river: _River | None = None
    tide: tuple[_Constituent, ...] = ()


def open_current(text: str, frame: LocalFrame) -> Current:
    """Read a current in a chart's frame. Raises UsageError: none of the forms. MapError: a file that cannot
    be used; says what is wrong in it.
    """
    uniform = _UNIFORM.fullmatch(text)
    if uniform is not None:
        speed_m_s = float(uniform[1])
        if speed_m_s > _FASTEST_M_S:
            raise UsageError(f"--current {text}: {speed_m_s:g} m/s: expected at most {_FASTEST_M_S:g}")
        return UniformCurrent.towards(speed_m_s, float(uniform[2]))
    path = Path(text)
    suffix = path.suffix.lower()
    if suffix in (".grb", ".grb2", ".grib", ".grib2"):
        raise UsageError(f"--current {text}: GRIB is not read; first: cdo -f nc copy {text} {path.stem}.nc")
    if suffix in (".csv", ".npz", ".nc"):
        return _gridded(path, frame)
    if suffix == ".toml":
        return _from_toml(path, frame)
    raise UsageError(f"--current {text}: expected {FORMS}")


def _gridded(path: Path, frame: LocalFrame) -> GriddedCurrent:
    try:
        if path.suffix.lower() != ".nc":
            return GriddedCurrent(read_current_table(path, frame))
        from mission_tools.costs.netcdf import read_netcdf  # noqa: PLC0415 - seldom needed

        return GriddedCurrent(read_current_table(path, frame, read_netcdf))
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
    if flow.tide:
        parts.append(_tidal(path, flow.tide, frame.origin.lat_deg))
    if flow.file:
        parts.append(_gridded(path.parent / flow.file, frame))
    if not parts:
        raise MapError(f"{path}: names no current: expected speed_m_s and to_deg, [river], [[tide]] or file")
    try:
        return Currents(parts)
    except ValueError as error:
        raise MapError(f"{path}: {error}") from None


def _tidal(path: Path, constituents: tuple[_Constituent, ...], lat_deg: float) -> Current:
    from mission_tools.costs.harmonics import Constituent, TidalStream  # noqa: PLC0415 - seldom needed

    try:
        return TidalStream(tuple(Constituent(*msgspec.structs.astuple(one)) for one in constituents), lat_deg)
    except ImportError:
        raise MapError(
            f"{path}: [[tide]] needs utide, which is not installed: {how_to_install('tide')}"
        ) from None
    except ValueError as error:
        raise MapError(f"{path}: {error}") from None
