"""What is on board: compared before an upload, downloaded to a file, and checked against a map."""

import json
from pathlib import Path

import pytest
from fake_vehicle import FRAME, FakeVehicle, fake_vehicle, link

from companion.core.geo import Point
from mission_tools.cli.download import run_program as run_download
from mission_tools.cli.upload import run_program as run_upload
from mission_tools.mission.mission import Fence, FencePolygon, Mission, MissionItem, Rally
from mission_tools.mission.plan_file import load_mission, save_mission

pytestmark = pytest.mark.realtime

CORNERS = tuple(FRAME.to_global(point) for point in (Point(-50, -50), Point(250, -50), Point(250, 90)))


def mission(*points: Point) -> Mission:
    home, *items = (MissionItem.at(FRAME.to_global(point)) for point in points)
    return Mission(
        tuple(items), home.place, fence=Fence((FencePolygon(CORNERS),)), rally=(Rally(CORNERS[0]),)
    )


@pytest.fixture
def plan(tmp_path: Path) -> str:
    """Three waypoints, a fence and a rally point."""
    save_mission(mission(Point(0, 0), Point(30, 0), Point(60, 10), Point(90, 0)), tmp_path / "a.plan")
    return str(tmp_path / "a.plan")


def transfers(vehicle: FakeVehicle) -> int:
    return sum(message.get_type() == "MISSION_COUNT" for _, _, message in vehicle.heard)


def test_an_upload_is_left_out_where_nothing_changes(
    plan: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with fake_vehicle() as vehicle:
        assert run_upload([plan, *link(vehicle), "--if-changed"]) == 0
        assert transfers(vehicle) == 3
        said = capsys.readouterr().out
        assert "mission: none on board, 4 items to upload" in said
        assert "uploaded 8 items" in said
        assert run_upload([plan, *link(vehicle), "--if-changed", "--json"]) == 0
        assert transfers(vehicle) == 3
        told = capsys.readouterr()
        assert "nothing uploaded: vehicle 1" in told.err
        assert json.loads(told.out)["upload"]["changed"] == []
        assert json.loads(told.out)["upload"]["read_back_equal"] is True
        save_mission(mission(Point(0, 0), Point(30, 0), Point(60, 30), Point(90, 0)), tmp_path / "b.plan")
        assert run_upload([str(tmp_path / "b.plan"), *link(vehicle), "--if-changed"]) == 0
        assert transfers(vehicle) == 4  # the mission alone
    said = capsys.readouterr().out
    assert "  item 2: NAV_WAYPOINT moved by 20.0 m to " in said
    assert "fence: the same as on board, 3 items" in said
    assert "uploaded 4 items" in said


def test_what_is_on_board_is_saved(plan: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    copy = tmp_path / "copy.plan"
    with fake_vehicle() as vehicle:
        assert run_upload([plan, *link(vehicle)]) == 0
        assert run_download([str(copy), *link(vehicle)]) == 0
    sent, saved = load_mission(Path(plan)), load_mission(copy)
    assert saved.items == sent.items
    assert saved.wire_lists(home_first=True) == sent.wire_lists(home_first=True)
    assert "3 items, 1 fence area, 1 rally point" in capsys.readouterr().out
