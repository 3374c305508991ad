"""Commands and items at a stop of the mission, as literal sequences."""

import math

import pytest
from boat_rig import FRAME, nav_at, place
from msgspec.structs import replace

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point
from companion.core.intent import FollowCircle, FollowLeg, Intent, KeepStation
from companion.vehicle.mission.progress import MissionProgress
from companion.vehicle.mission.steps import (
    AfterDelay,
    GoRound,
    Home,
    MoveHome,
    ReturnHome,
    SetSpeed,
    Step,
    Wait,
    Waypoint,
)

CONFIG = BoatConfig()
A, B = Waypoint(place(50.0, 0.0)), Waypoint(place(50.0, 50.0))


def begun(*steps: Step) -> MissionProgress:
    progress = MissionProgress()
    progress.replace((Home(), *steps))
    return progress


def at(
    progress: MissionProgress, north_m: float, east_m: float, now_s: float, heading: float = 0.0
) -> Intent:
    nav = replace(nav_at(north_m, east_m), heading_rad=heading)
    return progress.update(nav, FRAME, CONFIG, now_s)


def test_what_waits_for_a_time_is_done_while_the_boat_stays_at_a_waypoint() -> None:
    progress = begun(AfterDelay(5.0), SetSpeed(1.0), Waypoint(place(50.0, 0.0), hold_s=20.0), B)
    at(progress, 0.0, 0.0, 0.0)
    for now_s, speed_m_s in ((1.0, None), (4.9, None), (5.1, 1.0), (20.9, 1.0)):
        station = at(progress, 49.0, 0.0, now_s)
        assert isinstance(station, KeepStation)
        assert station.point == pytest.approx((50.0, 0.0), abs=1e-3)
        assert progress.speed_m_s == speed_m_s
        assert progress.current_seq == 3
    leg = at(progress, 49.0, 0.0, 21.1)
    assert isinstance(leg, FollowLeg)
    assert (progress.current_seq, leg.speed_m_s) == (4, 1.0)
    assert leg.end == pytest.approx((50.0, 50.0), abs=1e-3)


def test_a_wait_keeps_its_station_and_the_next_leg_begins_where_the_last_one_ended() -> None:
    progress = begun(A, Wait(10.0), B)
    at(progress, 0.0, 0.0, 0.0)
    for now_s in (30.0, 39.9):
        station = at(progress, 49.0, 0.5, now_s)
        assert isinstance(station, KeepStation)
        assert station.point == pytest.approx((50.0, 0.0), abs=1e-3)
    assert progress.take_reached() == [1]
    leg = at(progress, 49.0, 0.5, 40.1)
    assert isinstance(leg, FollowLeg)
    assert leg.start == pytest.approx((50.0, 0.0), abs=1e-3)
    assert progress.take_reached() == [2]


@pytest.mark.parametrize("clockwise", [True, False])
@pytest.mark.parametrize(("radius_m", "expected_m"), [(6.0, 6.0), (0.0, 10.0)])
def test_a_circle_is_left_after_its_turns_and_the_next_leg_begins_at_the_boat(
    clockwise: bool, radius_m: float, expected_m: float
) -> None:
    progress = begun(GoRound(Point(20.0, 0.0), 1.5, radius_m, clockwise), A)
    side = 1.0 if clockwise else -1.0
    for degrees in range(0, 540, 15):
        bearing = side * math.radians(degrees)
        north, east = 20.0 + expected_m * math.cos(bearing), expected_m * math.sin(bearing)
        assert at(progress, north, east, 0.0) == FollowCircle(Point(20.0, 0.0), expected_m, clockwise, 2.0)
    assert progress.take_reached() == []
    bearing = side * math.radians(545.0)
    leg = at(progress, 20.0 + expected_m * math.cos(bearing), expected_m * math.sin(bearing), 0.0)
    assert isinstance(leg, FollowLeg)
    assert leg.start == pytest.approx((20.0 + expected_m * math.cos(bearing), expected_m * math.sin(bearing)))
    assert progress.take_reached() == [1]


def test_commands_are_done_in_their_order_as_the_next_leg_begins() -> None:
    home = place(7.0, 8.0)
    progress = begun(MoveHome(home), SetSpeed(0.7), A, MoveHome(None), SetSpeed(0.0), B, ReturnHome())
    leg = at(progress, 0.0, 0.0, 0.0)
    assert isinstance(leg, FollowLeg)
    assert (progress.current_seq, leg.speed_m_s, progress.take_homes()) == (3, 0.7, [home])
    leg = at(progress, 50.0, 0.0, 1.0)
    assert isinstance(leg, FollowLeg)
    assert (progress.current_seq, leg.speed_m_s, progress.take_homes()) == (6, 2.0, [None])
    assert not progress.go_home
    station = at(progress, 50.0, 50.0, 2.0)
    assert isinstance(station, KeepStation)
    assert (progress.go_home, progress.finished, progress.take_reached()) == (True, True, [3, 6])
    assert progress.set_current(1)
    assert (progress.go_home, progress.finished) == (False, False)
