"""Files with numbers that fit no field, or with more in them than any boat holds: one line, and soon."""

import json
import math
import re
from pathlib import Path
from typing import Any

import pytest

from companion.core.geo import LatLon
from mission_tools.cli import plan_command
from mission_tools.errors import MapError, PlanFileError
from mission_tools.geojson import collection, feature
from mission_tools.maps.geojson import parse_geojson
from mission_tools.mission.mission import MOST_ITEMS, Command, Mission, MissionItem
from mission_tools.mission.plan_file import parse_mission
from mission_tools.mission.qgc_plan import compose

pytestmark = pytest.mark.slow

HUGE = ("1e308", "-1e308", "1e39", "4e9")
PLAN = json.loads(compose(Mission((MissionItem.at(LatLon(49.9992, -1.2012)),), LatLon(49.9991, -1.2011))))
PLAN["geoFence"] = {
    "version": 2,
    "polygons": [{"polygon": [[49.998, -1.204], [49.998, -1.195], [50.003, -1.195]], "inclusion": True}],
    "circles": [{"circle": {"center": [50.001, -1.2], "radius": 5.5}, "inclusion": False}],
    "breachReturn": [49.9991, -1.2013, 3.5],
}
PLAN["rallyPoints"]["points"] = [[49.9991, -1.2014, 4.5]]
HOME, ROW = "0 1 0 16 0 0 0 0 49.9991 -1.2011 0 1", "1 0 3 16 0.5 0 0 0 49.9992 -1.2 1.5 1"
WPL = f"QGC WPL 110\n{HOME}\n{ROW}\n"
CIRCLE = feature("Point", [-1.2, 50.001], kind="exclusion", radius_m=5.5)
AREAS = json.dumps(collection([CIRCLE, feature("Point", [-1.2011, 49.9991], kind="rally")]))
NUMBER = re.compile(r"(?<![\w.])-?\d+\.\d+")


@pytest.mark.parametrize(
    ("name", "text", "options"),
    [
        ("a.plan", json.dumps(PLAN), []),
        ("a.waypoints", WPL, []),
        ("areas.plan", json.dumps(PLAN), ["lake", "--fence", "FILE", "--rally", "FILE"]),
        ("areas.geojson", AREAS, ["lake", "--fence", "FILE", "--rally", "FILE"]),
    ],
)
def test_a_number_that_fits_no_field_is_one_line_wherever_it_stands(
    name: str, text: str, options: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / name
    refused = 0
    for found in NUMBER.finditer(text):
        for value in HUGE:
            path.write_text(text[: found.start()] + value + text[found.end() :], encoding="utf-8")
            given = [str(path) if one == "FILE" else one for one in options or ["FILE"]]
            code = plan_command.run_program([*given, "--out", str(tmp_path / "out.plan"), "--force"])
            said = capsys.readouterr().err
            assert "unexpected" not in said, (value, text[max(found.start() - 30, 0) : found.end()], said)
            assert len(said.splitlines()) == (code != 0), said
            refused += code == 2
    assert refused > len(HUGE)


def test_more_items_than_a_mission_holds_are_refused_by_their_number() -> None:
    rows = "".join(f"{n}\t0\t3\t16\t0\t0\t0\t0\t50\t-1.2\t0\t1\n" for n in range(1, MOST_ITEMS + 2))
    item = {"type": "SimpleItem", "command": 16, "frame": 3, "params": "not looked at"}
    plan = PLAN | {"mission": PLAN["mission"] | {"items": [item] * (MOST_ITEMS + 1)}}
    for text in (WPL.partition("\n")[0] + "\n" + rows, json.dumps(plan)):
        with pytest.raises(PlanFileError, match=r"x: 65536 items: a mission holds 65535 at most"):
            parse_mission(text, "x")


def star(corners: int, step: int) -> dict[str, Any]:
    """A line that crosses itself about corners × (step − 1) times."""
    turns = [2.0 * math.pi * step * n / corners for n in range(corners)] + [0.0]
    ring = [[10.0 + 0.004 * math.cos(turn), 50.0 + 0.004 * math.sin(turn)] for turn in turns]
    return collection([feature("Polygon", [ring])])


def test_a_line_that_crosses_itself_without_end_is_refused_and_a_moderate_one_repaired() -> None:
    with pytest.raises(MapError, match=r"crosses or touches itself at lat .* in more than 1000 places"):
        parse_geojson(star(3001, 1500), "m", "m")
    chart = parse_geojson(star(41, 20), "m", "m")
    assert "repaired" in chart.notes[0]


def test_parameters_that_are_null_or_left_out_are_as_the_vehicle_likes() -> None:
    """As QGroundControl and others write items that use few of the seven."""
    item = {"type": "SimpleItem", "command": 178, "frame": 2, "params": [1, None, -1], "autoContinue": True}
    mission = parse_mission(json.dumps(PLAN | {"mission": PLAN["mission"] | {"items": [item]}}), "x")
    (read,) = mission.items
    assert read.command == Command.DO_CHANGE_SPEED
    assert [math.isnan(value) for value in read.params] == [False, True, False, True]
    place = item | {"command": 16, "frame": 3}
    with pytest.raises(PlanFileError, match="item 1: NAV_WAYPOINT needs a latitude and a longitude"):
        parse_mission(json.dumps(PLAN | {"mission": PLAN["mission"] | {"items": [place]}}), "x")
