"""Mission files: what is written reads back equal, and what cannot be used is named."""

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from companion.core.geo import LatLon
from companion.core.units import e7_to_deg
from mission_tools.errors import PlanFileError
from mission_tools.mission import qgc_plan, wpl_text
from mission_tools.mission.mission import (
    Command,
    Fence,
    FenceCircle,
    FencePolygon,
    Frame,
    Mission,
    MissionItem,
    MissionType,
    Rally,
)
from mission_tools.mission.plan_file import load_mission, parse_mission, save_mission
from mission_tools.mission.wire import differences

numbers = st.floats(-1e6, 1e6) | st.just(math.nan)
finite = st.floats(-1e6, 1e6)
places = st.builds(
    lambda x, y: LatLon(e7_to_deg(x), e7_to_deg(y)),
    st.integers(-900_000_000, 900_000_000),
    st.integers(-1_800_000_000, 1_800_000_000),
)
known_homes = places.filter(lambda place: place != LatLon(0.0, 0.0))
waypoints = st.builds(
    lambda place, params, z, frame: MissionItem.at(place, Command.NAV_WAYPOINT, params, frame=frame, z=z),
    places,
    st.tuples(numbers, numbers, numbers, numbers),
    finite,
    st.sampled_from([Frame.GLOBAL, Frame.GLOBAL_RELATIVE_ALT, Frame.GLOBAL_RELATIVE_ALT_INT]),
)
commands = st.builds(
    MissionItem,
    st.integers(200, 400),
    st.just(Frame.MISSION),
    st.tuples(numbers, numbers, numbers, numbers),
    st.integers(-(2**31), 2**31 - 1),
    st.integers(-(2**31), 2**31 - 1),
    finite,
    st.booleans(),
)
items = st.lists(waypoints | commands, max_size=20).map(tuple)
radii = st.floats(0.1, 1e5)
fences = st.builds(
    Fence,
    st.lists(st.builds(FencePolygon, st.lists(places, min_size=3, max_size=6).map(tuple), st.booleans())).map(
        tuple
    ),
    st.lists(st.builds(FenceCircle, places, radii, st.booleans())).map(tuple),
    st.none() | places,
)
missions = st.builds(
    Mission, items, known_homes, finite, fences, st.lists(st.builds(Rally, places, finite)).map(tuple), radii
)


def items_equal(a: Mission, b: Mission) -> bool:
    return len(a.items) == len(b.items) and not differences(a.items, b.items, home_is_the_vehicles=False)


@settings(max_examples=40)
@given(missions)
def test_a_plan_reads_back_as_it_was_written(mission: Mission) -> None:
    again = qgc_plan.parse(qgc_plan.compose(mission))
    assert items_equal(again, mission)
    assert replace(again, items=()) == replace(mission, items=())


@settings(max_examples=50)
@given(items, known_homes, finite)
def test_wpl_reads_back_as_it_was_written(
    items: tuple[MissionItem, ...], home: LatLon, altitude_m: float
) -> None:
    mission = Mission(items, home, altitude_m)
    again = wpl_text.parse(wpl_text.compose(mission))
    assert items_equal(again, mission)
    assert (again.home, again.home_altitude_m) == (home, altitude_m)


@given(st.text() | st.text().map(lambda text: f"QGC WPL 110\n{text}"))
def test_any_text_is_a_mission_or_one_line_that_names_the_source(text: str) -> None:
    try:
        told: Mission | PlanFileError = parse_mission(text, "some.plan")
    except PlanFileError as error:
        told = error
    assert isinstance(told, Mission) or str(told).startswith("some.plan: ")


