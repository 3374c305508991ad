"""What a person gets to see of a plan on the first day: messages, notes and pictures."""

import json
from pathlib import Path

import pytest

from companion.config.boat_config import BoatConfig
from companion.core.geo import LatLon
from mission_tools.cli.plan import run_program as run_plan
from mission_tools.drawing.preview import figure_of
from mission_tools.job.planned import MOST_ITEMS
from mission_tools.mission.mission import Mission, MissionItem
from mission_tools.mission.plan_file import save_mission
from mission_tools.water_map import open_map

SOUTH_WEST, SOUTH_EAST = "50.0002,-1.1998", "50.0002,-1.1982"
NORTH_WEST, NORTH_EAST = "50.0018,-1.1998", "50.0018,-1.1982"
SHORE = [[-1.2, 50.0], [-1.198, 50.0], [-1.198, 50.002], [-1.2, 50.002], [-1.2, 50.0]]


@pytest.fixture
def pond(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A pond of 143 × 222 m in the working folder."""
    (tmp_path / "pond.geojson").write_text(json.dumps({"type": "Polygon", "coordinates": [SHORE]}))
    monkeypatch.chdir(tmp_path)


def test_more_items_than_the_boat_holds_are_told_before_an_upload(
    pond: None, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("small.toml").write_text("[mission]\nmax_items = 3\n")
    route = ["pond.geojson", "--start", SOUTH_WEST, "--clearance", "3", "--one-way", "--boat", "small.toml"]
    vias = ["--via", SOUTH_EAST, "--via", NORTH_EAST]
    assert run_plan([*route, *vias[:2], "--goal", SOUTH_EAST]) in (0, 1)
    assert "mission items" not in capsys.readouterr().err
    assert run_plan([*route, *vias, "--goal", NORTH_WEST, "--out", "none.plan"]) == 2
    assert (
        "4 mission items, home included, are more than the 3 that the boat holds" in capsys.readouterr().err
    )
    assert not Path("none.plan").exists()


def test_more_items_than_a_boat_holds_unless_set_up_for_more_are_noted(
    pond: None, capsys: pytest.CaptureFixture[str]
) -> None:
    assert BoatConfig().mission.max_items == MOST_ITEMS
    at = LatLon(50.0, -1.2)
    for count, is_noted in ((MOST_ITEMS - 1, False), (MOST_ITEMS, True)):
        save_mission(Mission((MissionItem.at(at),) * count, at), Path("long.waypoints"))
        assert run_plan(["long.waypoints"]) == 0
        assert ("mission items, home included, are more than" in capsys.readouterr().out) is is_noted


def test_a_survey_is_drawn_with_its_coverage_also_for_a_notebook(pond: None) -> None:
    planned = open_map("pond.geojson").survey(spacing_m=20.0, clearance_m=3.0).planned
    (axes,) = figure_of(planned).axes
    legend = axes.get_legend()
    assert legend is not None
    named = {text.get_text() for text in legend.get_texts()}
    assert {"planned: tracks", "planned: along the shore", "covered", "missed"} <= named
    shown = {text.get_text() for text in axes.texts}
    assert {"Start", "Goal"} <= shown
    assert not any(text.isdigit() for text in shown)  # no waypoint has a number


def test_a_folder_for_a_map_and_a_draught_without_depths_are_told(
    pond: None, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("maps").mkdir()
    assert run_plan(["maps"]) == 2
    assert "maps: a folder: expected a map or scenario file in it" in capsys.readouterr().err
    route = ["pond.geojson", "--start", SOUTH_WEST, "--goal", NORTH_EAST, "--draught", "0.4"]
    assert run_plan(route) == 0
    assert (
        "the map has no depths (depth_m): a draught of 0.4 m makes no difference" in capsys.readouterr().out
    )
