"""The rudder boat on ground truth: it sails, stays and comes back without turning on the spot."""

import math

import pytest
from boat_rig import OK, Rig, waypoint
from fence_rig import box, fenced, least_margin_m, polygon

from companion.mavlink.dialect import dialect
from sitl.world.faults.catalogue import FaultSetting

RUDDER = "boat.model=rudder"
CURRENT = ("environment.current_m_s=0.5", "environment.current_to_deg=90.0")
WIND = ("environment.wind_m_s=3.0", "environment.gust_m_s=5.0")
LOITER, RTL, MANUAL, GUIDED = 5, 11, 0, 15
RADIUS_M, STATION_M = 2.5, 1.5


def rudder_boat(*settings: str, config: dict[str, object] | None = None) -> Rig:
    return Rig("open", RUDDER, *settings, config=config).ready()


@pytest.mark.parametrize("water", [CURRENT, WIND], ids=["current", "wind"])
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


def test_stopped_before_the_fence_it_turns_around_in_several_moves() -> None:
    rig = fenced(rudder_boat(), *polygon(box(-30.0, -100.0, 30.0, 100.0)))
    assert rig.set_mode(GUIDED) == OK
    assert rig.arm() == OK
    least = math.inf
    course = math.radians(40.0)
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


@pytest.mark.parametrize(
    ("what", "kind", "told"),
    [
        ("rudder", "off", "Failsafe: Steering lost: rudder or motor has no effect"),
        ("rudder", "stuck", "Failsafe: Steering lost: rudder or motor has no effect"),
        ("motor_left", "off", "Failsafe: Steering lost: rudder or motor has no effect"),
        ("motor_left", "wrong", "Failsafe: Steering lost: motor reversed"),
    ],
)
def test_a_boat_that_cannot_steer_tries_to_come_free_then_drifts(what: str, kind: str, told: str) -> None:
    rig = Rig("open", RUDDER).sail(waypoint(60.0, 0.0), waypoint(60.0, 60.0), waypoint(0.0, 60.0))
    rig.run(30.0)
    rig.peer.forget()
    rig.world.electronics.faults.begin(FaultSetting(what=what, kind=kind))
    rig.until(lambda: rig.mode == "HOLD", 200.0)
    texts = rig.peer.texts
    assert texts[:2] == [told, "Clearing the propellers"]
    # one more if the drifting boat turns by chance, two more if another failsafe is named after the first
    assert 2 <= texts.count("Clearing the propellers") <= 4
    rig.run(1.0)
    assert rig.boat.command.left == rig.boat.command.rudder == 0.0


@pytest.mark.parametrize("what", ["rudder", "motor_left"])
def test_a_part_that_works_badly_does_not_end_the_mission(what: str) -> None:
    rig = Rig("open", RUDDER).sail(waypoint(40.0, 0.0), waypoint(40.0, 40.0))
    kind, size = ("wrong", 10.0) if what == "rudder" else ("weed", 0.2)
    rig.world.electronics.faults.begin(FaultSetting(what=what, kind=kind, size=size))
    rig.until(lambda: rig.boat.vehicle.progress.finished, 150.0)
    assert not any(text.startswith("Failsafe") for text in rig.peer.texts)


def test_gusts_do_not_look_like_a_lost_rudder() -> None:
    gusts = ("environment.wind_m_s=6.0", "environment.gust_m_s=10.0", "environment.wind_from_deg=0.0")
    rig = Rig("open", RUDDER, *gusts).sail(waypoint(40.0, 0.0), waypoint(40.0, 40.0), waypoint(0.0, 40.0))
    rig.until(lambda: rig.boat.vehicle.progress.finished, 250.0)
    assert not any(text.startswith("Failsafe") for text in rig.peer.texts)


def test_outputs_are_those_of_rovers_steering_and_throttle() -> None:
    rig = rudder_boat()
    assert rig.set_mode(MANUAL) == OK
    assert rig.arm() == OK
    for _ in range(30):
        rig.peer.send(dialect.MAVLink_manual_control_message(1, 0, 400, 500, 0, 0))
        rig.run(0.1)
    latest = rig.peer.said("SERVO_OUTPUT_RAW")[-1]
    command = rig.boat.command
    assert latest.servo1_raw == pytest.approx(1500 + 500 * 0.4, abs=3)  # GroundSteering
    assert latest.servo3_raw == round(1500 + 500 * command.left) > 1600  # Throttle
    assert latest.servo2_raw == latest.servo4_raw == 0


def test_the_autotune_measures_the_rudder_and_the_thruster_calibration_is_refused() -> None:
    rig = rudder_boat()
    assert rig.set_mode(LOITER) == OK
    assert rig.arm() == OK
    rig.run(3.0)
    assert rig.ask(dialect.MAV_CMD_USER_1, 1.0) == 1
    assert rig.peer.texts == ["Thruster calibration: measures two motors; set a rudder boat's by hand"]
    assert rig.ask(dialect.MAV_CMD_DO_AUTOTUNE_ENABLE, 1.0) == 5
    for _ in range(60):
        rig.run(5.0)
        rig.peer.listen()
        if not rig.boat.calibration.is_running:
            break
    assert "Heading autotune done: 3 parameters set" in rig.peer.texts
    assert 3.0 < rig.boat.parameters.config.heading.kp < 20.0


@pytest.mark.parametrize(
    ("motor", "result", "left", "rudder"),
    [(1, 0, 0.3, 0.0), (2, 0, 0.0, 0.3), (3, 4, 0.0, 0.0), (4, 4, 0.0, 0.0)],
)
def test_the_motor_test_turns_motor_or_rudder(motor: int, result: int, left: float, rudder: float) -> None:
    rig = rudder_boat()
    assert rig.ask(dialect.MAV_CMD_DO_MOTOR_TEST, motor, 0.0, 30.0, 2.0) == result
    rig.run(1.0)
    command = rig.boat.command
    assert (command.left, command.right, command.rudder) == pytest.approx((left, left, rudder))
    if result:
        assert "Motor test: this boat has one motor: test throttle or steering" in rig.peer.texts
