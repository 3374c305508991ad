"""How calmly the motors run: travel of their commands, and commands astern at speed.

The command is the one that stands at the motor, −1..1, in samples SAMPLE_S apart. One full scale is 1.0 of
it, from stopped to full ahead. Travel is the sum of the absolute differences of successive samples.

A motor that is driven astern while the boat makes more than FAST_M_S through the water has a real cause if
something is within the ranger's reach ahead (shore, obstacle, mover), the fence or the end of the mission is
within the way that the boat needs to stop, or the boat takes a corner, where differential thrust may turn
astern. Anything else has no cause: a false echo, noise, a false alarm.
"""

import math
from typing import Final

import numpy as np

from companion.boat import TICK_S
from companion.core.geo import Point, distance_m
from sitl.run.mission_run import MissionRun
from sitl.world.truth import Truth

SAMPLE_S: Final = 0.1
FAST_M_S: Final = 0.7
ASTERN: Final = 0.01  # a smaller command turns no propeller
CAUSE_S: Final = 1.0  # a cause counts for so long: the boat acts on what it has seen
_FAN_RAD: Final = tuple(math.radians(15.0 * step) for step in range(-5, 6))  # about the course over ground
_MEMORY: Final = round(CAUSE_S / SAMPLE_S)
_EVERY: Final = round(SAMPLE_S / TICK_S)
_LEFT, _RIGHT = Truth._fields.index("left_command"), Truth._fields.index("right_command")
_SURGE = Truth._fields.index("surge_m_s")


def calm_figures(mission_run: MissionRun) -> dict[str, float | None]:
    """motor_travel_per_min: full scales a minute of the motor that travels more, while the mission is sailed.
    astern_caused_s, astern_false_s: how long a motor was driven astern at speed, with and without a cause.
    """
    rows = mission_run.sailed_rows[::_EVERY]
    if len(rows) < 2:
        return {"motor_travel_per_min": None, "astern_caused_s": None, "astern_false_s": None}
    travel = np.abs(np.diff(rows[:, (_LEFT, _RIGHT)], axis=0)).sum(axis=0)
    astern = (rows[:, _SURGE] > FAST_M_S) & (rows[:, (_LEFT, _RIGHT)].min(axis=1) < -ASTERN)
    caused = sum(
        any(_has_cause(mission_run, Truth(*row)) for row in rows[max(at - _MEMORY, 0) : at + 1].tolist())
        for at in np.flatnonzero(astern).tolist()
    )
    return {
        "motor_travel_per_min": float(travel.max() * 60.0 / (rows[-1, 0] - rows[0, 0])),
        "astern_caused_s": SAMPLE_S * caused,
        "astern_false_s": SAMPLE_S * (int(astern.sum()) - caused),
    }


def _has_cause(mission_run: MissionRun, truth: Truth) -> bool:
    """Whether something real may make the boat brake or turn hard here."""
    scenario, world = mission_run.scenario, mission_run.lockstep.world
    vehicle, sonar = scenario.vehicle, scenario.sensors.sonar
    moves_m_s = math.hypot(truth.north_m_s, truth.east_m_s)
    course = math.atan2(truth.east_m_s, truth.north_m_s)
    fan = [course + off for off in _FAN_RAD]
    east_m, north_m = truth.east_m, truth.north_m
    if world.shore.range_m(east_m, north_m, fan, sonar.max_range_m) < math.inf:
        return True
    if any(world.movers.echoes(east_m, north_m, one, 0.0, sonar.max_range_m, truth.time_s) for one in fan):
        return True
    guidance = vehicle.guidance
    stops_m = moves_m_s * vehicle.handling.surge_time_s + moves_m_s**2 / (2.0 * guidance.accel_m_s2)
    here = Point(north_m, east_m)
    near_m = stops_m + guidance.waypoint_radius_m
    if any(distance_m(here, place) <= near_m for place in mission_run.planned[1:]):
        return True
    boat = mission_run.lockstep.boat
    own = boat.estimator.frame  # it starts where the boat boots
    return own is not None and boat.vehicle.fence.is_near(
        own.to_local(scenario.frame.to_global(here)), stops_m
    )
