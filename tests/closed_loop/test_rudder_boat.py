"""The rudder boat on ground truth: it sails, stays and comes back without turning on the spot."""

import math

import pytest
from boat_rig import OK, Rig, waypoint
from fence_rig import box, fenced, least_margin_m, polygon
from sailing_rig import CURRENT, VELOCITY, aim, armed, begin, is_stopped, push, tells

from companion.core.modes import Mode
from companion.mavlink.dialect import dialect

RUDDER = "boat.model=rudder"
WIND = ("environment.wind_m_s=3.0", "environment.gust_m_s=5.0")
RADIUS_M, STATION_M = 2.5, 1.5


def rudder_boat(mode: int, *settings: str) -> Rig:
    return armed(mode, RUDDER, *settings)


def test_it_keeps_station_within_its_radius_and_three_turning_radii() -> None:
    rig = rudder_boat(Mode.LOITER, *WIND)
    at = rig.world.truth
    away_m = []
    for _ in range(240):
        rig.run(0.5)
        away_m.append(rig.offset_m(at.north_m, at.east_m))
    assert max(away_m) < STATION_M + 3.0 * RADIUS_M
    assert sorted(away_m)[120] < 3.0  # measured over five minutes: 1.7 m
    assert rig.mode == "LOITER"


def test_a_leg_straight_back_is_sailed_round_in_a_current_and_then_it_comes_home() -> None:
    rig = Rig("open", RUDDER, *CURRENT).sail(waypoint(25.0, 0.0), waypoint(0.0, 0.0), waypoint(0.0, 30.0))
    rig.until(lambda: rig.offset_m(0.0, 30.0) < 2.0, 150.0)
    assert not tells(rig, "Failsafe")
    assert rig.set_mode(Mode.RTL) == OK
    rig.until(lambda: rig.offset_m(0.0, 0.0) < 2.5, 120.0)
    rig.run(40.0)
    assert rig.offset_m(0.0, 0.0) < STATION_M + 3.0 * RADIUS_M


def test_stopped_before_the_fence_it_turns_around_in_several_moves() -> None:
    rig = armed(Mode.GUIDED, rig=fenced(Rig("open", RUDDER), *polygon(box(-30.0, -100.0, 20.0, 100.0))))
    least, course = math.inf, math.radians(40.0)
    for _ in range(35):
        aim(rig, VELOCITY, velocity=(1.2 * math.cos(course), 1.2 * math.sin(course)))
        least = min(least, least_margin_m(rig, 1.0))
    assert 0.3 < least < 6.0
    assert rig.set_mode(Mode.RTL) == OK
    least = min(least, least_margin_m(rig, 75.0))
    assert least > 0.3
    assert rig.offset_m(0.0, 0.0) < STATION_M + 3.0 * RADIUS_M


def test_a_stick_to_starboard_turns_the_bow_to_starboard_and_disarming_stops_motor_and_rudder() -> None:
    rig = rudder_boat(Mode.MANUAL)
    push(rig, 400, 500, 6.0)
    assert rig.world._rudder is not None
    assert rig.world._rudder.angle_rad == pytest.approx(0.4 * math.radians(35.0), rel=0.05)
    assert rig.world.truth.yaw_rate_rad_s > 0.1
    command = rig.boat.command
    assert command.left == command.right > 0.3
    latest = rig.peer.said("SERVO_OUTPUT_RAW")[-1]
    assert latest.servo1_raw == pytest.approx(1500 + 500 * 0.4, abs=3)  # GroundSteering
    assert latest.servo3_raw == round(1500 + 500 * command.left) > 1600  # Throttle
    assert latest.servo2_raw == latest.servo4_raw == 0
    assert rig.ask(dialect.MAV_CMD_COMPONENT_ARM_DISARM, 0.0, 21196.0) == OK
    rig.run(0.5)
    assert is_stopped(rig)
    assert rig.world._rudder.angle_rad == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(
    ("what", "kind", "why"),
    [
        ("rudder", "stuck", "Failsafe: Steering lost: rudder or motor has no effect"),
        ("motor_left", "wrong", "Failsafe: Steering lost: motor reversed"),
    ],
)
def test_a_boat_that_cannot_steer_tries_to_come_free_then_drifts(what: str, kind: str, why: str) -> None:
    rig = Rig("open", RUDDER).sail(waypoint(40.0, 0.0), waypoint(40.0, 60.0), waypoint(0.0, 60.0))
    rig.run(20.0)
    rig.peer.forget()
    begin(rig, what, kind)
    rig.until(lambda: rig.mode == "HOLD", 200.0)
    texts = rig.peer.texts
    assert texts[:2] == [why, "Clearing the propellers"]
    # one more if the drifting boat turns by chance, two more if another failsafe is named after the first
    assert 2 <= texts.count("Clearing the propellers") <= 4
    rig.run(1.0)
    assert is_stopped(rig)


def test_the_autotune_measures_the_rudder_and_the_thruster_calibration_is_refused() -> None:
    rig = rudder_boat(Mode.LOITER)
    rig.run(3.0)
    assert rig.ask(dialect.MAV_CMD_USER_1, 1.0) == 1
    assert rig.peer.texts == ["Thruster calibration: measures two motors; set a rudder boat's by hand"]
    assert rig.ask(dialect.MAV_CMD_DO_AUTOTUNE_ENABLE, 1.0) == 5
    rig.until(lambda: not rig.boat.calibration.is_running, 300.0)
    rig.run(0.1)
    assert "Heading autotune done: 5 parameters set" in rig.peer.texts
    assert 3.0 < rig.boat.parameters.config.heading.kp < 20.0
