"""What a vehicle holds, read back into a mission: the inverse of what is sent."""

from dataclasses import replace

import pytest

from companion.core.geo import LatLon
from mission_tools.mission.mission import (
    Fence,
    FenceCircle,
    FencePolygon,
    Mission,
    MissionItem,
    MissionType,
    Rally,
)
from mission_tools.mission.wire import fence_from, mission_from

CORNERS = tuple(LatLon(50.0 + 0.001 * n, -1.2 + 0.001 * (n % 2)) for n in range(4))
FENCE = Fence(
    (FencePolygon(CORNERS), FencePolygon(CORNERS[:3], inclusion=False)),
    (FenceCircle(CORNERS[0], 12.5, inclusion=False), FenceCircle(CORNERS[1], 100.0)),
    CORNERS[2],
    1.5,
)
MISSION = Mission(
    (MissionItem.at(CORNERS[1]), MissionItem.at(CORNERS[3])),
    CORNERS[0],
    2.0,
    FENCE,
    (Rally(CORNERS[2], 3.0),),
)


@pytest.mark.parametrize("home_first", [True, False])
def test_what_is_sent_comes_back(home_first: bool) -> None:
    found = mission_from(MISSION.wire_lists(home_first=home_first), home_first=home_first)
    assert found == (MISSION if home_first else replace(MISSION, home=None, home_altitude_m=0.0))


def test_an_empty_vehicle_has_an_empty_mission() -> None:
    assert mission_from(dict.fromkeys(MissionType, ()), home_first=True) == Mission(())


def test_home_at_zero_is_no_home() -> None:
    lists = {MissionType.MISSION: (MissionItem(16, 0), MissionItem.at(CORNERS[1]))}
    assert mission_from(lists, home_first=True).home is None


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda items: items[:4], "fence, item 1: begins a polygon of 4 vertices"),
        (lambda items: [MissionItem.at(CORNERS[0])], "fence, item 0: MAV_CMD 16 is none of a fence"),
        (
            lambda items: [replace(items[1], params=(2.0, 0.0, 0.0, 0.0)), *items[2:]],
            "fence, item 0: begins a polygon of 2 vertices",
        ),
        (
            lambda items: [*items[1:4], replace(items[4], command=5002), *items[5:]],
            "fence, item 0: begins a polygon of 4 vertices",
        ),
    ],
)
def test_a_fence_that_is_none_is_named_by_item(change: object, said: str) -> None:
    assert callable(change)
    with pytest.raises(ValueError, match=said):
        fence_from(change(list(FENCE.items())))
