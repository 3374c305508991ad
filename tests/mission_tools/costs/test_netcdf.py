"""Currents from NetCDF files, written by the libraries' own writers."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.io import netcdf_file

from companion.core.geo import LatLon, LocalFrame
from mission_tools.costs.current import Current
from mission_tools.costs.current_source import open_current
from mission_tools.costs.departure import posix_s
from mission_tools.errors import MapError, UsageError

FRAME = LocalFrame(LatLon(50.0, -1.2))
LAT, LON = np.linspace(49.8, 50.2, 5), np.linspace(-1.4, -1.0, 5)
HOURS = np.array([8.0, 9.0, 10.0])
UO = np.ones((3, 5, 5)) * np.array([0.1, 0.3, -0.5])[:, np.newaxis, np.newaxis]
VO = np.ones((3, 5, 5)) * LAT[np.newaxis, :, np.newaxis] - 50.0
SINCE = "hours since 2026-06-01 00:00:00"
EIGHT_S = posix_s("2026-06-01T08:00Z")


def written(file: Any, **changed: Any) -> None:  # noqa: ANN401 - of two libraries
    """A forecast with time, depth, latitude and longitude."""
    values = {"time": HOURS, "depth": np.array([0.5, 10.0]), "latitude": LAT, "longitude": LON} | changed
    units = {"time": changed.get("units", SINCE), "depth": "m", "latitude": "degrees_north",
             "longitude": "degrees_east"}  # fmt: skip
    for name, unit in units.items():
        file.createDimension(name, len(values[name]))
        axis = file.createVariable(name, "f8", (name,))
        axis[:] = values[name]
        axis.units = unit
    for name, data in (("uo", changed.get("uo", UO)), ("vo", changed.get("vo", VO))):
        variable = file.createVariable(name, "f8", tuple(units))
        variable[:] = np.stack((data, 9.0 + 0.0 * data), axis=1)
    if name := changed.get("standard_name", ""):
        file.variables["uo"].standard_name = name


def classic(path: Path, **changed: Any) -> str:  # noqa: ANN401
    with netcdf_file(path, "w") as file:
        written(file, **changed)
    return str(path)


def velocity(current: Current, lat: float, lon: float, at: str) -> tuple[float, float]:
    here = FRAME.to_local(LatLon(lat, lon))
    found = current.at(np.array([here.north_m]), np.array([here.east_m]), np.array([posix_s(at)]))
    return float(found[0][0]), float(found[1][0])


def test_a_forecast_is_read_with_its_times_and_at_its_first_depth(tmp_path: Path) -> None:
    current = open_current(classic(tmp_path / "a.nc"), FRAME)
    assert current.times == (EIGHT_S, EIGHT_S + 7200.0, True)
    assert velocity(current, 50.05, -1.25, "2026-06-01T08:30Z") == pytest.approx((0.05, 0.2), abs=1e-4)
    assert velocity(current, 49.9, -1.1, "2026-06-01T12:00Z") == pytest.approx((-0.1, -0.5), abs=1e-4)


def test_longitudes_to_360_and_latitudes_from_the_north_are_the_same_sea(tmp_path: Path) -> None:
    turned = classic(tmp_path / "a.nc", longitude=LON + 360.0, latitude=LAT[::-1], vo=VO[:, ::-1])
    assert velocity(open_current(turned, FRAME), 50.05, -1.25, "2026-06-01T08:30Z") == pytest.approx(
        (0.05, 0.2), abs=1e-4
    )


@pytest.mark.parametrize(
    ("units", "hours"),
    [
        ("seconds since 1970-01-01T00:00:00Z", HOURS * 3600.0 + posix_s("2026-06-01")),
        ("days since 2026-05-31 00:00:00 UTC", HOURS / 24.0 + 1.0),
        ("minutes since 2026-06-01", HOURS * 60.0),
        ("hour since 2026-06-01 00:00:00.0 +00:00", HOURS),
    ],
)
def test_times_may_count_from_any_date_in_any_unit(tmp_path: Path, units: str, hours: Any) -> None:  # noqa: ANN401
    current = open_current(classic(tmp_path / "a.nc", units=units, time=hours), FRAME)
    assert current.times is not None
    assert current.times[:2] == pytest.approx((EIGHT_S, EIGHT_S + 7200.0))


def test_land_is_as_the_nearest_water(tmp_path: Path) -> None:
    uo = UO.copy()
    uo[:, :, 3:] = np.nan
    uo[:, :, 2] = 0.7
    current = open_current(classic(tmp_path / "a.nc", uo=uo), FRAME)
    assert velocity(current, 50.0, -1.05, "2026-06-01T09:00Z")[1] == pytest.approx(0.7)


def test_netcdf_4_is_the_same(tmp_path: Path) -> None:
    library = pytest.importorskip("netCDF4")
    path = tmp_path / "four.nc"
    with library.Dataset(path, "w") as file:
        written(file, standard_name="surface_eastward_sea_water_velocity")
    current = open_current(str(path), FRAME)
    assert velocity(current, 50.05, -1.25, "2026-06-01T08:30Z") == pytest.approx((0.05, 0.2), abs=1e-4)


def test_without_the_library_netcdf_4_says_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(__import__("sys").modules, "netCDF4", None)
    (tmp_path / "four.nc").write_bytes(b"\x89HDF\r\n\x1a\n")
    with pytest.raises(MapError, match=r"four\.nc: .* needs netCDF4, which is not installed: .*\[tide\]"):
        open_current(str(tmp_path / "four.nc"), FRAME)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"units": "fortnights since 2026-06-01"}, "its times are in 'fortnights since 2026-06-01'"),
        ({"units": "hours since spring"}, "since spring"),
        ({"latitude": LAT + 5.0}, r"it ends at latitude 54\.8 to 55\.2, far from 50"),
        ({"longitude": LON + 90.0}, "it ends at longitude"),
        ({"uo": np.nan * UO}, "there is no water round the chart"),
        ({"time": HOURS[::-1]}, "time_s: expected a row of rising numbers"),
    ],
)
def test_a_file_that_cannot_be_used_says_why(tmp_path: Path, changed: dict[str, Any], message: str) -> None:
    with pytest.raises(MapError, match=message):
        open_current(classic(tmp_path / "a.nc", **changed), FRAME)


def test_other_files_are_refused_in_a_line(tmp_path: Path) -> None:
    with netcdf_file(tmp_path / "empty.nc", "w") as file:
        file.createDimension("x", 1)
    with pytest.raises(MapError, match="no eastward_sea_water_velocity"):
        open_current(str(tmp_path / "empty.nc"), FRAME)
    (tmp_path / "cut.nc").write_bytes(b"CDF\x01")
    with pytest.raises(MapError, match=r"cut\.nc: "):
        open_current(str(tmp_path / "cut.nc"), FRAME)
    with pytest.raises(MapError, match=r"gone\.nc: cannot be read"):
        open_current(str(tmp_path / "gone.nc"), FRAME)
    with pytest.raises(UsageError, match=r"GRIB is not read; first: cdo -f nc copy a\.grb2 a\.nc"):
        open_current("a.grb2", FRAME)
