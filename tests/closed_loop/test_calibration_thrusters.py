"""The thruster calibration on a boat with a weak right motor, in wind and current, against the truth."""

import math
from collections.abc import Callable

import pytest
from boat_rig import OK, Rig, waypoint

from companion.core.requests import ManualControl
from companion.core.storage import MemoryStorage
from companion.mavlink.dialect import dialect
from companion.mavlink.items import MissionItem, MissionType
from sitl.world.world import World

CALIBRATE, HOLD, LOITER, GUIDED = dialect.MAV_CMD_USER_1, 4, 5, 15
REJECTED_FOR_NOW, IN_PROGRESS, CANCELLED = 1, 5, 6
WATER = (
    "environment.wind_m_s=3.0",
    "environment.current_m_s=0.3",
    "environment.current_to_deg=60.0",
    "sensors.sonar.fitted=false",  # its ghosts would have runs repeated
    "seed=3",
)
WEAK = 0.8
DEAD = 0.045  # of the lake boat: no_load_a times all resistance, over the pack's voltage


# A receiver and a compass without fault, so that only the motors lead the boat astray.
EXACT = (
    "sensors.sonar.fitted=false",
    "sensors.gnss.noise_m=0.0",
    "sensors.gnss.wander_m=0.0",
    "sensors.gnss.velocity_noise_m_s=0.0",
    "sensors.gnss.latency_s=0.1",
    "sensors.gnss.jitter_s=0.0",
    "sensors.compass.bias_deg=0.0",
    "sensors.compass.declination_deg=0.0",
    "vehicle.parts.compass.correction_rad=0.0",
    "sensors.compass.turn_tilt_share=0.0",
    "sensors.compass.gyro_scale=1.0",
)


def lopsided(storage: MemoryStorage | None = None) -> Rig:
    """Armed, keeping station, with a right motor that gets 0.8 of its command."""
    rig = Rig("open", *WATER, storage=storage).ready()
    weaken(rig.world)
    assert rig.set_mode(LOITER) == OK
    assert rig.arm() == OK
    rig.run(5.0)
    return rig


def weaken(world: World) -> None:
    world._thrusters.right.gain = WEAK


def values(rig: Rig) -> dict[str, float]:
    parameters = rig.boat.parameters
    return {row.name: parameters.value(row) for row in parameters.rows}


def over(rig: Rig, limit_s: float) -> list[int]:
    """Wait for the trial's end; the results that its command has been answered with."""
    results: list[int] = []
    while rig.boat.calibration.is_running:
        assert (limit_s := limit_s - 1.0) > 0.0, "the trial does not end"
        rig.run(1.0)
        results += [one.result for one in rig.peer.said("COMMAND_ACK")]
        rig.peer.heard = [one for one in rig.peer.heard if one.get_type() == "STATUSTEXT"]
    rig.run(0.1)
    return results + [one.result for one in rig.peer.said("COMMAND_ACK")]


@pytest.fixture(scope="module")
def calibrated() -> Rig:
    rig = lopsided(MemoryStorage())
    assert rig.ask(CALIBRATE, 1.0) == IN_PROGRESS
    answers = over(rig, 900.0)
    assert answers[-1] == OK, rig.peer.texts
    assert set(answers[:-1]) == {IN_PROGRESS}
    return rig


def test_dead_bands_and_gains_are_those_of_the_motors(calibrated: Rig) -> None:
    found = calibrated.boat.parameters.config.thrusters
    assert found.left_ahead == pytest.approx(DEAD, abs=0.025)
    assert found.left_astern == pytest.approx(DEAD, abs=0.025)
    assert found.right_ahead == pytest.approx(DEAD / WEAK, abs=0.03)
    assert found.right_astern == pytest.approx(DEAD / WEAK, abs=0.03)
    assert found.right_gain == 1.0
    assert found.left_gain == pytest.approx((WEAK - DEAD) / (1.0 - DEAD), abs=0.045)
    assert found.asymmetry == pytest.approx(1.0 / math.sqrt(0.55), rel=0.08)


def test_speeds_are_those_through_the_water_whatever_the_current(calibrated: Rig) -> None:
    config = calibrated.boat.parameters.config
    assert config.handling.top_speed_m_s == pytest.approx(speed_through_water(1.0), rel=0.04)
    assert speed_through_water(config.speed.cruise_throttle) == pytest.approx(2.0, rel=0.06)
    assert config.estimation.surge_time_s == pytest.approx(2.8, rel=0.25)  # Doppler noise of 0.08 m/s


def speed_through_water(share: float) -> float:
    """What the weak motor and an equal one come to, in still air and water."""
    world = World(Rig("open").scenario)
    for thruster in (world._thrusters.left, world._thrusters.right):
        thruster.gain = WEAK
    command = DEAD / WEAK + (1.0 - DEAD / WEAK) * share
    world._motors.write(command, command)
    for _ in range(2000):
        world.step(0.02)
    return world.truth.surge_m_s


def test_the_turn_rate_is_what_full_steering_reaches(calibrated: Rig) -> None:
    world = World(Rig("open").scenario)
    for thruster in (world._thrusters.left, world._thrusters.right):
        thruster.gain = WEAK
    world._motors.write(0.78, 0.78)
    for _ in range(1500):
        world.step(0.02)
    world._motors.write(1.0, -1.0)
    for _ in range(95):
        world.step(0.02)
    found = calibrated.boat.parameters.config.handling.turn_rate_rad_s
    assert found == pytest.approx(world.truth.yaw_rate_rad_s, rel=0.12)


