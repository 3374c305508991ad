"""The heading loop on the emulated hull: with its gains scheduled, alike at every speed."""

import math

from companion.config.boat_config import BoatConfig, with_value
from companion.control.helm import Helm
from companion.core.state import Demand, NavState
from companion.core.units import wrap_pi
from sitl.scenarios.scenario import load_scenario
from sitl.world.world import Truth, World

DT_S = 0.02
SLOW_GAIN = 1.7  # what the emulated hull takes
STEP_RAD = math.radians(20.0)
SETTLE_S = 15.0
WATCH_S = 8.0


def overshoot(speed_m_s: float, slow_gain: float) -> float:
    """How far the bow goes beyond a step of the heading, as a share of it."""
    scenario = load_scenario("open", ())
    config = with_value(scenario.vehicle, "heading.slow_gain", slow_gain)
    world, helm = World(scenario), Helm()
    truth = world.step(DT_S)
    start = truth.heading_rad
    farthest = 0.0
    while truth.time_s < SETTLE_S + WATCH_S:
        step = STEP_RAD if truth.time_s > SETTLE_S else 0.0
        _steer(world, helm, config, truth, wrap_pi(start + step), speed_m_s)
        truth = world.step(DT_S)
        if step:
            farthest = max(farthest, wrap_pi(truth.heading_rad - start) / STEP_RAD - 1.0)
    return farthest


def _steer(
    world: World, helm: Helm, config: BoatConfig, truth: Truth, heading_rad: float, speed_m_s: float
) -> None:
    nav = NavState(
        truth.time_s, truth.north_m, truth.east_m, truth.heading_rad, truth.yaw_rate_rad_s, truth.north_m_s,
        truth.east_m_s, truth.surge_m_s, truth.sway_m_s, 0.0, 0.0,
    )  # fmt: skip
    thrust = helm.update(Demand(heading_rad, speed_m_s), nav, config, DT_S)
    world.electronics.motors.write(thrust.left, thrust.right)


def test_a_step_of_the_heading_is_answered_alike_at_every_speed_by_scheduled_gains() -> None:
    slow = overshoot(0.5, SLOW_GAIN)
    for share in (slow, overshoot(2.8, SLOW_GAIN)):
        assert 0.01 < share < 0.08
    assert overshoot(0.5, 1.0) > 1.4 * slow, "with the gains of cruise speed"
