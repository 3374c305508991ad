"""The world as a whole: what the boats can do, grounding, and the same run twice."""

import math

import pytest

from companion.hal.interfaces import Motors
from sitl.run.recording.recorder import Recorder
from sitl.scenarios.scenario import load_scenario
from sitl.world.simulated_hardware import SimMotors
from sitl.world.truth import Truth
from sitl.world.world import World

DT_S = 0.02


def world(name: str = "open", *overrides: str) -> World:
    return World(load_scenario(name, overrides))


def drive(water: World, left: float, right: float, for_s: float) -> Truth:
    water.hardware.motors.write(left, right)
    for _ in range(round(for_s / DT_S)):
        water.step(DT_S)
    return water.truth


@pytest.mark.parametrize(("name", "cruise_m_s", "top_m_s"), [("open", 2.0, 3.0), ("pool", 0.045, 0.07)])
def test_cruise_throttle_and_full_drive_give_the_boats_speeds(
    name: str, cruise_m_s: float, top_m_s: float
) -> None:
    scenario = load_scenario("open", ["boat.model=pool"] if name == "pool" else [])
    throttle = scenario.vehicle.speed.cruise_throttle
    assert drive(World(scenario), throttle, throttle, 60.0).surge_m_s == pytest.approx(cruise_m_s, rel=0.03)
    assert drive(World(scenario), 1.0, 1.0, 60.0).surge_m_s == pytest.approx(top_m_s, rel=0.03)


def test_a_command_that_is_not_a_number_stops_both_motors_and_one_too_large_is_limited() -> None:
    motors = SimMotors()
    as_part: Motors = motors
    as_part.write(7.0, -7.0)
    assert (motors.left, motors.right) == (1.0, -1.0)
    as_part.write(0.5, math.nan)
    assert (motors.left, motors.right) == (0.0, 0.0)
    as_part.close()
    as_part.close()


def test_driving_costs_charge_and_sags_the_pack() -> None:
    idle, busy = world(), world()
    drive(idle, 0.0, 0.0, 30.0)
    drive(busy, 1.0, 1.0, 30.0)
    assert busy.used_mah > 3.0 * idle.used_mah
    readings = [water.hardware.battery.read() for water in (idle, busy) if water.hardware.battery]
    assert readings[0] is not None
    assert readings[1] is not None
    assert readings[1].voltage_v < readings[0].voltage_v - 0.1


def test_a_worn_out_pack_browns_the_computer_out_and_it_starts_again() -> None:
    water = world("open", "battery.resistance_ohm=0.6", "battery.charge=0.15")
    computer = water.electronics.computer
    drive(water, 0.2, 0.2, 2.0)
    assert (computer.has_power, computer.boots) == (True, 1)
    lost_s = back_s = 0.0
    for _ in range(500):
        if computer.has_power and not lost_s:
            water.hardware.motors.write(1.0, 1.0)
        water.step(DT_S)
        if not computer.has_power and not lost_s:
            lost_s = water.time_s
        if lost_s and computer.has_power and not back_s:
            back_s = water.time_s
    assert lost_s
    assert 0.5 <= back_s - lost_s < 0.8
    assert computer.boots == 2
    assert (water.truth.left_command, water.truth.right_command) == (0.0, 0.0)


@pytest.mark.parametrize("dt_s", [0.0, -0.02, 0.06, math.nan])
def test_a_step_that_the_integrator_cannot_take_is_refused(dt_s: float) -> None:
    with pytest.raises(ValueError, match="expected more than 0 and at most"):
        world().step(dt_s)


def run(*overrides: str, seed: int = 1) -> tuple[str, list[object]]:
    water = world("pool", f"seed={seed}", *overrides)
    recorder = Recorder()
    heard: list[object] = []
    for tick in range(500):
        # A crude helmsman that acts on noisy sensors, so that their noise reaches the motion.
        compass = water.hardware.compass.read()
        steer = 0.0 if compass is None else compass.heading_rad
        water.hardware.motors.write(0.7 - 0.1 * steer, 0.7 + 0.1 * steer)
        heard += [compass, water.hardware.gnss.read()]
        recorder.record(water.step(DT_S), leg=tick % 3)
    return recorder.state_hash(), heard


def test_the_same_seed_gives_the_same_bytes() -> None:
    assert run() == run()
    assert run(seed=2)[0] != run()[0]


def test_leaving_out_the_sonar_changes_nothing_else() -> None:
    assert run("sensors.sonar.fitted=false") == run()
