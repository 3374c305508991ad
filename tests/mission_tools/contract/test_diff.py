"""The difference between what is on board and what would be uploaded, as a person reads it."""

from dataclasses import replace

import pytest

from companion.core.geo import LatLon, LocalFrame, Point
from mission_tools.contract.diff import SHOWN, diff
from mission_tools.mission.mission import Command, Mission, MissionItem, MissionType

FRAME = LocalFrame(LatLon(50.0, -1.2))


def waypoint(north_m: float, east_m: float = 0.0, hold_s: float = 0.0) -> MissionItem:
    return MissionItem.at(FRAME.to_global(Point(north_m, east_m)), params=(hold_s, 0.0, 0.0, 0.0))


def changes(held: list[MissionItem], new: list[MissionItem]) -> list[str]:
    home = waypoint(0.0).place
    lists = [Mission(tuple(items), home).wire_lists(home_first=True) for items in (new, held)]
    return diff(lists[0], lists[1], is_ardupilot=True)


ROUTE = [waypoint(30.0 * n) for n in range(1, 6)]


def test_a_mission_that_stays_is_one_line() -> None:
    assert changes(ROUTE, ROUTE) == ["mission: the same as on board, 6 items"]


def test_an_inserted_waypoint_is_one_change_and_not_one_of_everything_after_it() -> None:
    new = [*ROUTE[:2], waypoint(70.0, 20.0), *ROUTE[2:]]
    assert changes(ROUTE, new) == [
        "mission: 6 items on board, 7 to upload",
        "  item 3: NAV_WAYPOINT at 50.000629,-1.199721 is new",
    ]


def test_a_waypoint_that_goes_is_named_by_its_number_on_board() -> None:
    assert changes(ROUTE, [*ROUTE[:3], ROUTE[4]])[1:] == [
        "  item 4 on board: NAV_WAYPOINT at 50.001079,-1.200000 goes"
    ]


def test_a_moved_waypoint_tells_how_far_and_a_hold_its_parameter() -> None:
    moved = [*ROUTE[:4], waypoint(150.0, 12.5, hold_s=60.0)]
    assert changes(ROUTE, moved)[1:] == [
        "  item 5: NAV_WAYPOINT moved by 12.5 m to 50.001349,-1.199826, param1 0 becomes 60"
    ]


def test_each_field_that_changes_is_told() -> None:
    jump = MissionItem(Command.DO_JUMP, 2, (1.0, 2.0, 0.0, 0.0), x=5, y=6)
    other = MissionItem(Command.DO_JUMP, 2, (1.0, 2.0, 0.0, 4.5), x=5, y=7, z=1.5, autocontinue=False)
    assert changes([jump], [other])[1:] == [
        "  item 1: DO_JUMP x, y 5, 6 becomes 5, 7, param4 0 becomes 4.5, z 0 becomes 1.5, waits for a command"
    ]
    assert changes([other], [replace(other, autocontinue=True)])[1:] == [
        "  item 1: DO_JUMP goes on by itself"
    ]
    assert changes(ROUTE[:1], [replace(ROUTE[0], frame=0)])[1:] == [
        "  item 1: NAV_WAYPOINT frame 3 becomes 0"
    ]
    assert " x, y 5000" in changes(ROUTE[:1], [MissionItem(Command.NAV_WAYPOINT, 2, x=7, y=9)])[1]
    assert changes(ROUTE[:1], [replace(ROUTE[0], frame=6)]) == ["mission: the same as on board, 2 items"]


def test_another_command_is_told_by_name() -> None:
    loiter = replace(ROUTE[4], command=Command.NAV_LOITER_UNLIM)
    (_, told) = changes(ROUTE, [*ROUTE[:4], loiter])
    assert "NAV_WAYPOINT at 50.001349,-1.200000 becomes NAV_LOITER_UNLIM" in told


def test_home_is_the_vehicles_own() -> None:
    new = Mission(tuple(ROUTE), LatLon(50.0, -1.2)).wire_lists(home_first=True)
    held = Mission(tuple(ROUTE), LatLon(50.0001, -1.2)).wire_lists(home_first=True)
    assert diff(new, held, is_ardupilot=True) == ["mission: the same as on board, 6 items"]
    assert len(diff(new, held, is_ardupilot=False)) == 2


def test_a_number_that_came_back_as_float32_is_the_same() -> None:
    held = [replace(item, z=0.10000000149011612) for item in ROUTE]
    assert changes(held, [replace(item, z=0.1) for item in ROUTE])[0].startswith("mission: the same")


def test_many_changes_are_counted() -> None:
    told = changes(ROUTE * 4, [waypoint(10.0 * n, 5.0) for n in range(20)])
    assert len(told) == 1 + SHOWN + 1
    assert told[-1] == "  and 12 more changes"


@pytest.mark.parametrize(
    ("held", "new", "said"),
    [
        ((), (waypoint(1.0),), "fence: none on board, 1 item to upload"),
        ((waypoint(1.0),), (), "fence: 1 item on board, to be cleared"),
    ],
)
def test_a_list_that_comes_or_goes_is_one_line(
    held: tuple[MissionItem, ...], new: tuple[MissionItem, ...], said: str
) -> None:
    assert diff({MissionType.FENCE: new}, {MissionType.FENCE: held}, is_ardupilot=True) == [said]
