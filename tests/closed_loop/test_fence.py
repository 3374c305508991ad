"""The fence on ground truth: the boat stops before it, comes back from beyond it."""

import math

import pytest
from boat_rig import OK, Rig
from fence_rig import L_WATER, RALLY, box, fenced, item, least_margin_m, polygon

from companion.core.geo import Point
from companion.mavlink.dialect import Message, dialect
from companion.mavlink.items import MissionType
from companion.mavlink.transfer import Completed

ONTO_IT = ("environment.current_m_s=0.5", "environment.current_to_deg=0.0")
CALM: tuple[str, ...] = ()


def armed(rig: Rig, mode: int) -> Rig:
    rig.ready()
    assert rig.set_mode(mode) == OK
    assert rig.arm() == OK
    return rig


def velocity(rig: Rig, north_m_s: float, east_m_s: float) -> None:
    """SET_POSITION_TARGET_LOCAL_NED with a velocity alone."""
    rig.peer.send(
        dialect.MAVLink_set_position_target_local_ned_message(
            0, 1, 1, 1, 0b110111000111, 0, 0, 0, north_m_s, east_m_s, 0, 0, 0, 0, 0, 0
        )
    )


def sticks(steering: int, throttle: int) -> Message:
    message: Message = dialect.MAVLink_manual_control_message(1, 0, steering, throttle, 0, 0)
    return message


@pytest.mark.parametrize("water", [CALM, ONTO_IT], ids=["calm", "current"])
@pytest.mark.parametrize("course_deg", [0.0, 40.0])
def test_a_boat_told_to_sail_at_the_line_stops_inside(water: tuple[str, ...], course_deg: float) -> None:
    rig = fenced(Rig("open", *water), *polygon(box(-30.0, -100.0, 30.0, 100.0)))
    armed(rig, 15)
    least = math.inf
    for _ in range(30):
        course = math.radians(course_deg)
        velocity(rig, 2.0 * math.cos(course), 2.0 * math.sin(course))
        least = min(least, least_margin_m(rig, 1.0))
    assert 0.3 < least < 4.0
    assert "Fence ahead: keeping station" in rig.peer.texts


@pytest.mark.parametrize("water", [CALM, ONTO_IT], ids=["calm", "current"])
@pytest.mark.parametrize("throttle", [1000, -1000])
def test_full_throttle_by_hand_does_not_take_the_boat_out(water: tuple[str, ...], throttle: int) -> None:
    rig = fenced(Rig("open", *water), *polygon(box(-20.0, -100.0, 30.0, 100.0)))
    armed(rig, 0)
    least = math.inf
    for _ in range(100):
        rig.peer.send(sticks(0, throttle))
        least = min(least, least_margin_m(rig, 0.4))
    assert 0.3 < least < 4.0


def go_to(rig: Rig, north_m: float, east_m: float) -> None:
    frame, start = rig.scenario.frame, rig.scenario.start
    there = frame.to_global(start._replace(north_m=north_m, east_m=east_m))
    x, y = round(there.lat_deg * 1e7), round(there.lon_deg * 1e7)
    rig.peer.command_int(192, -1, 1, 0, math.nan, x=x, y=y)
    rig.receive()


@pytest.mark.parametrize("to_deg", [None, 0.0, 90.0, 225.0])
def test_rtl_follows_the_water_round_the_corner(to_deg: float | None) -> None:
    water = () if to_deg is None else (f"environment.current_to_deg={to_deg}", "environment.current_m_s=0.5")
    rig = fenced(Rig("open", *water), *polygon(L_WATER))
    armed(rig, 15)
    go_to(rig, 0.0, 60.0)
    rig.until(lambda: rig.offset_m(0.0, 60.0) < 4.0, 90.0)
    go_to(rig, 60.0, 60.0)
    rig.until(lambda: rig.offset_m(60.0, 60.0) < 4.0, 90.0)
    assert rig.set_mode(11) == OK
    began_s, least = rig.now_s, math.inf
    while not any("RTL: arrived" in text for text in rig.peer.texts):
        least = min(least, least_margin_m(rig, 1.0))
        assert rig.now_s - began_s < 120.0
    assert least > 1.5
    assert rig.offset_m(0.0, 0.0) < 3.5
    assert rig.now_s - began_s < 75.0  # 99 m of water at 2 m/s, two stops and a corner
    rig.run(20.0)
    assert rig.offset_m(0.0, 0.0) < 3.5


def test_rtl_goes_to_the_rally_point_that_is_nearest_by_water() -> None:
    rig = fenced(Rig(), *polygon(L_WATER))
    armed(rig, 15)
    rally = [item(70.0, 70.0, RALLY), item(0.0, 20.0, RALLY)]
    assert isinstance(rig.upload(rally, mission_type=MissionType.RALLY), Completed)
    go_to(rig, 0.0, 70.0)
    rig.until(lambda: rig.offset_m(0.0, 70.0) < 4.0, 90.0)
    go_to(rig, 40.0, 60.0)
    rig.until(lambda: rig.offset_m(40.0, 60.0) < 4.0, 90.0)
    assert rig.set_mode(11) == OK
    rig.until(lambda: any("RTL: arrived" in text for text in rig.peer.texts), 60.0)
    assert rig.offset_m(70.0, 70.0) < 4.0
    assert rig.boat.vehicle.route.home_distance_m(Point(70.0, 60.0)) == pytest.approx(10.0, abs=0.2)


@pytest.mark.parametrize("action", [1, 6], ids=["RTL", "LOITER"])
@pytest.mark.parametrize("water", [CALM, ONTO_IT], ids=["calm", "current"])
def test_a_boat_beyond_the_fence_comes_back(water: tuple[str, ...], action: int) -> None:
    rig = Rig("open", *water, config={"failsafe.fence_action": action})
    armed(rig, 15)
    go_to(rig, 30.0, 0.0)
    rig.until(lambda: rig.offset_m(30.0, 0.0) < 3.0, 60.0)
    fenced(rig, *polygon(box(-25.0, -20.0, 20.0, 20.0)))
    rig.run(3.0)  # FENCE_STATUS comes every two seconds
    assert rig.mode == ("RTL" if action == 1 else "LOITER")
    assert any(text.startswith("Failsafe: Outside the fence by ") for text in rig.peer.texts)
    assert rig.peer.said("FENCE_STATUS")[-1].breach_status == 1
    geofence = dialect.MAV_SYS_STATUS_GEOFENCE
    assert not rig.peer.said("SYS_STATUS")[-1].onboard_control_sensors_health & geofence
    rig.until(lambda: "Failsafe over: inside the fence again" in rig.peer.texts, 40.0)
    rig.run(30.0)
    assert least_margin_m(rig, 20.0) > 1.0
    if action == 1:
        assert rig.offset_m(0.0, 0.0) < 4.0
    else:
        assert rig.world.truth.north_m > 10.0
    said = rig.peer.said("FENCE_STATUS")[-1]
    assert (said.breach_status, said.breach_count) == (0, 1)
    assert rig.peer.said("SYS_STATUS")[-1].onboard_control_sensors_health & geofence


def test_a_boat_outside_its_fence_does_not_arm_and_says_why() -> None:
    rig = Rig().ready()
    fenced(rig, *polygon(box(50.0, 50.0, 90.0, 90.0)))
    rig.run(0.5)
    assert rig.arm() != OK
    assert any(text.startswith("Arm: Fence: the boat is outside") for text in rig.peer.texts)
    assert rig.ask(dialect.MAV_CMD_DO_FENCE_ENABLE, 0.0) == OK
    rig.run(0.1)
    assert rig.arm() == OK
