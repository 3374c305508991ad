"""Each file is read back by a program that did not come from here: GDAL, expat, numpy, Pillow."""

import json
import re
import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyogrio
import pyproj
import pytest
import rasterio
import shapely
from charted_lake import BOTTOM, HOLE, LAKE, charted_lake, survey
from PIL import Image
from sounded_lake import ORIGIN

from companion.core.geo import LocalFrame, Point
from mission_tools.bathymetry.chart_page import chart_page
from mission_tools.bathymetry.picture import draw_depths
from mission_tools.bathymetry.products import contour_levels, write_products
from mission_tools.drawing.draw import save_figure
from mission_tools.maps import load_source
from mission_tools.maps.passable import BoatSize, passable

CHART = charted_lake()
TO_LOCAL = pyproj.Transformer.from_crs(
    "EPSG:4326", f"+proj=tmerc +lat_0={ORIGIN.lat_deg} +lon_0={ORIGIN.lon_deg} +ellps=WGS84", always_xy=True
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("chart")
    figures = write_products(CHART, path)
    picture = draw_depths(CHART)
    save_figure(path / "chart.png", picture)
    (path / "chart.html").write_text(chart_page(CHART, figures, picture), encoding="utf-8")
    return path


def features(path: Path, layer: str | None = None) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    meta, _, shapes, values = pyogrio.raw.read(path, layer=layer)
    assert pyproj.CRS(meta["crs"]).to_epsg() == 4326
    return shapely.from_wkb(shapes), dict(zip(meta["fields"], values, strict=True))


def test_grid_has_the_true_depth_at_its_place_on_earth(folder: Path) -> None:
    with rasterio.open(folder / "depth.tif") as file:
        assert (file.count, file.dtypes[0], file.units) == (2, "float32", ("metre", "metre"))
        assert np.isnan(file.nodata)
        place = LocalFrame(ORIGIN).to_global(Point(20.0, 30.0))
        to_file = pyproj.Transformer.from_crs("EPSG:4326", pyproj.CRS(file.crs.to_wkt()), always_xy=True)
        hole = LocalFrame(ORIGIN).to_global(Point(HOLE[1], HOLE[0]))
        at = [to_file.transform(one.lon_deg, one.lat_deg) for one in (place, hole)]
        (depth, band), (unknown, _) = file.sample(at)
        assert depth == pytest.approx(float(BOTTOM(np.asarray(30.0), np.asarray(20.0))), abs=0.15)
        assert 0.0 < band < 0.1
        assert np.isnan(unknown)


def test_geopackage_holds_every_sounding_with_its_reason_and_the_areas(folder: Path) -> None:
    path = folder / "chart.gpkg"
    names = {name for name, _ in pyogrio.list_layers(path)}
    assert names == {"soundings", "contours", "gaps", "not_surveyed"}
    points, values = features(path, "soundings")
    s = survey()
    assert len(points) == len(s.depth_m)
    assert shapely.get_x(points)[5001] == pytest.approx(s.lon_deg[5001], abs=2e-7)
    assert (values["reason"] == "multiple echo").sum() == 10
    assert values["depth_m"][5001] == pytest.approx(CHART.at.depth_m[5001])
    gaps, areas = features(path, "gaps")
    assert areas["area_m2"] == pytest.approx([CHART.gaps.area], abs=0.1)
    assert len(gaps) == 1


def test_contours_run_where_the_bottom_has_their_depth(folder: Path) -> None:
    lines, values = features(folder / "contours.geojson")
    at, line = shapely.get_coordinates(lines, return_index=True)
    east, north = TO_LOCAL.transform(*at.T)
    assert np.abs(BOTTOM(east, north) - values["depth_m"][line]).max() < 0.15
    assert set(values["depth_m"]) == set(contour_levels(float(np.nanmax(CHART.surface.depth_m))).tolist())
    tree = ET.parse(folder / "contours.kml")  # noqa: S314 - written a line before
    kml = {"k": "http://www.opengis.net/kml/2.2"}
    marks = tree.findall(".//k:Placemark", kml)
    assert len(marks) == len(lines)
    assert marks[0].findtext("k:name", namespaces=kml) == values["name"][0]
    lon, lat = map(
        float, (marks[0].findtext(".//k:coordinates", namespaces=kml) or "").split()[0].split(",")[:2]
    )
    assert (lon, lat) == pytest.approx(tuple(shapely.get_coordinates(lines[0])[0]), abs=1e-6)


def test_gaps_are_geojson_polygons_that_hold_the_hole(folder: Path) -> None:
    tree = json.loads((folder / "gaps.geojson").read_text(encoding="utf-8"))
    hole = LocalFrame(ORIGIN).to_global(Point(HOLE[1], HOLE[0]))
    shapes = [shapely.from_geojson(json.dumps(one["geometry"])) for one in tree["features"]]
    assert [shape.geom_type for shape in shapes] == ["Polygon"]
    assert shapes[0].contains(shapely.Point(hole.lon_deg, hole.lat_deg))


def test_text_has_a_row_for_each_surveyed_cell_and_figures_are_read(folder: Path) -> None:
    table = np.loadtxt(folder / "depth.xyz")
    assert table.shape == (np.isfinite(CHART.surface.depth_m).sum(), 4)
    east, north = TO_LOCAL.transform(table[:, 0], table[:, 1])
    assert np.mean(np.abs(table[:, 2] - BOTTOM(east, north)) <= table[:, 3]) > 0.8
    figures = json.loads((folder / "chart.json").read_text(encoding="utf-8"))
    assert figures["generator"] == "mavboat"
    assert figures["name"] == LAKE.name


def test_picture_is_blue_where_it_is_deep_and_the_page_holds_everything(folder: Path) -> None:
    with Image.open(folder / "chart.png") as picture:
        assert picture.size == (1600, 1200)
        pixels = np.asarray(picture.convert("RGB"), dtype=float)
    blue = (pixels[..., 2] > pixels[..., 0] + 40.0).mean()
    assert 0.15 < blue < 0.7
    page = (folder / "chart.html").read_text(encoding="utf-8")
    assert not re.search(r'(?:src|href)="(?!data:)', page)
    assert page.count("<img") == 4
    for text in ("multiple echo", "S-44 order", "Test lake", "width=device-width"):
        assert text in page


def test_page_tells_how_far_soundings_are_off_the_plan_of_the_log(folder: Path) -> None:
    """The plan is one line from west to east through the origin."""
    ends = [CHART.chart.frame.to_global(Point(0.0, east_m)) for east_m in (-500.0, 500.0)]
    plan = np.array([(end.lat_deg, end.lon_deg) for end in ends])
    planned = replace(CHART, soundings=replace(CHART.soundings, plans=(np.empty((0, 2)), plan)))
    page = chart_page(planned, CHART.figures(), draw_depths(CHART))
    off_m = np.sqrt(np.mean(CHART.at.north_m[CHART.accepted] ** 2))
    assert f"{off_m:.2f} m RMS off the plan" in page
    assert "Plan and track" not in (folder / "chart.html").read_text(encoding="utf-8")


@pytest.mark.parametrize(("deepest_m", "first", "count"), [(1.2, 0.1, 11), (5.0, 0.5, 9), (30.0, 5.0, 5)])
def test_contours_are_at_round_depths(deepest_m: float, first: float, count: int) -> None:
    levels = contour_levels(deepest_m)
    assert (levels[0], len(levels)) == (pytest.approx(first), count)


def test_the_planner_keeps_out_of_what_is_charted_less_deep_than_its_draught(folder: Path) -> None:
    """By the true bottom on a grid of places; what the hole left unsurveyed has no depth, so it stays."""
    features(folder / "lake.geojson")  # GDAL reads it, too
    lake = load_source(str(folder / "lake.geojson")).chart
    assert lake.water.area == pytest.approx(LAKE.water.area, rel=1e-3)
    deep = passable(lake, BoatSize(draught_m=1.0)).navigable
    shapely.prepare(deep)
    west, south, east, north = LAKE.water.bounds
    x, y = (one.ravel() for one in np.meshgrid(np.arange(west, east, 3.0), np.arange(south, north, 3.0)))
    charted = shapely.contains_xy(LAKE.water.buffer(-4.0).difference(shapely.Point(HOLE).buffer(15.0)), x, y)
    x, y = x[charted], y[charted]
    depth_m, is_open = BOTTOM(x, y), shapely.contains_xy(deep, x, y)
    assert is_open[depth_m < 0.97].mean() < 0.02  # what no line came near has no depth
    assert is_open[depth_m > 1.25].mean() > 0.99
