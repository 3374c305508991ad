"""How well the boat keeps its course, and that a run is a function of its seed."""

import math

import pytest
from boat_rig import HOME_ITEM, scenario, waypoint

from sitl.missions import plan_mission, wire_items
from sitl.sail import Result, Sailing

STRAIGHT = [(200.0, 0.0)]
ZIGZAG = [(50.0, 0.0), (50.0, 50.0), (100.0, 50.0), (100.0, 100.0), (150.0, 100.0), (150.0, 150.0)]
HULL_HALF_BEAM_M = 0.05  # the pool boat's


def sailed(course: list[tuple[float, float]], *settings: str) -> Result:
    items = [HOME_ITEM, *[waypoint(north_m, east_m) for north_m, east_m in course]]
    return Sailing(scenario("open", *settings), items).run()


@pytest.mark.parametrize("current_m_s", [0.0, 0.5])
@pytest.mark.parametrize("course", [STRAIGHT, ZIGZAG], ids=["straight", "zigzag"])
def test_the_cross_track_error_stays_below_half_a_metre(
    course: list[tuple[float, float]], current_m_s: float
) -> None:
    result = sailed(course, f"environment.current_m_s={current_m_s}", "environment.current_to_deg=90.0")
    assert result.completed
    assert result.waypoints_reached == result.waypoints == len(course)
    assert result.cross_track_rms_m is not None
    assert result.cross_track_rms_m < 0.5
    assert result.final_mode == "LOITER"
    assert result.time_s < 1.8 * result.planned_length_m / 2.0


@pytest.mark.parametrize("case", ["1", "2", "3", "4", "5"])
def test_the_pools_cases_reach_their_goals_without_touching(case: str) -> None:
    pool = scenario("pool", case=case)
    mission, _ = plan_mission(pool)
    sailing = Sailing(pool, wire_items(mission))
    result = sailing.run()
    assert result.completed
    assert result.waypoints_reached == result.waypoints
    assert result.groundings == 0
    assert result.min_clearance_m is not None
    assert result.min_clearance_m > HULL_HALF_BEAM_M
    goal, truth = pool.route.goal, sailing.lockstep.world.truth
    assert goal is not None
    assert math.hypot(truth.north_m - goal.north_m, truth.east_m - goal.east_m) < 0.1


def test_one_seed_is_one_voyage_to_the_last_bit() -> None:
    first, again, other = (sailed([(30.0, 10.0)], f"seed={seed}") for seed in (1, 1, 2))
    assert first.state_hash == again.state_hash
    assert first.state_hash != other.state_hash
    assert first.path_length_m == again.path_length_m