def plan_tree(**changes: object) -> dict[str, Any]:
    item = {
        "type": "SimpleItem",
        "autoContinue": True,
        "command": 16,
        "doJumpId": 1,
        "frame": 3,
        "params": [0, 0, 0, None, 50.0001, -1.2, 0],
    }
    mission = {
        "version": 2,
        "firmwareType": 3,
        "vehicleType": 11,
        "cruiseSpeed": 1.5,
        "hoverSpeed": 5,
        "plannedHomePosition": [50.0, -1.2, 3],
        "items": [item, {**item, "doJumpId": 2}],
    }
    mission |= changes
    return {"fileType": "Plan", "version": 1, "groundStation": "QGroundControl", "mission": mission}


def with_item(**changes: object) -> dict[str, Any]:
    tree = plan_tree()
    tree["mission"]["items"][1] |= changes
    return tree


def test_a_plan_of_qgroundcontrol_gives_its_items_home_and_speed() -> None:
    mission = parse_mission(json.dumps(plan_tree()), "q.plan")
    assert mission.home == LatLon(50.0, -1.2)
    assert mission.home_altitude_m == 3.0
    assert mission.speed_m_s == 1.5
    assert [item.place for item in mission.items] == [LatLon(50.0001, -1.2)] * 2
    assert math.isnan(mission.items[0].params[3])
    assert mission.fence == Fence()


def test_do_jump_is_told_by_sequence_number_not_by_item_id() -> None:
    tree = with_item(command=177, frame=2, params=[7, 3, 0, 0, 0, 0, 0])
    tree["mission"]["items"][0]["doJumpId"] = 7
    assert parse_mission(json.dumps(tree), "q.plan").items[1].params[:2] == (1.0, 3.0)


def test_a_survey_is_expanded_into_the_items_that_it_carries() -> None:
    simple = plan_tree()["mission"]["items"][0]
    survey = {
        "type": "ComplexItem",
        "complexItemType": "survey",
        "TransectStyleComplexItem": {"Items": [simple, simple, simple]},
    }
    assert len(parse_mission(json.dumps(plan_tree(items=[simple, survey])), "q.plan").items) == 4


@pytest.mark.parametrize(
    ("tree", "said"),
    [
        (
            plan_tree(items=[{"type": "ComplexItem", "complexItemType": "StructureScan"}]),
            "item 1.*StructureScan",
        ),
        (with_item(params=[0, 0, 0, 0, 50.0, -1.2, 0, 0]), "item 2.*length <= 7"),
        (with_item(params=[0, 0, 0, 0, "fifty", -1.2, 0]), r"item 2.*params\[4\]"),
        (with_item(params=[0, 0, 0, 0, 91.0, -1.2, 0]), "item 2: latitude 91.0"),
        (with_item(params=[0, 0, 0, 0, None, -1.2, 0]), "item 2: NAV_WAYPOINT needs a latitude"),
        (with_item(command="waypoint"), "item 2.*command"),
        (with_item(command=70000), "item 2: command 70000"),
        (with_item(command=177, frame=2, params=[9, 1, 0, 0, 0, 0, 0]), "item 2: DO_JUMP to item id 9"),
        (with_item(type="FlyItem"), "item 2.*FlyItem"),
        (plan_tree(version=1), r"mission\.version"),
        (plan_tree(plannedHomePosition=[100, 0, 0]), "planned home: latitude 100"),
        (plan_tree() | {"fileType": "Parameters"}, "not a QGroundControl plan"),
        (
            plan_tree() | {"geoFence": {"polygons": [{"polygon": [[1, 2], [3, 4]]}]}},
            "fence polygon 1.*3 corners",
        ),
        (
            plan_tree() | {"geoFence": {"circles": [{"circle": {"center": [1, 2], "radius": -5}}]}},
            "fence circle 1: radius -5",
        ),
        (plan_tree() | {"rallyPoints": {"points": [[1, 2, 0], [1, 200, 0]]}}, "rally point 2: longitude 200"),
    ],
)
def test_a_plan_that_cannot_be_used_names_the_file_and_the_item(tree: dict[str, Any], said: str) -> None:
    with pytest.raises(PlanFileError, match=rf"^bad\.plan: .*{said}") as raised:
        parse_mission(json.dumps(tree), "bad.plan")
    assert "\n" not in str(raised.value)


