"""What the planner asks for is what the boat keeps: the lake's clearance, by the truth."""

import pytest

from sitl.courses.missions import plan_mission, wire_items
from sitl.run.mission_run import MissionRun
from sitl.scenarios.scenario import load_scenario


@pytest.mark.parametrize("seed", [101, 102])
def test_the_lake_is_crossed_without_coming_nearer_to_the_shore_than_asked(seed: int) -> None:
    scenario = load_scenario("lake", [f"seed={seed}"])
    mission, planned = plan_mission(scenario)
    assert planned.min_clearance_m >= 4.6
    result = MissionRun(scenario, wire_items(mission)).run()
    assert result.completed
    assert result.min_clearance_m is not None
    assert result.min_clearance_m >= 4.0
