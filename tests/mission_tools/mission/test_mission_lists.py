"""A mission's lists to the last field, and the old fence and rally texts of ArduPilot's stations."""

import json
import math
from dataclasses import astuple

import pytest

from companion.core.geo import LatLon
from mission_tools.errors import UsageError
from mission_tools.mission.mission import (
    Command,
    Fence,
    FenceCircle,
    FencePolygon,
    Mission,
    MissionItem,
    MissionType,
    Rally,
)
from mission_tools.mission.qgc_plan import compose as plan_text
from mission_tools.mission.route import with_speed
from mission_tools.mission.wpl_text import compose as wpl_text
from mission_tools.mission.wpl_text import parse as parse_wpl
from mission_tools.mission.wpl_text import parse_lists

A, B, C, D = LatLon(50.0, -1.2), LatLon(50.1, -1.2), LatLon(50.1, -1.1), LatLon(50.0, -1.1)
FENCE_TEXT = "# of a station\n50.05 -1.15\n50.0 -1.2\n50.1 -1.2\n50.1 -1.1\n50.0 -1.2\n"


def test_a_fence_text_is_the_return_point_and_the_corners_with_the_first_again() -> None:
    assert parse_lists(FENCE_TEXT) == (
        Fence((FencePolygon((A, B, C)),), return_point=LatLon(50.05, -1.15)),
        (),
    )
    four = FENCE_TEXT.replace("50.0 -1.2\n50.1", "50.0 -1.1\n50.0 -1.2\n50.1", 1).rpartition("50.0 -1.2\n")[0]
    found = parse_lists(four)
    assert found is not None
    assert found[0].polygons == (FencePolygon((D, A, B, C)),)  # not closed: every corner counts


def test_a_rally_text_has_a_line_for_each_point_and_zero_where_it_says_no_altitude() -> None:
    assert parse_lists("RALLY 50.0 -1.2 7.5 0 0 0\nrally 50.1 -1.1\n") == (
        Fence(),
        (Rally(A, 7.5), Rally(C, 0.0)),
    )


@pytest.mark.parametrize("text", ["", "# nothing", "QGC WPL 110", "50.0", "50.0 -1.2 3.0", "50.0 west"])
def test_other_texts_are_no_such_list(text: str) -> None:
    assert parse_lists(text) is None


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("50 -1\n50 -1.1\n50.1 -1\n", "3 lines: expected a return point"),
        ("50 -1\n95 -1\n", "line 2: .*latitude 95"),
    ],
)
def test_a_list_that_cannot_be_used_is_refused(text: str, said: str) -> None:
    with pytest.raises(ValueError, match=said):
        parse_lists(text)


def test_the_wire_lists_have_zeros_where_nothing_is_said() -> None:
    fence = Fence((FencePolygon((A, B, C)),), (FenceCircle(D, 12.5, inclusion=False),), A)
    lists = Mission((MissionItem.at(B),), fence=fence, rally=(Rally(C),)).wire_lists(home_first=True)
    home, first = (astuple(item) for item in lists[MissionType.MISSION])
    zeros = (0.0, 0.0, 0.0, 0.0)
    assert home == (16, 0, zeros, 501_000_000, -12_000_000, 0.0, True)  # the first place stands in
    assert first == (16, 3, zeros, 501_000_000, -12_000_000, 0.0, True)
    back, corner, *_, circle = (astuple(item) for item in lists[MissionType.FENCE])
    assert back == (5000, 3, zeros, 500_000_000, -12_000_000, 0.0, True)
    assert corner == (5001, 0, (3.0, 0.0, 0.0, 0.0), 500_000_000, -12_000_000, 0.0, True)
    assert circle == (5004, 0, (12.5, 0.0, 0.0, 0.0), 500_000_000, -11_000_000, 0.0, True)
    assert lists[MissionType.RALLY][0].z == 0.0


@pytest.mark.parametrize(
    ("command", "seconds", "hold_s"),
    [(16, 5.0, 5.0), (19, 0.5, 0.5), (93, 3.0, 3.0), (16, -1.0, 0.0), (178, 5.0, 0.0), (17, 5.0, 0.0)],
)
def test_an_item_holds_only_where_its_first_parameter_is_a_time(
    command: int, seconds: float, hold_s: float
) -> None:
    assert MissionItem(command, params=(seconds, 0.0, 0.0, 0.0)).hold_s == hold_s


def test_a_speed_is_the_first_item_and_jumps_go_on_to_lead_to_the_same_item() -> None:
    jump = MissionItem(Command.DO_JUMP, 2, (1.0, 2.0, 0.0, 0.0))
    fast = with_speed(Mission((MissionItem.at(B), jump)), 0.5)
    assert astuple(fast.items[0])[:3] == (178, 2, (1.0, 0.5, -1.0, 0.0))
    assert fast.items[2].params[:2] == (2.0, 2.0)
    assert with_speed(fast, None) is fast
    for speed_m_s in (0.0, 100.0):
        with pytest.raises(UsageError, match="expected metres per second"):
            with_speed(fast, speed_m_s)


def test_x_and_y_fit_32_bits_and_not_one_more() -> None:
    assert MissionItem(300, 2, x=2**31 - 1, y=-(2**31)).y == -(2**31)
    for wide in (2**31, -(2**31) - 1):
        with pytest.raises(ValueError, match="32 bits"):
            MissionItem(300, 2, x=wide)


def test_a_saved_mission_without_a_home_begins_at_its_first_place() -> None:
    mission = Mission((MissionItem.at(B),))
    assert '"plannedHomePosition": [\n            50.1,\n            -1.2,\n            0.0\n' in plan_text(
        mission
    )
    rows = wpl_text(Mission((MissionItem.at(B),), home=A)).splitlines()
    assert [row.split("\t")[:4] for row in rows[1:]] == [["0", "1", "0", "16"], ["1", "0", "3", "16"]]
    assert parse_wpl(wpl_text(mission)).home is None  # 0, 0 stands for an unknown one


def test_a_field_beyond_the_wires_is_refused() -> None:
    assert MissionItem(65535, 2, (3.4e38, 0.0, 0.0, 0.0)).command == 65535
    with pytest.raises(ValueError, match=r"65536 is outside 0\.\.65535"):
        MissionItem(65536)
    with pytest.raises(ValueError, match="does not fit the 32 bits"):
        MissionItem(16, 2, (5e38, 0.0, 0.0, 0.0))


def test_the_fence_of_a_plan_has_the_versions_that_qgroundcontrol_reads() -> None:
    """GeoFenceController and QGCFencePolygon: version 2 of the fence, 1 of each polygon and circle."""
    fence = Fence((FencePolygon((A, B, C)),), (FenceCircle(D, 12.5, inclusion=False),))
    tree = json.loads(plan_text(Mission((MissionItem.at(B),), fence=fence)))["geoFence"]
    assert [tree["version"], *(one["version"] for one in (*tree["polygons"], *tree["circles"]))] == [2, 1, 1]


def test_what_a_file_leaves_out_is_zero_and_what_json_cannot_say_is_refused() -> None:
    item = MissionItem.from_numbers(178, 2, [1.0, 1.5, -1.0, 0.0, *[math.nan] * 3], autocontinue=True)
    assert (item.x, item.y, item.z) == (0, 0, 0.0)
    with pytest.raises(ValueError, match="not JSON compliant"):
        plan_text(Mission((MissionItem(16, z=math.nan),)))
