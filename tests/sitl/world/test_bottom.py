"""The emulated bottom: between its shores, from figures, by chance and from a file."""

import sys
from pathlib import Path

import numpy as np
import pytest
import rasterio
from pyproj import Transformer

from companion.core.errors import ConfigError
from companion.core.geo import LatLon, Point
from sitl.scenarios.scenario import load_scenario
from sitl.world.environment.bottom import Bathymetry
from sitl.world.environment.settings import Bottom, Bump, Environment, Stream

LAKE, SEA = load_scenario("lake"), load_scenario("open")


@pytest.fixture(scope="module")
def pond() -> Bathymetry:
    return Bathymetry(LAKE.chart, LAKE.environment)


def test_a_slope_goes_from_the_shore_to_its_depth() -> None:
    bottom, here = Bathymetry(LAKE.chart, Environment(depth_m=3.0, shore_slope=0.1)), LAKE.start
    clearance_m = LAKE.chart.clearance_m(Point(here.north_m, here.east_m))
    assert bottom.depth_m(here.north_m, here.east_m) == pytest.approx(0.1 * clearance_m, abs=0.01)
    assert bottom.depth_m(0.0, 150.0) == pytest.approx(3.0)
    assert bottom.depth_m(here.north_m + 1e5, here.east_m) == 0.0
    assert Bathymetry(SEA.chart, Environment(depth_m=7.0)).depth_m(3.0, -1e4) == 7.0


def test_the_pond_has_two_holes_a_shoal_and_a_stream_and_is_dry_ashore(pond: Bathymetry) -> None:
    assert pond.depth_m(140.0, -165.0) > 4.0
    assert pond.depth_m(85.0, 188.0) > 4.0
    assert 1.2 < pond.depth_m(90.0, -15.0) < 1.9
    assert pond.depth_m(-80.0, -60.0) > pond.depth_m(-115.0, -60.0) + 0.4  # the stream, and beside it
    assert pond.depth_m(-20.0, -60.0) == 0.0  # on Alder Island
    ashore = LAKE.chart.water.boundary.interpolate(np.linspace(0.0, 0.99, 300), normalized=True)
    at = np.array([(point.y, point.x) for point in ashore])
    assert np.abs(pond.depths_m(at[:, 0], at[:, 1])).max() < 0.45  # half a cell and its slope
    again = Bathymetry(LAKE.chart, LAKE.environment)
    spread = np.linspace(-200.0, 200.0, 50)
    depths_m = pond.depths_m(*np.meshgrid(spread, spread))
    np.testing.assert_array_equal(depths_m, again.depths_m(*np.meshgrid(spread, spread)))
    assert depths_m[7, 30] == pytest.approx(pond.depth_m(spread[30], spread[7]), abs=1e-12)


def test_weed_covers_its_share_of_the_water_below_the_surface() -> None:
    bottom = Bathymetry(
        LAKE.chart, Environment(depth_m=2.0, bottom=Bottom(weed_share=0.2, weed_height_m=1.5))
    )
    places = np.random.default_rng(5).uniform(-200.0, 200.0, (4000, 2))
    wet = [(*at, deep) for at in places.tolist() if (deep := bottom.depth_m(*at)) > 0.0]
    weedy = [(bottom.canopy_m(north_m, east_m), deep) for north_m, east_m, deep in wet]
    assert sum(canopy_m > 0.6 for canopy_m, _ in weedy) / len(wet) == pytest.approx(0.2, abs=0.05)
    assert max(canopy_m for canopy_m, _ in weedy) == pytest.approx(1.2, abs=0.01)  # of 2 m
    assert Bathymetry(SEA.chart, Environment()).canopy_m(0.0, 0.0) == 0.0


def test_bumps_and_a_stream_have_the_profile_of_a_gaussian() -> None:
    relief = Bottom(
        kind="analytic",
        bumps=(Bump(centre=(100.0, 50.0), deeper_m=-2.0, radius_m=10.0),),
        stream=Stream(through=((-300.0, -100.0), (300.0, -100.0)), deeper_m=1.0, width_m=20.0),
    )
    bottom = Bathymetry(SEA.chart, Environment(depth_m=4.0, bottom=relief))
    assert bottom.depth_m(50.0, 100.0) == pytest.approx(2.0)
    assert bottom.depth_m(50.0, 110.0) == pytest.approx(4.0 - 2.0 * np.exp(-0.5))
    assert bottom.depth_m(-100.0, 33.0) == pytest.approx(5.0)
    assert bottom.depth_m(-110.0, 33.0) == pytest.approx(4.0 + np.exp(-0.5))


