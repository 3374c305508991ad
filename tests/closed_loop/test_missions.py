"""Whole missions in lockstep, uploaded as frames, judged by ground truth."""

import math

import pytest
from boat_rig import OK, Rig, waypoint

from companion.mavlink.dialect import dialect
from companion.mavlink.items import MissionItem

LOITER_TIME, RTL, DELAY = 19, 20, 93
CHANGE_SPEED, JUMP = 178, 177


def do(command: int, p1: float = 0.0, p2: float = 0.0) -> MissionItem:
    return MissionItem(frame=2, command=command, param1=p1, param2=p2)


def over(rig: Rig, limit_s: float = 300.0) -> list[int]:
    """Sail to the end of the mission; the items reported as reached."""
    rig.peer.heard.clear()
    rig.until(lambda: rig.mode != "AUTO", limit_s)
    rig.run(0.1)
    return [message.seq for message in rig.peer.said("MISSION_ITEM_REACHED")]


def test_a_time_at_a_waypoint_is_spent_there() -> None:
    rig = Rig().sail(waypoint(20.0, 0.0, command=LOITER_TIME, param1=20.0), waypoint(20.0, 20.0))
    rig.until(lambda: bool(rig.peer.said("MISSION_ITEM_REACHED")), 60.0)
    worst_m = 0.0
    for _ in range(19):
        rig.run(1.0)
        worst_m = max(worst_m, rig.offset_m(20.0, 0.0))
    assert worst_m < 3.5
    assert rig.boat.vehicle.progress.current_seq == 1
    assert over(rig) == [2]


def test_a_delay_keeps_station_and_the_mission_goes_on() -> None:
    rig = Rig().sail(waypoint(15.0, 0.0), do(DELAY, 15.0), waypoint(15.0, 15.0))
    began_s = rig.now_s
    assert over(rig) == [1, 2, 3]
    assert rig.now_s - began_s > 15.0 + 25.0 / 2.0


def test_a_change_of_speed_is_kept_on_the_water() -> None:
    rig = Rig().sail(do(CHANGE_SPEED, 1.0, 1.0), waypoint(60.0, 0.0))
    rig.run(20.0)
    truth = rig.world.truth
    assert math.hypot(truth.north_m_s, truth.east_m_s) == pytest.approx(1.0, abs=0.15)


def test_a_jump_sails_the_leg_again() -> None:
    rig = Rig().sail(waypoint(15.0, 0.0), waypoint(15.0, 15.0), do(JUMP, 1.0, 1.0), waypoint(0.0, 15.0))
    assert over(rig) == [1, 2, 1, 2, 4]


def test_the_way_home_at_the_end_leads_home() -> None:
    rig = Rig().sail(waypoint(30.0, 0.0), waypoint(30.0, 30.0), do(RTL))
    assert over(rig) == [1, 2]
    assert rig.mode == "RTL"
    rig.until(lambda: any("RTL: arrived" in text for text in rig.peer.texts), 60.0)
    assert rig.offset_m(0.0, 0.0) < 3.5


@pytest.mark.parametrize(("behave", "mode"), [(0, "HOLD"), (1, "LOITER")])
def test_after_the_last_item_the_boat_does_as_it_was_told(behave: int, mode: str) -> None:
    rig = Rig(config={"mission.done_behave": behave}).sail(waypoint(15.0, 0.0))
    over(rig)
    assert rig.mode == mode
    if mode == "LOITER":
        rig.run(30.0)
        assert rig.offset_m(15.0, 0.0) < 3.0


def test_a_mission_interrupted_by_hold_is_taken_up_where_it_was_left() -> None:
    rig = Rig().sail(waypoint(30.0, 0.0), waypoint(30.0, 30.0), waypoint(0.0, 30.0))
    rig.until(lambda: rig.boat.vehicle.progress.current_seq == 2, 60.0)
    rig.run(3.0)
    assert rig.set_mode(4) == OK
    rig.run(10.0)
    assert rig.set_mode(10) == OK
    assert rig.boat.vehicle.progress.current_seq == 2
    assert over(rig) == [2, 3]


def test_a_mission_survives_a_restart_and_can_be_sailed_again() -> None:
    rig = Rig().sail(waypoint(15.0, 0.0), waypoint(15.0, 15.0))
    over(rig)
    rig.reboot()
    rig.ready()
    assert rig.arm() == OK
    assert rig.ask(dialect.MAV_CMD_MISSION_START) == OK
    assert over(rig) == [1, 2]
