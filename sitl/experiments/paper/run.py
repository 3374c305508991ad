"""The task of the paper's experiment: one case, followed by one method, under one seed."""

import math
from collections.abc import Callable, Sequence
from functools import cache
from itertools import product

import numpy as np

from companion.core.geo import Point, path_length_m
from companion.core.modes import Mode
from companion.core.units import deg_to_e7
from companion.mavlink.dialect import dialect
from mission_tools.mission.route import mission_along
from mission_tools.planning.planner import PlanSettings, plan
from sitl.courses.courses import off_path_m
from sitl.courses.missions import wire_items
from sitl.experiments.paper.conditions import CASES, Method, conditions
from sitl.experiments.paper.shore_steering import (
    HeadingPid,
    HeadingPidAhead,
    OnOff,
    ShoreSteering,
    SteeringLaw,
)
from sitl.experiments.trial import Trial, TrialResult
from sitl.run.lockstep import Lockstep
from sitl.run.recording.recorder import Recorder
from sitl.run.station_commands import BOOT_S, StationCommands
from sitl.world.scenario import Scenario

GRID_CELL_M = 0.08  # the paper gives none; about the boat's beam and the plan's clearance
REACHED_M = 0.08  # acceptance radius of shore steering: within the clearance
_LAWS: dict[Method, Callable[[Scenario], SteeringLaw]] = {
    Method.ON_OFF: OnOff,
    Method.PID: HeadingPid,
    Method.PID_AHEAD: HeadingPidAhead,
}
MOST_S = 300.0  # five times the duration of the longest case


def paper_trials(
    seeds: Sequence[int], cases: Sequence[str] = CASES, methods: Sequence[Method] = tuple(Method)
) -> list[Trial]:
    """Every case by every method with every seed."""
    return [
        Trial(number=number, scenario="pool", case=case, seed=seed, factors={"method": str(method)})
        for number, (case, method, seed) in enumerate(product(cases, methods, seeds), 1)
    ]


@cache
def planned(case: str, is_exact: bool) -> tuple[Point, ...]:
    """The plan of a case, start and goal included: the same for every method, seed and disturbance.

    From cell to cell as in the paper (8 neighbours, Euclidean heuristic), or the shortest path.
    """
    scenario = conditions(case, 0)
    if is_exact:
        settings = PlanSettings.from_route(scenario.route)
    else:
        settings = PlanSettings.from_route(
            scenario.route, heuristic="euclidean", cell_m=GRID_CELL_M, smooth=False
        )
    goal = scenario.route.goal
    if goal is None:
        raise ValueError(f"case {case} of {scenario.title} has no goal")
    return plan(scenario.chart, scenario.start, goal, settings).points


def run_paper_trial(trial: Trial) -> TrialResult:
    """Simulate from boot to the goal, or for MOST_S. The figures are a row of runs.csv, from ground truth.

    Raises RunError: the boat did not arm or change mode.
    """
    case, method = trial.case, Method(trial.factors["method"])
    scenario = conditions(case, trial.seed)
    points = planned(case, method.is_exact)
    lockstep = Lockstep(scenario)
    station, recorder = lockstep.station, Recorder()
    # Shore steering uses the boat's own positions, whose frame must be the plan's
    origin = scenario.frame.origin
    station.send(
        dialect.MAVLink_set_gps_global_origin_message(
            lockstep.station.boat.system, deg_to_e7(origin.lat_deg), deg_to_e7(origin.lon_deg), 0
        )
    )
    orders = StationCommands(lockstep, lockstep.step)
    orders.until_armable()
    steering: ShoreSteering | None = None
    if method in (Method.LOS, Method.EXACT):
        orders.upload(wire_items(mission_along([scenario.frame.to_global(point) for point in points])))
        orders.arm()
        orders.start_mission()
    else:
        law = _LAWS[method](scenario)
        steering = ShoreSteering(station, law, points, REACHED_M)
        orders.wait(lambda: steering.has_telemetry, BOOT_S, "the boat sent no position")
        orders.change_mode(law.mode)
        orders.arm()
    began_s, groundings = lockstep.time_s, lockstep.world.groundings
    arrived = False
    while lockstep.time_s - began_s < MOST_S and not arrived:
        if steering is not None:
            steering.step(lockstep.time_s)
        lockstep.step()
        recorder.record(lockstep.world.truth)
        vehicle = lockstep.boat.vehicle
        arrived = steering.has_arrived if steering is not None else vehicle.mode is not Mode.AUTO
    if steering is None:
        arrived = lockstep.boat.vehicle.progress.finished
    lockstep.close()
    track = recorder.track()
    off_m = off_path_m(np.asarray(track, dtype=np.float64), points)
    return TrialResult(
        number=trial.number,
        ended="completed" if arrived else "not completed",
        figures={
            "case": case,
            "method": str(method),
            "seed": trial.seed,
            "current_m_s": scenario.environment.current_m_s,
            "planned_m": path_length_m(points),
            "arrived": arrived,
            "time_s": lockstep.time_s - began_s,
            "length_m": path_length_m(track),
            "collisions": lockstep.world.groundings - groundings,  # with a wall or an obstacle
            "off_plan_rms_m": math.sqrt(float((off_m**2).mean())),
        },
        track=tuple((at.east_m, at.north_m) for at in track),
    )
