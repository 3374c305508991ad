"""Whole missions in lockstep, uploaded as frames, judged by ground truth."""

import math

import pytest
from boat_rig import HOME_ITEM, Rig, waypoint
from sailing_rig import do, over, reached, speed_m_s, told

from companion.core.units import wrap_pi
from companion.mavlink.transfer import Completed

TURNS, LOITER_TIME, RTL, HAND_OVER, DELAY = 18, 19, 20, 92, 93
CHANGE_SPEED, JUMP, SET_HOME, LIMITS = 178, 177, 179, 222


def test_times_delays_jumps_and_a_home_on_the_way_are_sailed_and_the_end_leads_home() -> None:
    rig = Rig().sail(
        waypoint(12.0, 0.0, command=LOITER_TIME, param1=10.0), do(SET_HOME, 1.0), do(DELAY, 8.0),
        waypoint(12.0, 12.0), do(JUMP, 4.0, 1.0), waypoint(0.0, 12.0), do(RTL),
    )  # fmt: skip
    rig.until(lambda: bool(reached(rig)), 60.0)
    worst_m = 0.0
    for _ in range(9):
        rig.run(1.0)
        worst_m = max(worst_m, rig.offset_m(12.0, 0.0))
    assert worst_m < 3.5
    assert rig.boat.vehicle.progress.current_seq == 1
    rig.until(lambda: rig.boat.vehicle.progress.current_seq == 4, 5.0 + 10.0)
    began_s = rig.now_s
    assert over(rig) == [1, 3, 4, 4, 6]
    assert rig.now_s - began_s > 12.0
    assert rig.mode == "RTL"
    told(rig, "RTL: arrived", 60.0)
    assert rig.offset_m(12.0, 0.0) < 3.5


def test_turns_are_sailed_round_the_place_and_then_the_mission_goes_on() -> None:
    rig = Rig().sail(waypoint(15.0, 0.0, command=TURNS, param1=2.0, param3=-8.0), waypoint(30.0, 10.0))
    swept, last, off = 0.0, None, []
    while rig.boat.vehicle.progress.current_seq == 1:
        rig.run(0.5)
        truth = rig.world.truth
        away_m, bearing = rig.offset_m(15.0, 0.0), math.atan2(truth.east_m, truth.north_m - 15.0)
        if abs(away_m - 8.0) < 3.0:
            swept += wrap_pi(bearing - last) if last is not None else 0.0
            off.append(away_m - 8.0)
        last = bearing
        assert rig.now_s < 300.0
    assert -swept == pytest.approx(4.0 * math.pi, rel=0.15)
    assert max(map(abs, off[20:])) < 1.5
    assert over(rig) == [1, 2]


def test_a_patrol_without_end_rounds_its_corner_without_stopping() -> None:
    corners = [waypoint(*corner) for corner in ((20.0, 0.0), (20.0, 20.0), (0.0, 20.0), (0.0, 0.0))]
    rig = Rig().sail(*corners, do(JUMP, 1.0, -1.0))
    rig.until(lambda: rig.boat.vehicle.progress.current_seq == 4, 120.0)
    slowest = 9.0
    while len(reached(rig)) < 5:
        rig.run(0.5)
        slowest = min(slowest, speed_m_s(rig))
        assert rig.now_s < 300.0
    assert slowest > 0.3


def test_a_new_mission_whose_way_here_is_the_same_is_sailed_on_without_a_break() -> None:
    way = [waypoint(15.0, 0.0), waypoint(40.0, 0.0)]
    rig = Rig().sail(*way, waypoint(40.0, 20.0))
    rig.until(lambda: rig.boat.vehicle.progress.current_seq == 2, 60.0)
    rig.run(3.0)
    assert isinstance(rig.upload([HOME_ITEM, *way, waypoint(40.0, -20.0)]), Completed)
    assert "New mission goes on with item 2" in rig.peer.texts
    slowest = 9.0
    while rig.boat.vehicle.progress.current_seq == 2:
        rig.run(0.2)
        slowest = min(slowest, speed_m_s(rig))
    assert slowest > 0.3
    assert over(rig) == [1, 2, 3]
    assert rig.offset_m(40.0, -20.0) < 3.5
