"""The thruster calibration on a boat with a weak right motor, in wind and current, against the truth."""

import math

import pytest
from boat_rig import OK, Rig
from fence_rig import box, fenced, polygon
from sailing_rig import tells

from companion.core.modes import Mode
from companion.core.requests import ManualControl
from companion.core.storage import MemoryStorage, Storage
from companion.mavlink.dialect import dialect
from sitl.world.world import World

CALIBRATE = dialect.MAV_CMD_USER_1
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


def lopsided() -> Rig:
    """Armed, keeping station, with a right motor that gets 0.8 of its command."""
    rig = Rig("open", *WATER, storage=MemoryStorage()).ready()
    rig.world._thrusters.right.gain = WEAK
    assert rig.set_mode(Mode.LOITER) == OK
    assert rig.arm() == OK
    rig.run(5.0)
    return rig


def over(rig: Rig, limit_s: float) -> list[int]:
    """Wait for the trial's end; the results that its command has been answered with."""
    rig.peer.forget()
    while rig.boat.calibration.is_running:
        assert (limit_s := limit_s - 1.0) > 0.0, "the trial does not end"
        rig.run(1.0)
        rig.peer.listen()
    rig.run(0.1)
    return [one.result for one in rig.peer.said("COMMAND_ACK")]


def weak_both(*commands: float) -> World:
    """A boat whose motors are both as weak as the weaker one, in still air and water, after half a minute."""
    world = World(Rig("open").scenario)
    for thruster in (world._thrusters.left, world._thrusters.right):
        thruster.gain = WEAK
    world._motors.write(*commands)
    for _ in range(1500):
        world.step(0.02)
    return world


def speed_through_water(share: float) -> float:
    """What the weak motor and an equal one come to."""
    command = DEAD / WEAK + (1.0 - DEAD / WEAK) * share
    return weak_both(command, command).truth.surge_m_s


def turned_rad(storage: Storage | None) -> float:
    """How far sticks that lie straight turn the boat."""
    rig = Rig("open", "sensors.sonar.fitted=false", storage=storage).ready()
    rig.world._thrusters.right.gain = WEAK
    assert rig.set_mode(0) == OK
    assert rig.arm() == OK
    for _ in range(20):
        rig.boat.vehicle.request(ManualControl(0.6, 0.0))
        rig.run(0.5)
    return abs(rig.world._hull.heading_rad)


def test_what_is_measured_is_the_truth_is_told_and_kept_and_makes_the_boat_go_straight() -> None:
    rig = lopsided()
    assert rig.ask(CALIBRATE, 1.0) == IN_PROGRESS
    answers = over(rig, 900.0)
    assert answers[-1] == OK, rig.peer.texts
    assert set(answers[:-1]) == {IN_PROGRESS}
    config = rig.boat.parameters.config
    found = config.thrusters
    assert found.left_ahead == pytest.approx(DEAD, abs=0.025)
    assert found.left_astern == pytest.approx(DEAD, abs=0.025)
    assert found.right_ahead == pytest.approx(DEAD / WEAK, abs=0.03)
    assert found.right_astern == pytest.approx(DEAD / WEAK, abs=0.03)
    assert found.right_gain == 1.0
    assert found.left_gain == pytest.approx((WEAK - DEAD) / (1.0 - DEAD), abs=0.045)
    assert found.asymmetry == pytest.approx(1.0 / math.sqrt(0.55), rel=0.08)
    assert config.handling.top_speed_m_s == pytest.approx(speed_through_water(1.0), rel=0.04)
    assert speed_through_water(config.speed.cruise_throttle) == pytest.approx(2.0, rel=0.06)
    assert config.estimation.surge_time_s == pytest.approx(2.8, rel=0.25)  # Doppler noise of 0.08 m/s
    world = weak_both(0.78, 0.78)
    world._motors.write(1.0, -1.0)
    for _ in range(95):
        world.step(0.02)
    assert config.handling.turn_rate_rad_s == pytest.approx(world.truth.yaw_rate_rad_s, rel=0.12)
    assert tells(rig, "Thruster calibration done: 11 parameters")
    assert tells(rig, "MOT_L_GAIN 1 -> 0.")
    again = Rig("open", *WATER, storage=rig.storage).boat.parameters.config
    assert (again.thrusters, again.handling) == (config.thrusters, config.handling)
    assert turned_rad(None) > 1.0
    assert turned_rad(rig.storage) < 0.25


def test_the_same_command_breaks_it_off() -> None:
    rig = lopsided()
    assert rig.ask(CALIBRATE, 1.0) == IN_PROGRESS
    assert rig.ask(CALIBRATE, 1.0) == IN_PROGRESS
    assert rig.ask(dialect.MAV_CMD_DO_AUTOTUNE_ENABLE, 1.0) == REJECTED_FOR_NOW
    assert rig.ask(CALIBRATE, 0.0) == CANCELLED
    assert not rig.boat.calibration.is_running
    assert rig.ask(CALIBRATE, 0.0) == OK


def test_it_is_refused_with_a_reason_and_keeps_inside_the_fence() -> None:
    rig = Rig("open", *WATER).ready()

    def refusal(*params: float) -> str:
        assert rig.ask(CALIBRATE, 1.0, *params) == REJECTED_FOR_NOW
        return rig.peer.texts[-1]

    assert refusal() == "Thruster calibration: arm first"
    assert rig.arm() == OK
    assert refusal() == "Thruster calibration: choose LOITER first"
    rig.set_mode(Mode.LOITER)
    assert refusal(10.0) == "Thruster calibration: needs 24.0 m of free water all round"
    fenced(rig, *polygon(box(-20.0, -20.0, 20.0, 20.0)))
    rig.run(2.0)
    assert "needs 24.0 m" in refusal()
    assert "the fence leaves" in refusal(60.0)
    fenced(rig, *polygon(box(-50.0, -50.0, 50.0, 50.0)))
    rig.run(0.1)
    assert rig.ask(CALIBRATE, 1.0) == IN_PROGRESS
    assert rig.boat.calibration.radius_m < 50.0
