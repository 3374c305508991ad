"""Commands in missions beyond waypoints, uploaded as frames and sailed, judged by ground truth."""

import math

import pytest
from boat_rig import BOAT, HOME_ITEM, OK, Rig, waypoint

from companion.core.units import wrap_pi
from companion.mavlink.dialect import dialect
from companion.mavlink.items import MissionItem
from companion.mavlink.transfer import Completed

TURNS, HAND_OVER = 18, 92
AFTER, WITHIN, YAW = 112, 114, 115
CHANGE_SPEED, JUMP, SET_HOME, ROI, LIMITS = 178, 177, 179, 201, 222


def do(command: int, p1: float = 0.0, p2: float = 0.0, p3: float = 0.0, p4: float = 0.0) -> MissionItem:
    return MissionItem(frame=2, command=command, param1=p1, param2=p2, param3=p3, param4=p4)


def over(rig: Rig, limit_s: float = 300.0) -> list[int]:
    rig.until(lambda: rig.mode != "AUTO", limit_s)
    rig.run(0.1)
    return [message.seq for message in rig.peer.said("MISSION_ITEM_REACHED")]


def speed_m_s(rig: Rig) -> float:
    return math.hypot(rig.world.truth.north_m_s, rig.world.truth.east_m_s)


@pytest.mark.parametrize("radius_m", [8.0, -8.0], ids=["clockwise", "counter"])
def test_turns_are_sailed_round_the_place_and_then_the_mission_goes_on(radius_m: float) -> None:
    rig = Rig().sail(waypoint(20.0, 0.0, command=TURNS, param1=2.0, param3=radius_m), waypoint(40.0, 20.0))
    swept, last, off = 0.0, None, []
    while rig.boat.vehicle.progress.current_seq == 1:
        rig.run(0.5)
        truth = rig.world.truth
        away_m, bearing = rig.offset_m(20.0, 0.0), math.atan2(truth.east_m, truth.north_m - 20.0)
        if abs(away_m - 8.0) < 3.0:
            swept += wrap_pi(bearing - last) if last is not None else 0.0
            off.append(away_m - 8.0)
        last = bearing
        assert rig.now_s < 300.0
    assert math.copysign(1.0, radius_m) * swept == pytest.approx(4.0 * math.pi, rel=0.15)
    assert max(map(abs, off[20:])) < 1.5
    assert over(rig) == [1, 2]


def test_a_speed_behind_a_distance_waits_until_the_end_of_the_leg_is_that_near() -> None:
    rig = Rig().sail(waypoint(10.0, 0.0), do(WITHIN, 30.0), do(CHANGE_SPEED, 1.0, 0.8), waypoint(110.0, 0.0))
    rig.until(lambda: rig.offset_m(70.0, 0.0) < 2.0, 80.0)
    assert speed_m_s(rig) > 1.6
    rig.until(lambda: rig.offset_m(95.0, 0.0) < 2.0, 60.0)
    assert speed_m_s(rig) == pytest.approx(0.8, abs=0.2)
    assert over(rig) == [1, 4]


def test_a_speed_behind_a_delay_waits_while_the_leg_is_sailed() -> None:
    rig = Rig().sail(do(AFTER, 20.0), do(CHANGE_SPEED, 1.0, 0.8), waypoint(100.0, 0.0))
    rig.run(15.0)
    assert speed_m_s(rig) > 1.6
    rig.run(15.0)
    assert speed_m_s(rig) == pytest.approx(0.8, abs=0.2)


def test_a_turn_on_the_spot_ends_with_the_bow_there() -> None:
    rig = Rig().sail(waypoint(15.0, 0.0), do(YAW, 200.0), do(YAW, 90.0, 0.0, -1.0, 1.0), waypoint(0.0, 0.0))
    seen = {}
    before = 0
    while rig.mode == "AUTO":
        rig.step()
        seq = rig.boat.vehicle.progress.current_seq
        if seq != before:
            seen[before], before = rig.world.truth.heading_rad, seq
        assert rig.now_s < 200.0
    assert wrap_pi(seen[2] - math.radians(200.0)) == pytest.approx(0.0, abs=0.2)
    assert wrap_pi(seen[3] - seen[2] + math.radians(90.0)) == pytest.approx(0.0, abs=0.3)


def test_home_can_be_moved_by_the_mission() -> None:
    rig = Rig().sail(waypoint(20.0, 0.0), do(SET_HOME, 1.0), waypoint(20.0, 20.0), do(20))
    over(rig)
    rig.until(lambda: any("RTL: arrived" in text for text in rig.peer.texts), 60.0)
    assert rig.offset_m(20.0, 0.0) < 3.5


