"""Fields of random obstacles on no map, and things that move: no touch, no end in between."""

import math
import random

import pytest
from boat_rig import Rig, waypoint

from sitl.courses.missions import plan_mission, wire_items
from sitl.run.mission_run import MissionRun
from sitl.scenarios.scenario import load_scenario

BY_SIGHT: dict[str, object] = {"avoidance.by_sight": 1, "failsafe.gcs_enabled": False}


def field(seed: int) -> str:
    """Up to nine discs over a leg of 60 m, none over its ends, with room to pass between any two."""
    chance, discs = random.Random(f"field {seed}"), list[tuple[float, float, float]]()
    for _ in range(40):
        north, east, radius = chance.uniform(8.0, 52.0), chance.uniform(-8.0, 8.0), chance.uniform(0.3, 2.0)
        apart = all(math.hypot(north - n, east - e) > radius + r + 4.0 for n, e, r in discs)
        is_off_ends = min(math.hypot(north, east), math.hypot(north - 60.0, east)) > radius + 4.0
        if apart and is_off_ends and len(discs) < 9:
            discs.append((north, east, radius))
    each = (
        f"{{name='D{number}', circle={{centre=[{east}, {north}], radius_m={radius}}}}}"
        for number, (north, east, radius) in enumerate(discs)
    )
    return f"map.obstacles=[{', '.join(each)}]"


def test_a_field_of_rocks_is_crossed_and_rarely_touched() -> None:
    """In one of five at most: late fixes and weak thrust astern leave less time than there was."""
    touched = 0
    for seed in range(5):
        rig = Rig("open", field(seed), f"seed={seed}", config=BY_SIGHT).sail(waypoint(60.0, 0.0))
        rig.until(lambda rig=rig: rig.mode != "AUTO", 300.0)  # type: ignore[misc]
        assert rig.mode == "LOITER"
        touched += rig.world.groundings > 0
    assert touched <= 1


def mover_rig(mover: str, seed: int) -> Rig:
    return Rig("open", f"movers=[{mover}]", f"seed={seed}", config=BY_SIGHT).sail(waypoint(50.0, 0.0))


@pytest.mark.parametrize(
    "mover",
    [
        "{start=[0.0, 33.0], radius_m=0.5, velocity_m_s=[0.0, -0.3]}",
        "{start=[13.0, 25.0], radius_m=0.5, velocity_m_s=[-0.5, 0.0], at_s=1.5}",
    ],
    ids=["head on", "from starboard"],
)
def test_what_moves_is_rarely_touched_and_the_goal_reached(mover: str) -> None:
    """In half of the seeds at most: a crossing mover is known late, and at 1 m/s there is little time.

    The boat backs away from what comes along its leg, for half a minute at times.
    """
    touched = 0
    for seed in range(1, 7):
        rig = mover_rig(mover, seed)
        rig.until(lambda rig=rig: rig.mode != "AUTO", 200.0)  # type: ignore[misc]
        assert rig.mode == "LOITER"
        touched += rig.world.groundings > 0
    assert touched <= 3


def test_a_plan_that_knows_the_shore_is_sailed_as_if_there_were_no_avoidance() -> None:
    figures = []
    for enable in (0, 3):
        scenario = load_scenario("lake", [f"vehicle.avoidance.enable={enable}"])
        mission, _ = plan_mission(scenario)
        result = MissionRun(scenario, wire_items(mission)).run(timeout_s=330.0)
        assert result.completed
        assert result.groundings == 0
        figures.append((result.path_length_m, result.time_s))
    (length_m, time_s), (length_with_m, time_with_s) = figures
    assert length_with_m == pytest.approx(length_m, rel=0.02)
    assert time_with_s == pytest.approx(time_s, rel=0.05)