@pytest.mark.parametrize("hurst", [0.4, 0.9])
def test_roughness_has_its_deviation_and_the_spectrum_of_its_exponent(hurst: float) -> None:
    relief = Bottom(kind="fractal", roughness_m=0.25, hurst=hurst, longest_m=400.0, seed=8)
    bottom = Bathymetry(SEA.chart, Environment(depth_m=6.0, bottom=relief))
    at = np.arange(-480.0, 480.0)
    depths_m = bottom.depths_m(*np.meshgrid(at, at))
    assert depths_m.mean() == pytest.approx(6.0, abs=0.1)
    assert depths_m.std() == pytest.approx(0.25, rel=0.15)
    # The spectrum of a straight line over it falls as k^(−2 H − 1)
    power = np.mean(np.abs(np.fft.rfft((depths_m - 6.0) * np.hanning(len(at)), axis=1)) ** 2, axis=0)
    numbers = np.arange(10, 120)
    falls, _ = np.polyfit(np.log(numbers), np.log(power[numbers]), 1)
    assert falls == pytest.approx(-2.0 * hurst - 1.0, abs=0.15)
    other = Bathymetry(SEA.chart, Environment(bottom=Bottom(kind="fractal", seed=9)))
    assert other.depth_m(0.0, 0.0) != bottom.depth_m(0.0, 0.0)


def written(path: Path, crs: str | None, west: float, north: float, cell: float = 2.0) -> str:
    """A GeoTIFF of 200 × 200 cells that is 1 m deep in its west and deeper by 1 cm a metre, with a gap."""
    middles = west + cell * (np.arange(200) + 0.5)
    depths = np.broadcast_to(1.0 + 0.01 * (middles - west), (200, 200)).astype(np.float32).copy()
    depths[:20] = np.nan
    place = rasterio.Affine(cell, 0.0, west, 0.0, -cell, north)
    with rasterio.open(
        path, "w", driver="GTiff", width=200, height=200, count=1, dtype="float32", crs=crs, transform=place,
        nodata=np.nan,
    ) as file:  # fmt: skip
        file.write(depths, 1)
    return str(path)


@pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")
def test_a_geotiff_lies_in_the_frame_or_where_its_epsg_code_says(tmp_path: Path) -> None:
    local = Environment(bottom=Bottom(kind="geotiff", file=written(tmp_path / "a.tif", None, -200.0, 200.0)))
    bottom = Bathymetry(SEA.chart, local)
    assert bottom.depth_m(10.0, 0.0) == pytest.approx(3.0, abs=0.01)
    assert bottom.depth_m(10.0, 90.5) == pytest.approx(3.905, abs=0.01)
    assert bottom.depth_m(190.0, 0.0) == bottom.depth_m(0.0, 400.0) == 5.0  # the gap, and beyond the file
    to_utm = Transformer.from_crs("EPSG:4326", "EPSG:32630", always_xy=True)
    origin = SEA.chart.frame.origin
    x_m, y_m = to_utm.transform(origin.lon_deg, origin.lat_deg)
    utm = Environment(
        bottom=Bottom(
            kind="geotiff", file=written(tmp_path / "u.tif", "EPSG:32630", x_m - 200.0, y_m + 200.0)
        )
    )
    bottom = Bathymetry(SEA.chart, utm)
    for north_m, east_m in ((0.0, 0.0), (-150.0, 120.0), (120.0, -140.0)):
        place: LatLon = SEA.chart.frame.to_global(Point(north_m, east_m))
        there_m, _ = to_utm.transform(place.lon_deg, place.lat_deg)
        assert bottom.depth_m(north_m, east_m) == pytest.approx(
            1.0 + 0.01 * (there_m - x_m + 200.0), abs=0.01
        )


def test_a_file_that_is_no_bottom_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    far = written(tmp_path / "far.tif", "EPSG:32630", 100_000.0, 100_000.0)
    (tmp_path / "text.tif").write_text("no picture")
    for name, said in (
        ("text.tif", "cannot be read as a GeoTIFF of depths"),
        (far, "no depth in this water"),
    ):
        scenario = tmp_path / "water.toml"
        scenario.write_text(
            '[origin]\nlat_deg = 50.0\nlon_deg = -1.2\n[environment.bottom]\nkind = "geotiff"\n'
            f'file = "{name}"\n'
        )
        loaded = load_scenario(str(scenario))
        with pytest.raises(ConfigError, match=f"{tmp_path}.*{said}"):
            Bathymetry(loaded.chart, loaded.environment)
    monkeypatch.setitem(sys.modules, "rasterio", None)
    with pytest.raises(ConfigError, match="needs the extra 'survey'"):
        Bathymetry(loaded.chart, loaded.environment)
    with pytest.raises(ConfigError, match="expected a GeoTIFF with kind = 'geotiff'"):
        load_scenario("open", ["environment.bottom.kind=geotiff"])