def test_another_program_steers_until_its_limit_and_the_mission_goes_on() -> None:
    rig = Rig().sail(waypoint(10.0, 0.0), do(LIMITS, 15.0), do(HAND_OVER, 1.0), waypoint(10.0, 10.0))
    rig.until(lambda: rig.boat.vehicle.progress.current_seq == 3, 30.0)
    rig.run(1.0)
    for _ in range(20):
        rig.peer.send(
            dialect.MAVLink_set_position_target_local_ned_message(
                0, *BOAT, 1, 0b110111000111, 0, 0, 0, 0, -1.5, 0, 0, 0, 0, 0, 0
            )
        )
        rig.run(0.5)
    assert rig.world.truth.east_m < -5.0
    assert rig.mode == "AUTO"
    assert over(rig) == [1, 3, 4]


def test_local_places_are_metres_from_the_origin_and_from_where_the_leg_began() -> None:
    def local(frame: int, north_m: float, east_m: float) -> MissionItem:
        return MissionItem(frame=frame, command=16, x=round(north_m * 1e4), y=round(east_m * 1e4))

    rig = Rig().sail(local(1, 20.0, 5.0), local(7, 0.0, 15.0), local(7, -20.0, 0.0))
    frame = rig.boat.estimator.frame
    assert frame is not None
    origin = rig.scenario.frame.to_local(frame.origin)
    for reached, (north_m, east_m) in enumerate([(20.0, 5.0), (20.0, 20.0), (0.0, 20.0)], 1):
        while len(rig.peer.said("MISSION_ITEM_REACHED")) < reached:
            rig.step()
            assert rig.now_s < 120.0
        assert rig.offset_m(origin.north_m + north_m, origin.east_m + east_m) < 3.5


def test_what_means_nothing_here_is_passed_over_and_said_once() -> None:
    rig = Rig().ready()
    rig.upload([HOME_ITEM, waypoint(10.0, 0.0), do(ROI), do(ROI), waypoint(10.0, 10.0)])
    (text,) = [text for text in rig.peer.texts if "ignored" in text]
    assert text == "Mission: item 2, command 201 (DO_SET_ROI), is ignored, and 1 more"
    assert rig.arm() == OK
    assert rig.ask(dialect.MAV_CMD_MISSION_START) == OK
    assert over(rig) == [1, 4]


def test_a_patrol_without_end_rounds_its_corner_without_stopping() -> None:
    rig = Rig().sail(
        waypoint(30.0, 0.0),
        waypoint(30.0, 30.0),
        waypoint(0.0, 30.0),
        waypoint(0.0, 0.0),
        do(JUMP, 1.0, -1.0),
    )
    rig.until(lambda: rig.boat.vehicle.progress.current_seq == 4, 120.0)
    slowest = 9.0
    while len(rig.peer.said("MISSION_ITEM_REACHED")) < 5:
        rig.run(0.5)
        slowest = min(slowest, speed_m_s(rig))
        assert rig.now_s < 300.0
    assert slowest > 0.3


def test_a_new_mission_whose_way_here_is_the_same_is_sailed_on_without_a_break() -> None:
    way = [waypoint(30.0, 0.0), waypoint(60.0, 0.0)]
    rig = Rig().sail(*way, waypoint(60.0, 40.0))
    rig.until(lambda: rig.boat.vehicle.progress.current_seq == 2, 60.0)
    rig.run(4.0)
    assert isinstance(rig.upload([HOME_ITEM, *way, waypoint(60.0, -40.0)]), Completed)
    assert "New mission goes on with item 2" in rig.peer.texts
    slowest = 9.0
    while rig.boat.vehicle.progress.current_seq == 2:
        rig.run(0.2)
        slowest = min(slowest, speed_m_s(rig))
    assert slowest > 0.3
    assert over(rig) == [1, 2, 3]
    assert rig.offset_m(60.0, -40.0) < 3.5


def test_a_new_mission_that_leads_elsewhere_begins_at_its_first_item() -> None:
    rig = Rig().sail(waypoint(30.0, 0.0), waypoint(60.0, 0.0))
    rig.until(lambda: rig.boat.vehicle.progress.current_seq == 2, 60.0)
    assert isinstance(rig.upload([HOME_ITEM, waypoint(30.0, 20.0), waypoint(60.0, 0.0)]), Completed)
    assert "New mission begins at item 1" in rig.peer.texts
    rig.until(lambda: rig.offset_m(30.0, 20.0) < 3.0, 60.0)


def test_an_item_made_current_with_a_reset_has_its_jumps_again() -> None:
    rig = Rig().sail(waypoint(12.0, 0.0), waypoint(12.0, 12.0), do(JUMP, 1.0, 1.0), waypoint(0.0, 12.0))
    rig.until(lambda: rig.boat.vehicle.progress.current_seq == 4, 120.0)
    assert rig.ask(dialect.MAV_CMD_DO_SET_MISSION_CURRENT, 1.0, 1.0) == OK
    rig.peer.forget()
    assert over(rig) == [1, 2, 1, 2, 4]
