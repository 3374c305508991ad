"""Worlds drawn at random: always sailable, always the same for a seed."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from companion.core.errors import ConfigError
from companion.core.geo import distance_m
from sitl.courses.missions import plan_mission
from sitl.scenarios.random_world import RandomWater, random_world
from sitl.scenarios.scenario import load_scenario
from sitl.world.faults.catalogue import FaultSetting
from sitl.world.scenario import Scenario


def world(seed: int, *overrides: str) -> Scenario:
    return load_scenario("random", [f"seed={seed}", *overrides])


@settings(max_examples=8, deadline=None)
@given(seed=st.integers(0, 10**9))
def test_start_and_goal_are_joined_by_a_way_that_keeps_the_clearance(seed: int) -> None:
    scenario = world(seed)
    goal = scenario.route.goal
    assert goal is not None
    assert 90.0 <= distance_m(scenario.start, goal) <= 150.0
    _, plan = plan_mission(scenario)
    assert plan.min_clearance_m >= 4.0 - 1e-6
    assert not plan.notes  # the start itself is clear, too


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10**9))
def test_weather_and_fault_stay_within_what_was_asked_for(seed: int) -> None:
    scenario = world(seed, "random.fault=true", "random.current_m_s=0.7", "random.gust_m_s=6.0")
    environment = scenario.environment
    assert 0.0 <= environment.current_m_s <= 0.7
    assert environment.wind_m_s <= environment.gust_m_s <= 6.0
    (fault,) = scenario.faults
    assert isinstance(fault, FaultSetting)
    assert 8.0 <= fault.at_s <= 60.0
    assert fault.for_s is not None or fault.what != "computer"


def test_the_same_seed_is_the_same_world_and_another_seed_is_another() -> None:
    water = RandomWater(fault=True)
    assert random_world(water, 7) == random_world(water, 7)
    assert random_world(water, 7) != random_world(water, 8)
    assert random_world(water, 7)["map"] == random_world(RandomWater(), 7)["map"]


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("random.distance_m=[400.0, 500.0]", "no way of 400 to 500 m in a water 200 m across"),
        ("random.clearance_m=90.0", "expected a shorter distance_m"),
        ("random.islands=-1", "random.islands: .*>= 0"),
        ("random.depth_m=3", "random.depth_m: no such setting"),
    ],
)
def test_a_world_that_cannot_be_is_told(override: str, words: str) -> None:
    with pytest.raises(ConfigError, match=words):
        world(1, override)
