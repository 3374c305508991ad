"""A second ranger over MAVLink, from the emulated component to the boat's map."""

import math

import pytest

from companion.obstacles.perception.perception import ObstaclePerception
from sitl.experiments.encounters.encounter import second_ranger
from sitl.run.lockstep import Lockstep
from sitl.scenarios.layers import Layer
from sitl.scenarios.scenario import load_scenario

ROCK = {"name": "Rock", "circle": {"centre": (0.0, 8.0), "radius_m": 1.0}}


def perception_after(seconds: float, *settings: str) -> ObstaclePerception:
    """A boat at rest, with a rock whose near side is 7 m north of it."""
    scenario = load_scenario("open", settings, over=[Layer("test", {"map": {"obstacles": [ROCK]}})])
    lockstep = Lockstep(scenario)
    for _ in range(round(seconds / 0.02)):
        lockstep.step()
    perception = lockstep.boat.guidance.perception
    lockstep.close()
    return perception


@pytest.mark.parametrize(
    ("ranger", "sight_m", "is_seen"), [("scan", 6.0, False), ("scan", 12.0, True), ("forward", 12.0, True)]
)
def test_a_second_ranger_marks_what_the_sonar_cannot_see(ranger: str, sight_m: float, is_seen: bool) -> None:
    settings = second_ranger(sight_m, "forward" if ranger == "forward" else "scan")
    heading_deg = 40.0 if ranger == "scan" else 0.0
    perception = perception_after(12.0, *settings, f"boat.heading_deg={heading_deg}")
    solid = perception.solid()
    assert bool(solid) is is_seen
    assert perception.reach_m == sight_m
    assert all(abs(cell.east_m) < 2.5 for cell in solid)
    near = [math.hypot(cell.north_m, cell.east_m) for cell in solid]
    assert not near or min(near) == pytest.approx(7.0, abs=0.8)


@pytest.mark.parametrize(("ranger", "heard_s"), [([], 3.0), (second_ranger(12.0, "scan"), 1.0)])
def test_the_first_ranger_that_hears_a_mover_counts(ranger: list[str], heard_s: float) -> None:
    """A mover that is 11.5 m off after 1 s, and 3.5 m off after 3 s."""
    mover = {"start": (0.0, 16.0), "velocity_m_s": (0.0, -4.0), "radius_m": 0.5}
    settings = ["sensors.sonar.ranger=ideal", *ranger]
    lockstep = Lockstep(load_scenario("open", settings, over=[Layer("test", {"movers": [mover]})]))
    assert lockstep.mover_heard_s == math.inf
    for _ in range(round(4.0 / 0.02)):
        lockstep.step()
    lockstep.close()
    assert lockstep.mover_heard_s == pytest.approx(heard_s, abs=0.7)
