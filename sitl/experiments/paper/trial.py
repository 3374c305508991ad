"""One run of the experiment: a case, a method, a seed."""

import math
from dataclasses import dataclass
from functools import cache

import shapely

from companion.core.geo import Point
from companion.core.modes import Mode
from companion.core.units import deg_to_e7
from companion.mavlink.dialect import dialect
from mission_tools.mission.route import mission_along
from mission_tools.planning.planner import PlanSettings, plan
from mission_tools.planning.smooth import path_length_m
from sitl.experiments.paper.conditions import Method, conditions
from sitl.experiments.paper.helmsman import HeadingPid, Helmsman, OnOff
from sitl.run.lockstep import Lockstep
from sitl.run.operator import BOOT_S, Orders
from sitl.run.recorder import Recorder
from sitl.scenarios.missions import wire_items

GRID_CELL_M = 0.08  # the paper does not say; about the boat's beam, and the clearance of the plan
REACHED_M = 0.08  # of a waypoint, for a helmsman ashore: within the clearance
MOST_S = 300.0  # five times what the longest case takes


@dataclass(frozen=True, slots=True)
class Trial:
    """Figures of one run, from the truth. collisions: touches of wall or obstacle, each one apart."""

    case: str
    method: str
    seed: int
    current_m_s: float
    planned_m: float
    arrived: bool
    time_s: float
    length_m: float
    collisions: int
    off_plan_rms_m: float


@dataclass(frozen=True, slots=True)
class Sailed:
    """A trial with the way it went, for pictures."""

    trial: Trial
    plan: tuple[Point, ...]
    track: tuple[Point, ...]


@cache
def planned(case: str, is_exact: bool) -> tuple[Point, ...]:
    """The plan of a case, start and goal included: the same for every method, seed and disturbance.

    From cell to cell as in the paper (8 neighbours, Euclidean heuristic), or drawn taut.
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


def sail_trial(case: str, method: Method, seed: int) -> Sailed:
    """Sail one trial from boot to its goal, or until MOST_S have passed.

    Raises:
        SailError: the boat would not arm or change mode.
    """
    scenario = conditions(case, seed)
    points = planned(case, method.is_exact)
    lockstep = Lockstep(scenario)
    station, recorder = lockstep.station, Recorder()
    # The helmsman's positions are the boat's own, in a frame that must be the plan's
    origin = scenario.frame.origin
    station.send(
        dialect.MAVLink_set_gps_global_origin_message(
            lockstep.station.boat.system, deg_to_e7(origin.lat_deg), deg_to_e7(origin.lon_deg), 0
        )
    )
    orders = Orders(lockstep, lockstep.step)
    orders.until_armable()
    helmsman: Helmsman | None = None
    if method in (Method.LOS, Method.EXACT):
        orders.upload(wire_items(mission_along([scenario.frame.to_global(point) for point in points])))
        orders.arm()
        orders.start_mission()
    else:
        law = OnOff(scenario) if method is Method.ON_OFF else HeadingPid(scenario)
        helmsman = Helmsman(station, law, points, REACHED_M)
        orders.wait(lambda: helmsman.sees, BOOT_S, "the boat did not tell where it is")
        orders.change_mode(law.mode)
        orders.arm()
    began_s, touched = lockstep.time_s, lockstep.world.groundings
    arrived = False
    while lockstep.time_s - began_s < MOST_S and not arrived:
        if helmsman is not None:
            helmsman.step(lockstep.time_s)
        lockstep.step()
        recorder.record(lockstep.world.truth)
        vehicle = lockstep.boat.vehicle
        arrived = helmsman.has_arrived if helmsman is not None else vehicle.mode is not Mode.AUTO
    if helmsman is None:
        arrived = lockstep.boat.vehicle.progress.finished
    lockstep.close()
    track = tuple(recorder.track())
    trial = Trial(
        case=case,
        method=str(method),
        seed=seed,
        current_m_s=scenario.environment.current_m_s,
        planned_m=path_length_m(points),
        arrived=arrived,
        time_s=lockstep.time_s - began_s,
        length_m=path_length_m(track),
        collisions=lockstep.world.groundings - touched,
        off_plan_rms_m=_off_plan_rms_m(track, points),
    )
    return Sailed(trial, points, track)


def _off_plan_rms_m(track: tuple[Point, ...], points: tuple[Point, ...]) -> float:
    """Root mean square of the distance to the planned line, wherever on it is nearest."""
    line = shapely.LineString([(point.east_m, point.north_m) for point in points])
    at = shapely.points([(point.east_m, point.north_m) for point in track])
    return math.sqrt(float((shapely.distance(at, line) ** 2).mean()))
