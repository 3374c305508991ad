"""The judge of the avoidance experiment: what counts as an inevitable touch."""

import math

import numpy as np
import pytest

from sitl.experiments.encounters.evasion import could_evade, is_audible
from sitl.scenarios.layers import Layer
from sitl.scenarios.scenario import load_scenario
from sitl.world.movers import Movers
from sitl.world.scenario import Scenario
from sitl.world.truth import Truth

TICK_S = 0.02


def scenario(start: tuple[float, float], velocity_m_s: tuple[float, float]) -> Scenario:
    """One mover, 1 m across. start and velocity are east and north."""
    mover = {"start": start, "velocity_m_s": velocity_m_s, "radius_m": 0.5}
    return load_scenario("open", over=[Layer("test", {"movers": [mover]})])


def rows(speed_m_s: float, seconds: float = 20.0) -> np.ndarray:
    """A boat that goes north at a speed and touches at the end."""
    still = dict.fromkeys(Truth._fields, 0.0)
    command = 0.6 if speed_m_s else 0.0
    motion = {"surge_m_s": speed_m_s, "left_command": command, "right_command": command, "voltage_v": 12.0}
    ticks = range(round(seconds / TICK_S))
    each = [
        {**still, **motion, "time_s": tick * TICK_S, "north_m": tick * TICK_S * speed_m_s} for tick in ticks
    ]
    each[-1]["grounded"] = 1.0
    return np.array([[one[name] for name in Truth._fields] for one in each])


@pytest.mark.parametrize(("boat_m_s", "is_avoidable"), [(1.0, True), (2.0, False)])
def test_a_slow_boat_can_avoid_head_on_what_a_fast_one_cannot(boat_m_s: float, is_avoidable: bool) -> None:
    world = scenario((0.0, 24.0), (0.0, -0.5))
    assert could_evade(world, rows(boat_m_s)) is is_avoidable


@pytest.mark.parametrize(("heard_s", "is_avoidable"), [(12.0, True), (14.8, False), (math.inf, False)])
def test_what_is_heard_late_or_never_cannot_be_avoided_though_it_could_have_been_heard(
    heard_s: float, is_avoidable: bool
) -> None:
    """They meet after 15 s at 1.5 m/s; the first possible echo is after 13 s."""
    world = scenario((0.0, 24.0), (0.0, -0.5))
    assert could_evade(world, rows(1.0), heard_s) is is_avoidable


def test_what_was_never_audible_is_inevitable() -> None:
    assert not could_evade(scenario((0.0, -30.0), (0.0, 4.0)), rows(2.0))


@pytest.mark.parametrize(
    ("off_deg", "distance_m", "is_heard"),
    [(0.0, 4.49, True), (0.0, 4.51, False), (97.0, 3.0, True), (98.0, 3.0, False)],
)
def test_a_mover_is_audible_within_range_of_its_edge_and_the_swept_field(
    off_deg: float, distance_m: float, is_heard: bool
) -> None:
    bearing = math.radians(off_deg)
    world = scenario((distance_m * math.sin(bearing), distance_m * math.cos(bearing)), (0.0, 0.0))
    at = Truth(*rows(0.0, 1.0)[0].tolist())
    assert is_audible(world, Movers(world.movers), at) is is_heard
