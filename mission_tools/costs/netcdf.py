"""Currents from NetCDF files with the CF conventions, as ocean models and forecast services write them.

NetCDF-3 is read by scipy, NetCDF-4 by netCDF4 (extra `tide`). Of several depths the first is taken, of a
large sea what lies round the chart; what the model leaves out as land is as in the nearest water.
"""

import contextlib
import re
from pathlib import Path
from typing import Any

import numpy as np
from scipy.io import netcdf_file
from scipy.ndimage import distance_transform_edt

from companion.cli.program_end import how_to_install
from companion.core.geo import LatLon, LocalFrame
from mission_tools.costs.current_file import CurrentTable, Floats
from mission_tools.costs.departure import posix_s

_REACH_DEG = 2.0
_SECONDS = {"second": 1.0, "sec": 1.0, "s": 1.0, "minute": 60.0, "min": 60.0, "hour": 3600.0, "hr": 3600.0,
            "h": 3600.0, "day": 86400.0, "d": 86400.0}  # fmt: skip
_SINCE = re.compile(r"(\w+?)s? since (\S+(?:[ T][\d:.]+)?)\s*(?:UTC|Z|\+?00?:?00)?")


def read_netcdf(path: Path, frame: LocalFrame | None) -> CurrentTable:
    """Read a current round a chart. Raises ValueError: what is wrong in the file. OSError: unreadable."""
    if frame is None:
        raise ValueError("its places are latitudes and longitudes: expected metres")
    with path.open("rb") as opened:
        is_classic = opened.read(3) == b"CDF"
    try:
        with netcdf_file(path, mmap=False, maskandscale=True) if is_classic else _dataset(path) as file:
            return _table(file.variables, frame)
    except (OSError, ValueError):
        raise
    except Exception as error:  # of many kinds, where a file is damaged or unusual
        raise ValueError(f"not as the CF conventions have it: {error}") from None


def _dataset(path: Path) -> Any:  # noqa: ANN401 - of a library without types
    try:
        from netCDF4 import Dataset  # noqa: PLC0415 - the extra
    except ImportError:
        raise ValueError(
            f"NetCDF-4 needs netCDF4, which is not installed: {how_to_install('tide')}"
        ) from None
    return Dataset(path)


def _table(variables: Any, frame: LocalFrame) -> CurrentTable:  # noqa: ANN401 - of two libraries
    east, north = (
        _velocity(variables, "eastward", "uo u water_u"),
        _velocity(variables, "northward", "vo v water_v"),
    )
    if east.dimensions != north.dimensions:
        raise ValueError("its velocities lie on two grids: expected both at the same places")
    kinds = [_kind(variables.get(name)) for name in east.dimensions]
    if not {"lat", "lon"} <= set(kinds):
        raise ValueError("expected a grid along latitude and longitude (degrees_north, degrees_east)")
    axes = dict(zip(kinds, (variables.get(name) for name in east.dimensions), strict=True))
    lat, lon = (np.asarray(axes[kind][:], dtype=np.float64) for kind in ("lat", "lon"))
    origin = frame.origin
    lon = np.asarray(np.mod(lon - origin.lon_deg + 180.0, 360.0) - 180.0 + origin.lon_deg)
    rows, columns = _near(lat, origin.lat_deg, "latitude"), _near(lon, origin.lon_deg, "longitude")
    spans = {kind: slice(n.min(), n.max() + 1) for kind, n in (("lat", rows), ("lon", columns))}
    index = tuple(0 if kind is None else spans.get(kind, slice(None)) for kind in kinds)
    kept = [kind for kind in kinds if kind is not None]
    order = [kept.index(kind) for kind in ("time", "lat", "lon") if kind in kept]
    parts = []
    for variable in (north, east):
        values = np.ma.filled(np.ma.asarray(variable[index], dtype=np.float64), np.nan).transpose(order)
        parts.append(_filled(values[..., (rows - rows.min())[:, np.newaxis], columns - columns.min()]))
    times = _posix_s(axes["time"]) if "time" in axes else np.zeros(1)
    norths = np.array([frame.to_local(LatLon(float(at), origin.lon_deg)).north_m for at in lat[rows]])
    easts = np.array([frame.to_local(LatLon(origin.lat_deg, float(at))).east_m for at in lon[columns]])
    return CurrentTable(times, norths, easts, parts[0], parts[1], "time" in axes)


def _velocity(variables: Any, towards: str, names: str) -> Any:  # noqa: ANN401 - of two libraries
    """The variable of a velocity: by its standard name, else by a usual one."""
    wanted = re.compile(rf"(\w+_)?{towards}_sea_water_velocity")
    for variable in variables.values():
        if wanted.fullmatch(_attribute(variable, "standard_name")):
            return variable
    for name in names.split():
        if name in variables:
            return variables[name]
    raise ValueError(f"it has no {towards}_sea_water_velocity")


def _kind(axis: Any) -> str | None:  # noqa: ANN401 - of two libraries
    """What an axis is, by its unit; None for depths and the like."""
    units = "" if axis is None else _attribute(axis, "units").lower()
    if " since " in units:
        return "time"
    return {"degrees_n": "lat", "degree_no": "lat", "degrees_e": "lon", "degree_ea": "lon"}.get(units[:9])


def _attribute(variable: Any, name: str) -> str:  # noqa: ANN401 - of two libraries
    value = getattr(variable, name, "")
    return value.decode() if isinstance(value, bytes) else str(value)


def _near(axis: Floats, at_deg: float, what: str) -> Any:  # noqa: ANN401 - an index
    """The rising part of an axis that lies round a place."""
    order = np.argsort(axis)
    near = order[np.abs(axis[order] - at_deg) <= _REACH_DEG]
    if not len(near) or not axis.min() - 0.5 <= at_deg <= axis.max() + 0.5:
        raise ValueError(f"it ends at {what} {axis.min():g} to {axis.max():g}, far from {at_deg:.4f}")
    return near


def _posix_s(axis: Any) -> Floats:  # noqa: ANN401 - of two libraries
    units, calendar = _attribute(axis, "units"), _attribute(axis, "calendar") or "standard"
    found = _SINCE.fullmatch(units.strip())
    unit_s = _SECONDS.get(found[1]) if found else None
    with contextlib.suppress(ValueError):
        if found and unit_s and "360" not in calendar and "leap" not in calendar:
            return posix_s(found[2]) + unit_s * np.asarray(axis[:], dtype=np.float64)
    raise ValueError(f"its times are in '{units}' ({calendar}): expected hours since 2000-01-01")


def _filled(values: Floats) -> Floats:
    """Land as in the nearest water, in sheets for all times."""
    sheets = values.reshape(-1, *values.shape[-2:])
    land = np.isnan(sheets).any(axis=0)
    if land.all():
        raise ValueError("there is no water round the chart")
    row, column = distance_transform_edt(land, return_distances=False, return_indices=True)
    filled: Floats = sheets[:, row, column]
    return filled
