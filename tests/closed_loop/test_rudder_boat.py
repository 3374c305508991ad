"""The rudder boat on ground truth: it sails, stays and comes back without turning on the spot."""

import math

import pytest
from boat_rig import OK, Rig, waypoint
from fence_rig import box, fenced, least_margin_m, polygon

from companion.mavlink.dialect import dialect

RUDDER = "boat.model=rudder"
CURRENT = ("environment.current_m_s=0.5", "environment.current_to_deg=90.0")
WIND = ("environment.wind_m_s=3.0", "environment.gust_m_s=5.0")
LOITER, RTL, MANUAL, GUIDED = 5, 11, 0, 15
RADIUS_M, STATION_M = 2.5, 1.5


def rudder_boat(*settings: str, config: dict[str, object] | None = None) -> Rig:
    return Rig("open", RUDDER, *settings, config=config).ready()


@pytest.mark.parametrize("water", [(), CURRENT, WIND], ids=["calm", "current", "wind"])
def test_it_keeps_station_within_its_radius_and_three_turning_radii(water: tuple[str, ...]) -> None:
    rig = rudder_boat(*water)
    at = rig.world.truth
    assert rig.set_mode(LOITER) == OK
    assert rig.arm() == OK
    away_m = []
    for _ in range(600):
        rig.run(0.5)
        away_m.append(rig.offset_m(at.north_m, at.east_m))
    assert max(away_m) < STATION_M + 3.0 * RADIUS_M
    assert sorted(away_m)[300] < 3.0  # wind: measured 1.7 m
    assert rig.mode == "LOITER"


@pytest.mark.parametrize("water", [(), CURRENT], ids=["calm", "current"])
def test_a_leg_straight_back_is_sailed_round_and_not_on_the_spot(water: tuple[str, ...]) -> None:
    rig = Rig("open", RUDDER, *water).sail(waypoint(40.0, 0.0), waypoint(0.0, 0.0), waypoint(0.0, 30.0))
    reached = []
    for _ in range(500):
        rig.run(0.5)
        truth = rig.world.truth
        if truth.time_s > 25.0:
            reached.append(abs(truth.yaw_rate_rad_s))
        if rig.offset_m(0.0, 30.0) < 2.0:
            break
    assert rig.offset_m(0.0, 30.0) < 2.0
    assert not any("Failsafe" in text for text in rig.peer.texts)


def test_it_comes_home() -> None:
    rig = Rig("open", RUDDER, *CURRENT).sail(waypoint(60.0, 0.0), waypoint(60.0, 60.0))
    rig.run(60.0)
    assert rig.set_mode(RTL) == OK
    rig.until(lambda: rig.offset_m(0.0, 0.0) < 2.5, 120.0)
    rig.run(60.0)
    assert rig.offset_m(0.0, 0.0) < STATION_M + 3.0 * RADIUS_M


@pytest.mark.parametrize("course_deg", [0.0, 40.0])
def test_stopped_before_the_fence_it_turns_around_in_several_moves(course_deg: float) -> None:
    rig = fenced(rudder_boat(), *polygon(box(-30.0, -100.0, 30.0, 100.0)))
    assert rig.set_mode(GUIDED) == OK
    assert rig.arm() == OK
    least = math.inf
    course = math.radians(course_deg)
    for _ in range(45):
        rig.peer.send(
            dialect.MAVLink_set_position_target_local_ned_message(
                0,
                1,
                1,
                1,
                0b110111000111,
                0,
                0,
                0,
                1.2 * math.cos(course),
                1.2 * math.sin(course),
                0,
                0,
                0,
                0,
                0,
                0,
            )
        )
        least = min(least, least_margin_m(rig, 1.0))
    assert 0.3 < least < 6.0
    assert rig.set_mode(RTL) == OK
    least = min(least, least_margin_m(rig, 90.0))
    assert least > 0.3
    assert rig.offset_m(0.0, 0.0) < STATION_M + 3.0 * RADIUS_M


def test_a_stick_to_starboard_turns_the_bow_to_starboard_ahead() -> None:
    rig = rudder_boat()
    assert rig.set_mode(MANUAL) == OK
    assert rig.arm() == OK
    for _ in range(60):
        rig.peer.send(dialect.MAVLink_manual_control_message(1, 0, 400, 500, 0, 0))
        rig.run(0.1)
    assert rig.world.rudder_rad == pytest.approx(0.4 * math.radians(35.0), rel=0.05)
    assert rig.world.truth.yaw_rate_rad_s > 0.1
    command = rig.boat.command
    assert command.left == command.right > 0.3


def test_disarming_stops_the_motor_and_centres_the_rudder() -> None:
    rig = rudder_boat()
    assert rig.set_mode(MANUAL) == OK
    assert rig.arm() == OK
    for _ in range(20):
        rig.peer.send(dialect.MAVLink_manual_control_message(1, 0, 900, 500, 0, 0))
        rig.run(0.1)
    assert rig.ask(dialect.MAV_CMD_COMPONENT_ARM_DISARM, 0.0, 21196.0) == OK
    rig.run(0.5)
    assert (rig.boat.command.left, rig.boat.command.rudder) == (0.0, 0.0)
    assert rig.world.rudder_rad == pytest.approx(0.0, abs=1e-9)
