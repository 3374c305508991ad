"""The parameter file for ArduPilot's Rover fits the hull that it steers."""

import math
import re
from pathlib import Path

import pytest

from sitl.scenarios.scenario import load_scenario
from sitl.world.world import World

FILE = Path(__file__).parents[3] / "examples" / "ardupilot" / "lake_boat.parm"
STEP_S = 0.02
STEERING = 0.15  # of full


@pytest.fixture(scope="module")
def parameters() -> dict[str, float]:
    """Names and values, by the rules of ArduPilot's files: a line each, # begins a comment."""
    lines = [line for line in FILE.read_text().splitlines() if not line.startswith("#")]
    assert all(re.fullmatch(r"[A-Z][A-Z0-9_]{1,15} -?[0-9.]+", line) for line in lines)
    pairs = [line.split() for line in lines]
    assert len({name for name, _ in pairs}) == len(pairs)
    return {name: float(value) for name, value in pairs}


def sailed(throttle: float, steering: float) -> tuple[float, float]:
    """Speed in m/s and yaw rate in rad/s after 30 s, from shares of full throttle and steering."""
    world = World(load_scenario("open"))
    for _ in range(round(30.0 / STEP_S)):
        world.hardware.motors.write(throttle + steering, throttle - steering)
        truth = world.step(STEP_S)
    return math.hypot(truth.north_m_s, truth.east_m_s), truth.yaw_rate_rad_s


def test_the_cruise_throttle_makes_the_cruise_speed(parameters: dict[str, float]) -> None:
    speed_m_s, _ = sailed(parameters["CRUISE_THROTTLE"] / 100.0, 0.0)
    assert speed_m_s == pytest.approx(parameters["CRUISE_SPEED"], rel=0.03)


def test_the_steerings_feed_forward_makes_the_turn_rate_that_it_is_given(
    parameters: dict[str, float],
) -> None:
    _, rate_rad_s = sailed(parameters["CRUISE_THROTTLE"] / 100.0, STEERING)
    assert STEERING / rate_rad_s == pytest.approx(parameters["ATC_STR_RAT_FF"], rel=0.1)


def test_the_outputs_are_those_that_the_physics_listen_to(parameters: dict[str, float]) -> None:
    """Functions 73 and 74 are Rover's left and right throttle; `boat-sitl physics` takes 1000 to 2000 µs."""
    for output, function in ((1, 73), (3, 74)):
        settings = [parameters[f"SERVO{output}_{name}"] for name in ("FUNCTION", "MIN", "TRIM", "MAX")]
        assert settings == [function, 1000, 1500, 2000]
