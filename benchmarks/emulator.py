"""How many simulated seconds does a CPU second give, whole boat with telemetry being packed?"""

import math

from benchmarks.measure import Row, alone
from companion.core.geo import Point
from companion.core.units import deg_to_e7
from companion.mavlink.items import MissionItem
from sitl.courses.missions import plan_mission, wire_items
from sitl.run.mission_run import MissionRun
from sitl.scenarios.scenario import load_scenario
from sitl.world.scenario import Scenario

_ROUNDS = 5


def rows() -> list[Row]:
    """A 200 m straight in open water, and the mill pond with sonar echoes from its shores."""
    note = "no peer: ArduPilot Rover's simulator is not installed"
    question = "simulated seconds per CPU second"
    straight = [_sail(open_water, _straight(open_water)) for open_water in [load_scenario("open")] * _ROUNDS]
    pond = load_scenario("lake")
    around = [_sail(pond, wire_items(plan_mission(pond)[0])) for _ in range(_ROUNDS)]
    return [
        alone(f"{question}: open water, 200 m straight", "×", "more", straight, note),
        alone(f"{question}: mill pond", "×", "more", around, note),
    ]


def _straight(scenario: Scenario) -> list[MissionItem]:
    places = [scenario.frame.to_global(Point(north_m, 0.0)) for north_m in (0.0, 200.0)]
    return [
        MissionItem(3, 16, param4=math.nan, x=deg_to_e7(place.lat_deg), y=deg_to_e7(place.lon_deg))
        for place in places
    ]


def _sail(scenario: Scenario, items: list[MissionItem]) -> float:
    result = MissionRun(scenario, items).run()
    assert result.completed
    return result.real_time_factor