def test_all_is_told_and_kept_over_a_restart(calibrated: Rig) -> None:
    texts = calibrated.peer.texts
    assert any(text.startswith("Thruster calibration done: 11 parameters") for text in texts)
    assert any(text.startswith("MOT_L_GAIN 1 -> 0.") for text in texts)
    found = calibrated.boat.parameters.config
    again = Rig("open", *WATER, storage=calibrated.storage)
    assert again.boat.parameters.config.thrusters == found.thrusters
    assert again.boat.parameters.config.handling == found.handling


def test_by_hand_the_boat_goes_straight_once_it_is_calibrated(calibrated: Rig) -> None:
    def turned_rad(storage: MemoryStorage | None) -> float:
        rig = Rig("open", "sensors.sonar.fitted=false", storage=storage).ready()
        weaken(rig.world)
        assert rig.set_mode(0) == OK
        assert rig.arm() == OK
        for _ in range(20):
            rig.boat.vehicle.request(ManualControl(0.6, 0.0))
            rig.run(0.5)
        return abs(rig.world._hull.heading_rad)

    assert isinstance(calibrated.storage, MemoryStorage)
    assert turned_rad(None) > 1.0
    assert turned_rad(calibrated.storage) < 0.25


def test_a_leg_is_begun_with_less_of_a_swerve_once_the_boat_is_calibrated(calibrated: Rig) -> None:
    def astray_m(storage: MemoryStorage | None) -> float:
        rig = Rig("open", *EXACT, storage=storage).ready()
        weaken(rig.world)
        start = rig.world.truth
        rig.sail(waypoint(start.north_m + 80.0, start.east_m))
        worst = 0.0
        for _ in range(300):
            rig.step(5)
            rig.peer.listen()
            worst = max(worst, abs(rig.world.truth.east_m - start.east_m))
        return worst

    assert isinstance(calibrated.storage, MemoryStorage)
    before, after = astray_m(None), astray_m(calibrated.storage)
    assert after < 0.6 * before


@pytest.mark.parametrize(
    ("breaks", "why"),
    [
        (lambda rig: rig.set_mode(HOLD), "mode HOLD"),
        (lambda rig: rig.set_mode(GUIDED), "mode GUIDED"),
        (lambda rig: rig.ask(dialect.MAV_CMD_COMPONENT_ARM_DISARM, 0.0), "disarmed"),
        (lambda rig: rig.ask(dialect.MAV_CMD_DO_REPOSITION, -1, 1, 0, 0, 50.001, -1.2), "mode GUIDED"),
        (lambda rig: rig.ask(dialect.MAV_CMD_INJECT_FAILURE, 4, 1, 0), "failsafe"),
    ],
)
def test_anything_else_breaks_it_off_and_nothing_is_changed(
    breaks: Callable[[Rig], object], why: str
) -> None:
    rig = lopsided()
    before = values(rig)
    assert rig.ask(CALIBRATE, 1.0) == IN_PROGRESS
    rig.run(60.0)
    assert rig.boat.calibration.is_running
    rig.peer.forget()
    breaks(rig)
    rig.until(lambda: not rig.boat.calibration.is_running, 5.0)
    rig.run(0.1)
    assert any(why in text for text in rig.peer.texts), rig.peer.texts
    assert values(rig) == before
    assert not rig.boat.calibration.is_bare


def test_the_same_command_breaks_it_off() -> None:
    rig = lopsided()
    assert rig.ask(CALIBRATE, 1.0) == IN_PROGRESS
    assert rig.ask(CALIBRATE, 1.0) == IN_PROGRESS
    assert rig.ask(dialect.MAV_CMD_DO_AUTOTUNE_ENABLE, 1.0) == REJECTED_FOR_NOW
    assert rig.ask(CALIBRATE, 0.0) == CANCELLED
    assert not rig.boat.calibration.is_running
    assert rig.ask(CALIBRATE, 0.0) == OK


def test_it_is_refused_with_a_reason() -> None:
    rig = Rig("open", *WATER).ready()
    assert rig.ask(CALIBRATE, 1.0) == REJECTED_FOR_NOW
    assert "Thruster calibration: arm first" in rig.peer.texts
    assert rig.arm() == OK
    assert rig.ask(CALIBRATE, 1.0) == REJECTED_FOR_NOW
    assert "Thruster calibration: choose LOITER first" in rig.peer.texts
    rig.set_mode(LOITER)
    assert rig.ask(CALIBRATE, 1.0, 10.0) == REJECTED_FOR_NOW
    assert "Thruster calibration: needs 24.0 m of free water all round" in rig.peer.texts


def test_it_keeps_inside_the_fence_and_asks_for_room_there() -> None:
    rig = Rig("open", *WATER).ready()

    def corner(north_m: float, east_m: float) -> MissionItem:
        return waypoint(
            north_m, east_m, command=dialect.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION, param1=4.0
        )

    def fence(half_m: float) -> None:
        corners = [corner(n * half_m, e * half_m) for n, e in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        rig.upload(corners, mission_type=MissionType.FENCE)

    fence(20.0)
    rig.set_mode(LOITER)
    assert rig.arm() == OK
    rig.run(2.0)
    assert rig.ask(CALIBRATE, 1.0) == REJECTED_FOR_NOW
    assert "needs 24.0 m" in rig.peer.texts[-1]
    assert rig.ask(CALIBRATE, 1.0, 60.0) == REJECTED_FOR_NOW
    assert "the fence leaves" in rig.peer.texts[-1]
    fence(50.0)
    rig.run(0.1)
    assert rig.ask(CALIBRATE, 1.0) == IN_PROGRESS
    assert rig.boat.calibration.radius_m < 50.0


def test_an_idle_trial_costs_no_guidance() -> None:
    rig = lopsided()
    assert not rig.boat.calibration.is_running
    assert rig.boat.calibration.take_result() is None
