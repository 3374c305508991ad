"""mission-plan on finished missions: routes of other programs, checks on a map, items, and short charge."""

import json
from pathlib import Path
from typing import Any

import pytest

from mission_tools.cli.plan import run_program

ACROSS = '<gpx><rte><rtept lat="49.9987" lon="-1.2026"/><rtept lat="50.0005" lon="-1.2"/></rte></gpx>'


def run(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, dict[str, Any]]:
    """The exit code and the report."""
    code = run_program([*arguments, "--json"])
    return code, json.loads(capsys.readouterr().out)


@pytest.fixture
def across(tmp_path: Path) -> str:
    """A route across an island of the mill pond."""
    path = tmp_path / "across.gpx"
    path.write_text(ACROSS, encoding="utf-8")
    return str(path)


def test_a_drawn_route_is_checked_on_a_map_and_costed(
    across: str, capsys: pytest.CaptureFixture[str]
) -> None:
    start = ("--start-at", "49.99865,-1.2027")
    code, report = run(capsys, across, "--as-route", "--check-on", "lake", "--boat", "lake", *start)
    assert code == 0
    assert report["home"] == [49.99865, -1.2027]
    assert report["file"]["length_m"] == pytest.approx(282.6, abs=0.5)
    assert report["file"]["min_clearance_m"] == 0.0
    assert [note for note in report["notes"] if "Alder Island is in the way" in note]
    assert report["budget"]["suffices"] is True
    assert report["budget"]["capacity_mah"] == 5000.0


def test_without_a_map_only_the_mission_itself_is_checked(
    across: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(capsys, across, "--as-route", "--check-on", "none")[1]["notes"] == []
    far = tmp_path / "far.geojson"
    ring = [[2.0, 50.0], [2.01, 50.0], [2.01, 50.01], [2.0, 50.0]]
    far.write_text(json.dumps({"type": "Polygon", "coordinates": [ring]}), encoding="utf-8")
    _, report = run(capsys, across, "--as-route", "--check-on", str(far))
    assert "nowhere near" in report["notes"][0]


def test_a_drawn_route_is_a_map_unless_it_is_said_to_be_a_route(
    across: str, capsys: pytest.CaptureFixture[str]
) -> None:
    code, report = run(capsys, across, "--goal", "50,-1.2")
    assert (code, report["ok"]) == (2, False)
    code, report = run(capsys, "lake", "--check-on", "lake")
    assert code == 2
    assert "--check-on: only for a finished mission" in report["error"]
    code, report = run(capsys, across, "--as-route", "--goal", "50,-1.2")
    assert code == 2
    assert "is a mission already" in report["error"]


def test_items_are_as_on_the_wire(across: str, capsys: pytest.CaptureFixture[str]) -> None:
    _, report = run(capsys, across, "--as-route", "--items", "--speed", "1.5")
    home, speed, first, last = report["items"]["mission"]
    assert speed == [2, 178, 1, 1.0, 1.5, -1.0, 0.0, 0, 0, 0.0]
    assert first == [3, 16, 1, 0.0, 0.0, 0.0, 0.0, 499987000, -12026000, 0.0]
    assert last[7:9] == [500005000, -12000000]
    assert home[7:9] == first[7:9]
    assert "items" not in run(capsys, across, "--as-route")[1]
