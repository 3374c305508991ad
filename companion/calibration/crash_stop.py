"""Crash stops out and back, from cruise speed and from half of it: what `HND_STOP` is set to.

The way of a stop is ∫ u dt from the command to rest, with u the speed through the water by the estimator's
filter. `planning/motion.py` converts it to the way from cruise. The result is the mean of the four and two
standard deviations: of the sample, or of what the filter errs by.
"""

from statistics import fmean, stdev
from typing import Final

from companion.calibration.routine import (
    CalibrationError,
    Routine,
    RoutineInputs,
    Step,
    TrialFinding,
    come_back,
)
from companion.calibration.runs import SETTLED, TRIES, go_to_edge, has_room, opposite
from companion.core.intent import HoldHeading
from companion.core.units import wrap_pi
from companion.obstacles.planning.motion import stop_from_cruise_m
from companion.obstacles.planning.speed_limit import crash_stop

_SHARES: Final = (1.0, 0.5)  # of cruise speed: the speed by sight is between
_AIMED_RAD: Final = 0.3  # the run begins: gusts turn a rudder boat by less
_SLOWEST: Final = 0.25  # of cruise speed: a shorter stop is mostly the motors' reversal
_LONGEST_S: Final = 30.0
_BOUND: Final = 2.0  # standard deviations
# The least of one, of the way: the filter takes the thrust astern for 0.65 of that ahead. It is 0.5 to 0.7
# (estimation/hull_model.py), evenly spread
_FILTER: Final = 0.09


def measure_stop(inputs: RoutineInputs) -> Routine:
    """The whole calibration. Raises CalibrationError: there is too little room, or the boat does not stop."""
    heading, config = inputs.nav.heading_rad, inputs.config
    ways_m = []
    for share in _SHARES:
        for course in (heading, opposite(heading)):
            yield from _run_up(inputs, course, share * config.speed.cruise_m_s)
            speed_m_s, way_m = yield from _stop(inputs)
            ways_m.append(stop_from_cruise_m(speed_m_s, way_m, config))
    yield from come_back(inputs)
    mean_m = fmean(ways_m)
    return [TrialFinding("HND_STOP", mean_m + _BOUND * max(stdev(ways_m), _FILTER * mean_m))]


def _run_up(inputs: RoutineInputs, course_rad: float, speed_m_s: float) -> Step[None]:
    """Reach a speed through the water, or what sight allows of it. Repeats a run that was slowed."""
    settles_s = SETTLED * inputs.config.estimation.surge_time_s
    for _ in range(TRIES):
        yield from go_to_edge(inputs, course_rad)
        until_s = inputs.now_s + settles_s
        while inputs.now_s < until_s and has_room(inputs, course_rad):
            yield HoldHeading(course_rad, speed_m_s + inputs.nav.current_along_m_s(course_rad))
            if abs(wrap_pi(course_rad - inputs.nav.heading_rad)) > _AIMED_RAD:
                until_s = inputs.now_s + settles_s
        if inputs.nav.water_speed_m_s > _SLOWEST * inputs.config.speed.cruise_m_s:
            return
    raise CalibrationError("the boat is slowed in every run")


def _stop(inputs: RoutineInputs) -> Step[tuple[float, float]]:
    """A crash stop: the speed at its command, and its way."""
    began_s = now_s = inputs.now_s
    speed_m_s = surge_m_s = inputs.nav.water_speed_m_s
    way_m = 0.0
    while surge_m_s > 0.0:
        if now_s - began_s > _LONGEST_S:
            raise CalibrationError("the boat does not stop")
        yield crash_stop(inputs.nav, inputs.config)
        way_m += surge_m_s * (inputs.now_s - now_s)
        now_s, surge_m_s = inputs.now_s, inputs.nav.water_speed_m_s
    return speed_m_s, way_m