ROW = "\t".join(["0", "1", "0", "16", "0", "0", "0", "0", "50.0", "-1.2", "0", "1"])


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("QGC WPL 120\n", "line 1: the first line must be 'QGC WPL 110'"),
        (f"QGC WPL 110\n{ROW}\n1 0 3 16 0 0", "line 3: an item has 12 fields, got 6"),
        (f"QGC WPL 110\n{ROW}\n{ROW}", "line 3: expected item 1, got item 0"),
        (f"QGC WPL 110\n{ROW}\n1 0 3 16 0 0 0 0 95 0 0 1", r"line 3 \(item 1\): latitude 95"),
        (f"QGC WPL 110\n{ROW}\n1 0 3 sixteen 0 0 0 0 50 0 0 1", r"line 3 \(item 1\): .*sixteen"),
        (f"QGC WPL 110\n{ROW}\n1 0 3 16 0 0 0 inf 50 0 0 1", r"line 3 \(item 1\): inf does not fit"),
        (f"QGC WPL 110\n{ROW}\n1 0 3 16 0 0 0 0 nan 0 0 1", r"line 3 \(item 1\): NAV_WAYPOINT needs"),
    ],
)
def test_a_wpl_text_that_cannot_be_used_names_the_line(text: str, said: str) -> None:
    with pytest.raises(PlanFileError, match=rf"^w\.waypoints: {said}"):
        parse_mission(text, "w.waypoints")


def test_wpl_without_a_home_row_keeps_every_item_and_moves_jumps_behind_home() -> None:
    text = "QGC WPL 110\n0 1 3 16 0 0 0 0 50 -1 0 1\n1 0 2 177 0 2 0 0 0 0 0 1\n"
    mission = parse_mission(text, "w.waypoints")
    assert mission.home is None
    assert mission.items[0].place == LatLon(50.0, -1.0)
    assert mission.items[1].params[0] == 1.0


def test_a_file_that_is_missing_or_binary_is_named(tmp_path: Path) -> None:
    with pytest.raises(PlanFileError, match=r"none\.plan: cannot be read: No such file"):
        load_mission(tmp_path / "none.plan")
    (tmp_path / "photo.plan").write_bytes(b"\x89PNG\xff\xfe")
    with pytest.raises(PlanFileError, match=r"photo\.plan: .*not text"):
        load_mission(tmp_path / "photo.plan")


def test_saving_chooses_the_format_by_the_name_and_never_drops_a_fence(tmp_path: Path) -> None:
    mission = Mission((MissionItem.at(LatLon(50.0, -1.0)),), LatLon(50.0, -1.2))
    for name in ("a.plan", "deeper/a.waypoints"):
        save_mission(mission, tmp_path / name)
        assert load_mission(tmp_path / name).items == mission.items
    fenced = replace(mission, rally=(Rally(LatLon(50.0, -1.0)),))
    with pytest.raises(PlanFileError, match="no rally points"):
        save_mission(fenced, tmp_path / "b.waypoints")
    assert not (tmp_path / "b.waypoints").exists()


@settings(max_examples=40)
@given(missions)
def test_what_goes_over_the_wire_counts_corners_and_puts_home_first(mission: Mission) -> None:
    lists = mission.wire_lists(home_first=True)
    assert lists[MissionType.MISSION][1:] == mission.items
    assert lists[MissionType.MISSION][0].frame == Frame.GLOBAL
    assert mission.wire_lists(home_first=False)[MissionType.MISSION] == mission.items
    corners = sum(len(polygon.corners) for polygon in mission.fence.polygons)
    back = 1 if mission.fence.return_point else 0
    assert len(lists.get(MissionType.FENCE, ())) == corners + len(mission.fence.circles) + back
    assert len(lists.get(MissionType.RALLY, ())) == len(mission.rally)
