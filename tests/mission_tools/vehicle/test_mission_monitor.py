"""A monitor seen from outside: when it has ended, and how."""

import pytest

from companion.core.geo import LatLon, LocalFrame, Point
from mission_tools.errors import VehicleError
from mission_tools.mission.mission import Command, Mission, MissionItem
from mission_tools.mission.route import mission_along
from mission_tools.vehicle.mission_monitor import REASON_S, STALL_S, MissionMonitor
from mission_tools.vehicle.state import AUTO, MISSION_ACTIVE, MISSION_COMPLETE, VehicleState

FRAME = LocalFrame(LatLon(50.0, -1.2))
PATH = [FRAME.to_global(Point(north, 0.0)) for north in (0.0, 100.0, 200.0, 300.0)]
MISSION = mission_along(PATH, speed_m_s=1.0)  # items: speed 1, waypoints 2, 3, 4


def sailing(north_m: float, current_item: int = 2, **more: object) -> VehicleState:
    state = VehicleState(autopilot=3, custom_mode=AUTO, armed=True, mission_state=MISSION_ACTIVE)
    state.position = FRAME.to_global(Point(north_m, 0.0))
    state.current_item = current_item
    for name, value in more.items():
        setattr(state, name, value)
    return state


def test_progress_counts_waypoints_and_the_way_along_all_legs() -> None:
    monitor = MissionMonitor(MISSION, now_s=0.0)
    assert monitor.update(sailing(0.0, 1), 0.0).left_m == pytest.approx(300.0, abs=0.1)
    progress = monitor.update(sailing(150.0, 3), 75.0)
    assert (progress.waypoint, progress.waypoints) == (2, 3)
    assert progress.left_m == pytest.approx(150.0, abs=0.1)
    assert progress.eta_s == pytest.approx(75.0, rel=0.01)
    assert not progress.finished
    assert monitor.update(sailing(101.0, 0, reached_item=2), 80.0).waypoint == 2


def test_the_end_is_the_last_waypoint_reached_whatever_the_mode_is_then() -> None:
    monitor = MissionMonitor(MISSION, now_s=0.0)
    assert not monitor.update(sailing(299.0, 4, reached_item=3), 1.0).finished
    ended = monitor.update(sailing(300.0, 4, reached_item=4, custom_mode=4, armed=False), 2.0)
    assert ended.finished
    assert ended.left_m == 0.0


def test_a_completed_mission_state_ends_the_voyage_only_after_an_active_one() -> None:
    stale = MissionMonitor(MISSION, now_s=0.0)
    assert not stale.update(sailing(0.0, mission_state=MISSION_COMPLETE), 0.0).finished
    monitor = MissionMonitor(MISSION, now_s=0.0)
    monitor.update(sailing(0.0), 0.0)
    assert monitor.update(sailing(300.0, mission_state=MISSION_COMPLETE), 1.0).finished


def test_a_mission_without_places_leads_nowhere() -> None:
    assert MissionMonitor(Mission(()), now_s=0.0).update(sailing(9.0), 0.0).left_m == 0.0


def test_items_of_other_autopilots_count_from_zero() -> None:
    monitor = MissionMonitor.of(VehicleState(autopilot=12), MISSION, 0.0)
    assert not monitor.update(sailing(299.0, 3, autopilot=12, reached_item=2), 0.0).finished
    assert monitor.update(sailing(300.0, 3, autopilot=12, reached_item=3), 0.0).finished


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"custom_mode": 4}, r"left AUTO for HOLD on the way to waypoint 2 of 3 \(GCS lost\)"),
        ({"custom_mode": 11}, "left AUTO for RTL"),
        ({"armed": False}, "disarmed on the way to waypoint 2 of 3"),
    ],
)
def test_leaving_auto_or_disarming_ends_the_voyage_with_the_vehicles_reason(
    change: dict[str, object], said: str
) -> None:
    monitor = MissionMonitor(MISSION, now_s=10.0)
    monitor.update(sailing(110.0, 3), 11.0)
    state = sailing(120.0, 3, **change)
    state.texts.append((9.0, 2, "an old story"))
    state.texts.append((11.5, 4, "GCS lost"))
    state.texts.append((11.6, 6, "just a note"))
    with pytest.raises(VehicleError, match=said) as raised:
        monitor.update(state, 12.0)
    assert raised.value.exit_code == 1


def test_the_vehicles_reason_is_waited_for_a_second_after_its_mode_has_changed() -> None:
    monitor = MissionMonitor(MISSION, now_s=10.0)
    monitor.update(sailing(110.0, 3), 11.0)
    left = sailing(120.0, 3, custom_mode=4)
    monitor.update(left, 12.0)
    monitor.update(left, 12.0 + 0.9 * REASON_S)
    with pytest.raises(VehicleError, match=r"left AUTO for HOLD on the way to waypoint 2 of 3$"):
        monitor.update(left, 12.0 + REASON_S)
    monitor.update(sailing(120.0, 3), 14.0)
    monitor.update(left, 20.0)
    left.texts.append((20.1, 4, "GCS lost"))
    with pytest.raises(VehicleError, match=r"\(GCS lost\)"):
        monitor.update(left, 20.2)


def test_a_boat_that_makes_no_progress_is_given_up_after_the_stall_time_and_not_before() -> None:
    monitor = MissionMonitor(MISSION, now_s=0.0)
    for tick in range(int(STALL_S)):
        monitor.update(sailing(50.0 + 0.005 * (tick % 2)), float(tick))
    with pytest.raises(
        VehicleError, match=r"no progress for 60 s on the way to waypoint 1 of 3, 2.*m before"
    ):
        monitor.update(sailing(50.0), STALL_S + 1.0)


def test_the_slowest_boat_that_moves_is_not_stuck() -> None:
    monitor = MissionMonitor(MISSION, now_s=0.0)
    for tick in range(1000):
        assert not monitor.update(sailing(0.002 * tick), float(tick)).finished


def test_waiting_at_a_waypoint_is_not_being_stuck() -> None:
    hold = MissionItem.at(PATH[1], Command.NAV_WAYPOINT, (120.0, 0.0, 0.0, 0.0))
    monitor = MissionMonitor(Mission((hold, *MISSION.items[2:]), PATH[0]), now_s=0.0)
    monitor.update(sailing(100.0, 1), 0.0)
    monitor.update(sailing(100.0, 1), 150.0)
    with pytest.raises(VehicleError, match="no progress for 180 s"):
        monitor.update(sailing(100.0, 1), 181.0)


def test_the_track_keeps_every_new_place_once_and_measures_it() -> None:
    monitor = MissionMonitor(MISSION, now_s=5.0)
    assert monitor.duration_s == 0.0
    for time_s, north_m in ((5.0, 0.0), (5.1, 0.0), (6.0, 30.0), (7.0, 40.0)):
        monitor.update(sailing(north_m, boat_time_s=100.0 + 10.0 * time_s), time_s)
    assert [point.time_s for point in monitor.track] == [150.0, 160.0, 170.0]
    assert monitor.duration_s == 20.0
    assert monitor.track_length_m == pytest.approx(40.0, abs=0.01)


def test_a_boat_without_a_clock_is_timed_by_ours() -> None:
    monitor = MissionMonitor(MISSION, now_s=5.0)
    for time_s, north_m in ((5.0, 0.0), (6.0, 30.0)):
        monitor.update(sailing(north_m), time_s)
    assert monitor.duration_s == 1.0
