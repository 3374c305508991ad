"""How many simulated seconds does a CPU second give on the mill pond, with sonar echoes and telemetry?"""

from benchmarks.measure import Row, alone
from sitl.courses.missions import plan_mission, wire_items
from sitl.run.mission_run import MissionRun
from sitl.scenarios.scenario import load_scenario

_ROUNDS = 5


def rows() -> list[Row]:
    """The whole route, several times."""
    pond = load_scenario("lake")
    runs = [MissionRun(pond, wire_items(plan_mission(pond)[0])).run() for _ in range(_ROUNDS)]
    assert all(run.completed for run in runs)
    factors = [run.real_time_factor for run in runs]
    return [alone("simulated seconds per CPU second, mill pond", "×", factors)]
