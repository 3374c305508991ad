"""Photographs traced: a real pond against its mask, and made pictures whose water is known to the pixel."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
import shapely
from data_files import SHORES
from numpy.typing import NDArray
from PIL import Image
from shapely.geometry.base import BaseGeometry

from companion.core.geo import LatLon
from mission_tools.cli import trace_command
from mission_tools.errors import MapError
from mission_tools.maps import load_map
from mission_tools.maps.geojson import load_geojson
from mission_tools.tracing.photo import TraceSettings, trace_photo
from mission_tools.tracing.region import lab_of

pytestmark = pytest.mark.slow

PHOTO = SHORES / "mask_citra_pond_fl_photo.jpg"
GAP_M2 = 420.0  # the mosaic's gap and the fountain's glint, which the mask has as water

Picture = NDArray[np.uint8]


def shore_distances_m(traced: BaseGeometry, mask: BaseGeometry) -> NDArray[np.float64]:
    """From points every half metre on one outline to the other outline."""
    line = shapely.segmentize(traced.boundary, 0.5)
    return np.asarray(shapely.distance(shapely.points(shapely.get_coordinates(line)), mask.boundary))


def test_the_photograph_of_a_real_pond_gives_its_mask() -> None:
    traced = trace_photo(PHOTO, [LatLon(29.40747, -82.16999)], settings=TraceSettings(fill_m2=GAP_M2)).chart()
    mask = load_geojson(SHORES / "pond_citra_fl.geojson", traced.frame.origin)
    both, either = (
        shapely.intersection(traced.water, mask.water).area,
        shapely.union(traced.water, mask.water).area,
    )
    assert both / either > 0.97
    away_m = shore_distances_m(traced.water, mask.water)
    assert float(np.mean(away_m)) < 0.6
    assert float(np.quantile(away_m, 0.9)) < 1.5


GREEN, BROWN, GREY = (90, 150, 70), (150, 120, 80), (160, 160, 165)


def made(water: NDArray[np.bool_], seed: int = 1) -> Picture:
    """Noisy water of one colour on brown land with grey patches."""
    random = np.random.default_rng(seed)
    picture = np.where(water[..., None], GREEN, BROWN).astype(np.float64)
    picture[:20] = GREY
    return np.clip(picture + random.normal(0.0, 6.0, picture.shape), 0, 255).astype(np.uint8)


def disc(columns: int, rows: int, column: float, row: float, radius: float) -> NDArray[np.bool_]:
    y, x = np.mgrid[:rows, :columns]
    found: NDArray[np.bool_] = (x + 0.5 - column) ** 2 + (y + 0.5 - row) ** 2 <= radius**2
    return found


def photograph(path: Path, picture: Picture) -> Path:
    Image.fromarray(picture).save(path)
    path.with_suffix(".wld").write_text("1e-5\n0\n0\n-1e-5\n10.0\n0.0\n")
    return path


def place(column: float, row: float) -> LatLon:
    """Of a pixel corner, by the world file: its numbers are for the middle of pixel (0, 0)."""
    return LatLon(-1e-5 * (row - 0.5), 10.0 + 1e-5 * (column - 0.5))


def test_a_round_pond_is_traced_to_a_pixel_and_drawn_into_the_water(tmp_path: Path) -> None:
    water = disc(200, 160, 100, 90, 50) & ~disc(200, 160, 110, 90, 8)
    traced = trace_photo(photograph(tmp_path / "p.png", made(water)), [place(80, 90)])
    assert traced.outline.area == pytest.approx(math.pi * (49**2 - 9**2), rel=0.02)
    assert traced.pixel_m == pytest.approx(1.113, abs=0.01)
    (pond,) = traced.shape.geoms
    middle = pond.centroid
    assert (middle.x, middle.y) == pytest.approx((10.0 + 99.15e-5, -89.5e-5), abs=2e-6)
    assert len(pond.interiors) == 1
    assert any(note.startswith("holes in the water are taken as land (2") for note in traced.notes)
    filled = trace_photo(tmp_path / "p.png", [place(80, 90)], settings=TraceSettings(fill_m2=300.0))
    assert filled.outline.area == pytest.approx(math.pi * 49**2, rel=0.02)


def test_a_second_pond_and_a_path_of_the_same_colour_are_left_out(tmp_path: Path) -> None:
    water = disc(200, 160, 60, 90, 40) | disc(200, 160, 160, 90, 25)
    water[89:91, 95:140] = True  # two pixels wide
    path = photograph(tmp_path / "p.png", made(water))
    assert trace_photo(path, [place(60, 90)]).outline.area == pytest.approx(math.pi * 39**2, rel=0.03)
    both = trace_photo(path, [place(60, 90), place(160, 90)])
    assert both.outline.area == pytest.approx(math.pi * (39**2 + 24**2), rel=0.03)


def test_land_of_a_like_colour_is_left_out_where_it_is_named(tmp_path: Path) -> None:
    picture = made(disc(200, 160, 60, 90, 40))
    lawn = np.zeros((160, 200), bool)
    lawn[60:130, 96:190] = True
    picture[lawn] = (104, 156, 66)
    path = photograph(tmp_path / "p.png", picture)
    wide = trace_photo(path, [place(60, 90)]).outline.area
    named = trace_photo(path, [place(60, 90)], [place(150, 90)]).outline.area
    assert wide > 1.5 * math.pi * 39**2
    assert named == pytest.approx(math.pi * 39**2, rel=0.05)


def test_a_large_photograph_is_reduced_and_says_its_pixels(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("mission_tools.tracing.photo.MOST_PIXELS", 9000)
    traced = trace_photo(photograph(tmp_path / "p.png", made(disc(200, 160, 100, 90, 50))), [place(100, 90)])
    assert traced.pixel_m == pytest.approx(2 * 1.113, abs=0.02)
    assert traced.chart().water.area == pytest.approx(math.pi * (48 * 1.113) ** 2, rel=0.05)


@pytest.mark.parametrize(
    ("seeds", "said"),
    [
        ([], "name at least one place"),
        ([place(300, 10)], r"is outside of the photograph"),
        ([LatLon(50, 8)], "outside"),
    ],
)
def test_seeds_that_cannot_be_used_are_named(seeds: list[LatLon], said: str, tmp_path: Path) -> None:
    with pytest.raises(MapError, match=said):
        trace_photo(photograph(tmp_path / "p.png", made(disc(200, 160, 100, 90, 50))), seeds)


def test_the_program_writes_a_map_that_can_be_planned_on_and_never_over_another(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = photograph(tmp_path / "p.png", made(disc(200, 160, 100, 90, 50)))
    out, preview = tmp_path / "p.geojson", tmp_path / "traced.png"
    at = place(100, 90)
    arguments = [str(path), "--seed", f"{at.lat_deg:.7f},{at.lon_deg:.7f}", "--out", str(out)]
    assert trace_command.run_program([*arguments, "--preview", str(preview)]) == 0
    assert "m² of water\n" in capsys.readouterr().out
    chart = load_map(out)
    assert chart.is_clear(chart.frame.to_local(place(70, 90)), chart.frame.to_local(place(130, 90)), 10.0)
    with Image.open(preview) as drawn:
        assert drawn.size == (200, 160)
    before = out.read_bytes()
    assert trace_command.run_program(arguments) == 2
    assert "exists, and does not say that this program wrote it" in capsys.readouterr().err
    assert out.read_bytes() == before
    assert json.loads(before)["features"][0]["properties"]["kind"] == "water"


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["p.png"], "no --seed"),
        (["p.png", "--seed", "x"], "--seed 'x': expected LAT,LON"),
        (["p.png", "--seed", "1,2", "--out", "p.kml"], "--out p.kml: expected a name that ends in .geojson"),
        (
            ["p.png", "--seed", "1,2", "--preview", "p.txt"],
            "--preview p.txt: expected a name that ends in .png",
        ),
        (["nowhere.png", "--seed", "1,2"], "nowhere.png: cannot be read: No such file"),
    ],
)
def test_wrong_arguments_are_one_line(
    arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert trace_command.run_program(arguments) == 2
    assert said in capsys.readouterr().err


@pytest.mark.parametrize(
    ("rgb", "lab"),
    [
        ((255, 255, 255), (100.0, 0.0, 0.0)),
        ((0, 0, 0), (0.0, 0.0, 0.0)),
        ((255, 0, 0), (53.24, 80.09, 67.20)),
        ((0, 255, 0), (87.73, -86.18, 83.18)),
        ((0, 0, 255), (32.30, 79.19, -107.86)),
    ],
)
def test_colours_have_the_published_lab_values(
    rgb: tuple[int, int, int], lab: tuple[float, float, float]
) -> None:
    """Bruce Lindbloom's tables for sRGB, D65."""
    found = lab_of(np.array([[rgb]], np.uint8))[0, 0]
    assert found.tolist() == pytest.approx(lab, abs=0.02)
