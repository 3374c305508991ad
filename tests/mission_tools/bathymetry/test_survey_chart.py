"""`boat-survey chart` from a log on the medium to the folder of files."""

import json
from pathlib import Path

import numpy as np
import pytest
from boat_rig import nav_at
from drawn_maps import collection, feature, ring
from sounded_lake import ORIGIN, bowl, lake, track

from companion.core.geo import LocalFrame, Point, position_to_e7
from companion.core.readings import DepthReading, GnssFix
from companion.log import records as r
from companion.log import samples
from mission_tools.cli.survey import run_program

LAKE = lake(100.0, 80.0)


@pytest.fixture(scope="module")
def given(tmp_path_factory: pytest.TempPathFactory) -> tuple[str, str]:
    """A log of a survey, and the map of its lake."""
    folder = tmp_path_factory.mktemp("survey")
    frame, bottom = LocalFrame(ORIGIN), bowl(LAKE, 51)
    noise = np.random.default_rng(51)
    data = [r.HEADER]
    for n, (east_m, north_m) in enumerate(track(LAKE, 8.0, 1.0, 40.0).tolist()):
        time_s, place = float(n), position_to_e7(frame.to_global(Point(north_m, east_m)))
        depth_m = float(bottom(np.asarray(east_m), np.asarray(north_m))) + noise.normal(0.0, 0.03)
        data += samples.gnss(GnssFix(time_s, ORIGIN, 3, 9, 1.0, unix_time_s=1.79e9 + n))
        data.append(r.POS.pack(1_000_000 * n, *place, 0.0, 0.0, 0.0))
        sounding = DepthReading(time_s, depth_m if n % 50 else None, 15.0, 0.1, quality=0.9)
        data.append(samples.depth(sounding, nav_at(north_m, east_m), frame))
    (folder / "7.bin").write_bytes(b"".join(data))
    shore = ring([(east, north) for east, north in LAKE.water.exterior.coords[:-1]])
    water = collection(feature([shore], kind="water", name="Log lake"))
    (folder / "lake.geojson").write_text(json.dumps(water), encoding="utf-8")
    return str(folder / "7.bin"), str(folder / "lake.geojson")


def test_a_log_becomes_a_chart_and_again(
    given: tuple[str, str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log, water = given
    out = tmp_path / "chart"
    command = ["chart", log, "--map", water, "--out", str(out), "--clearance", "2"]
    assert run_program(command) == 0
    told = capsys.readouterr().out
    assert "no bottom" in told
    names = {"chart.html", "chart.png", "depth.tif", "chart.gpkg", "contours.geojson", "contours.kml"}
    names |= {"gaps.geojson", "lake.geojson", "depth.xyz", "chart.json"}
    assert {path.name for path in out.iterdir()} == names
    figures = json.loads((out / "chart.json").read_text(encoding="utf-8"))
    bottom, (east, north) = bowl(LAKE, 51), np.meshgrid(np.arange(-49.5, 50.0), np.arange(-39.5, 40.0))
    warm = 1465.9 / 1480.0  # speed of sound at the logged 15 °C ÷ the sounder's
    expected = float((warm * bottom(east, north) + 0.1 * (bottom(east, north) > 0.0)).sum())
    assert figures["volume_m3"] == pytest.approx(expected, rel=0.03)
    assert figures["sound_m_s"] == pytest.approx(1465.9, abs=0.1)
    assert f"{figures['volume_m3']:,.0f} m³" in told
    assert run_program([*command, "--lever", "1;2"]) == 2


@pytest.mark.parametrize(
    ("more", "said"),
    [
        (["--lever", "ahead"], "--lever ahead: expected FORWARD,STARBOARD"),
        (["--quality", "2"], "quality"),
        (["--map", "mars"], "mars"),
        (["--out", "."], "--out .: holds other files"),
    ],
)
def test_wrong_input_is_told_in_one_line(
    given: tuple[str, str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    more: list[str],
    said: str,
) -> None:
    log, water = given
    (tmp_path / "thesis.tex").touch()
    monkeypatch.chdir(tmp_path)
    assert run_program(["chart", log, "--map", water, "--out", "new", *more]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert len(error.strip().splitlines()) == 1
