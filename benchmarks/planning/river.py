"""Is the quickest route quicker in the water, and does the boat arrive when the planner says?

Up and down a river of 1 m/s with two islands, for the lake boat at 1.8 m/s. Both routes, the shortest
and the quickest, are sailed in the emulator over the same water; the time is from the start of the mission to
its end.
"""

import functools
import math
import statistics
import tempfile
from pathlib import Path

from benchmarks.measure import Row, alone, spread
from companion.core.geo import Point, distance_m
from mission_tools.contract.boat import load_boat
from mission_tools.contract.budget import budget_of
from mission_tools.costs.cheapest import CheapestRoute, cheapest_route
from mission_tools.costs.current import River
from mission_tools.costs.travel import BoatSpeed, TravelTime
from mission_tools.mission.plan_file import save_mission
from mission_tools.mission.route import mission_along
from mission_tools.planning.planner import PlanSettings, plan
from sitl.experiments.mission_trial import run_mission
from sitl.experiments.trial import Trial, TrialResult
from sitl.scenarios.scenario import load_scenario

CURRENT_M_S, WIDTH_M, LENGTH_M = 1.0, 60.0, 1200.0
BOAT = load_boat("lake")
SPEED = BoatSpeed(1.8, 2.5)
CLEARANCE_M = 5.0
SEEDS = (11, 12, 13)
TRIPS = {
    "up": (Point(30.0, 1180.0), Point(30.0, 10.0)),
    "down": (Point(30.0, 600.0), Point(30.0, 1150.0)),
    "up, from bank to bank": (Point(10.0, 1100.0), Point(50.0, 40.0)),
}
_SCENARIO = f"""
title = "River"
[origin]
lat_deg = 50.0
lon_deg = -1.2
[map]
water = [[0, 0], [{LENGTH_M}, 0], [{LENGTH_M}, {WIDTH_M}], [0, {WIDTH_M}]]
[[map.obstacles]]
name = "Upper island"
polygon = [[120, 24], [160, 22], [165, 30], [122, 34]]
[[map.obstacles]]
name = "Lower island"
polygon = [[650, 30], [700, 28], [702, 44], [652, 42]]
[boat]
model = "lake"
start = [{{start.east_m}}, {{start.north_m}}]
heading_deg = {{heading_deg}}
[environment]
river = {{{{ speed_m_s = {CURRENT_M_S}, width_m = {WIDTH_M}, through = [0, {0.5 * WIDTH_M}], to_deg = 90 }}}}
"""


@functools.cache
def sailed() -> list[tuple[str, float, CheapestRoute, TrialResult, TrialResult]]:
    """Every trip and seed: the time that the budget says, the routes, and both runs."""
    runs = []
    with tempfile.TemporaryDirectory() as folder:
        for name, (start, goal) in TRIPS.items():
            scenario = Path(folder, f"{name}.toml")
            heading_deg = 270.0 if start.east_m > goal.east_m else 90.0
            scenario.write_text(_SCENARIO.format(start=start, heading_deg=heading_deg))
            chart = load_scenario(str(scenario)).chart
            shortest = plan(chart, start, goal, PlanSettings(clearance_m=CLEARANCE_M)).points
            middle = (Point(0.5 * WIDTH_M, 0.0), Point(0.5 * WIDTH_M, LENGTH_M))
            travel = TravelTime(SPEED, River(middle, WIDTH_M, CURRENT_M_S))
            quickest = cheapest_route(chart, shortest, CLEARANCE_M, travel)
            points = quickest.points
            home_m = [distance_m(point, points[0]) for point in points]
            holds_s = [0.0] * (len(points) - 1)
            budget = budget_of(points, holds_s, home_m, BOAT, SPEED.over_ground_m_s, travel.current)
            for seed in SEEDS:
                results = []
                for kind, points in (("shortest", shortest), ("quickest", quickest.points)):
                    file = Path(folder, f"{name} {kind}.plan")
                    places = [chart.frame.to_global(point) for point in points]
                    save_mission(mission_along(places, SPEED.over_ground_m_s), file)
                    trial = Trial(number=seed, scenario=str(scenario), seed=seed, mission=str(file))
                    results.append(run_mission(trial))
                runs.append((name, budget.time_s, quickest, results[0], results[1]))
    return runs


def rows() -> list[Row]:
    """Figures of each trip, over the seeds."""
    found = []
    for name in TRIPS:
        runs = [run for run in sailed() if run[0] == name]
        quickest = [run[4].value("time_s") if run[4].ended == "completed" else math.inf for run in runs]
        direct = [run[3].value("time_s") if run[3].ended == "completed" else math.inf for run in runs]
        planned_s = runs[0][1]
        found.append(
            Row(
                f"{name}: sailed, the quickest route",
                "s",
                "less",
                statistics.median(quickest),
                spread(quickest),
                "the shortest route",
                statistics.median(direct),
                statistics.median(a / b for a, b in zip(quickest, direct, strict=True)),
                f"planned {planned_s:.0f} s, shortest {runs[0][2].shortest_cost:.0f} s",
            )
        )
        late = [100.0 * (time_s / planned_s - 1.0) for time_s in quickest]
        found.append(alone(f"{name}: arrives after the planned time by", "%", "less", late))
    return found
