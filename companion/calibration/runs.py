"""Straight runs out and back over the same water, and hard turns from them.

Half the difference of two velocities over ground on opposite headings is the speed through the water in any
current. The wind's effect on throttle and steering changes sign between the two runs, so the mean cancels it
to first order.
"""

import math
from statistics import fmean
from typing import Final, NamedTuple

from companion.calibration.routine import CalibrationError, RoutineInputs, Step, aim
from companion.core.fitting import Fit
from companion.core.geo import Point
from companion.core.intent import Drive, FollowLeg, HoldHeading
from companion.core.units import wrap_pi
from companion.estimation.hull_model import SurgeModel

START_SHARE: Final = 0.6  # of the radius: start of a run
END_SHARE: Final = 0.88  # of the radius: where the boat must have stopped
TRIES: Final = 5  # of a run that obstacle avoidance slows
_GOING_S: Final = 180.0
_LONGEST_S: Final = 120.0
_STEADY_SHARE: Final = 0.4  # last part of a run, which is evaluated
SETTLED: Final = 3.0  # surge time constants: within 5 % of the speed; a shorter run is not evaluated
_RISING: Final = 0.06  # share of the speed gained in that part: above, the run was not steady
_FIXES: Final = 2000
_BRAKED: Final = 2.0  # stopping distances: where the fence brake starts
_LATENCY_S: Final = 0.1  # of a GNSS receiver
_MODEL_S: Final = 0.1
_SEARCHES: Final = 24
_TURN_S: Final = 2.25
_TURNING_S: Final = 0.5  # last part of it, which is evaluated

_Fix = tuple[float, float, float, float]  # time, velocity north and east, mean command since the one before


class Run(NamedTuple):
    """One run. north_m_s, east_m_s (over ground), left, right (commands): means of its steady part.

    samples: time since the start, speed over ground along the heading, and mean command since the sample
    before. is_steady: the speed was constant at the end.
    """

    heading_rad: float
    north_m_s: float
    east_m_s: float
    left: float
    right: float
    samples: tuple[tuple[float, float, float], ...]
    is_steady: bool


def sail_run(inputs: RoutineInputs, heading_rad: float, speed_m_s: float) -> Step[Run | None]:
    """From the near edge to where the boat can just stop within the radius.

    Returns the run; None if the boat was slowed before it reached its speed.
    """
    fixes: list[_Fix] = []
    commands: list[tuple[float, float, float]] = []
    intent = HoldHeading(heading_rad, speed_m_s)
    yield from aim(inputs, heading_rad)
    began_s, pushed, ticks = inputs.now_s, 0.0, 0
    while not inputs.is_slowed and inputs.now_s - began_s < _LONGEST_S and has_room(inputs, heading_rad):
        yield intent
        left, right = inputs.command.left, inputs.command.right
        commands.append((inputs.now_s - began_s, left, right))
        pushed, ticks = pushed + 0.5 * (left + right), ticks + 1
        if inputs.fix is not None and len(fixes) < _FIXES:
            fixes.append((inputs.fix.time_s - began_s, *over_ground(inputs), pushed / ticks))
            pushed, ticks = 0.0, 0
    length_s = inputs.now_s - began_s
    if not inputs.is_slowed:
        return _evaluated(heading_rad, fixes, commands, length_s)
    if length_s <= SETTLED * inputs.config.estimation.surge_time_s:
        return None
    run = _evaluated(heading_rad, fixes, commands, length_s)
    return run if run.is_steady else None


def _evaluated(
    heading_rad: float, fixes: list[_Fix], commands: list[tuple[float, float, float]], length_s: float
) -> Run:
    since_s = (1.0 - _STEADY_SHARE) * length_s
    last = [fix for fix in fixes if fix[0] >= since_s]
    if len(last) < 3:
        raise CalibrationError("too little room, or too few fixes, for a run")
    c, s = math.cos(heading_rad), math.sin(heading_rad)
    rising = Fit(2)
    for t, n, e, _ in last:
        rising.add((t, 1.0), c * n + s * e)
    solved = rising.solve()
    north, east = (fmean(fix[axis] for fix in last) for axis in (1, 2))
    gained = 0.0 if solved is None else solved[0][0] * _STEADY_SHARE * length_s
    left, right = (fmean(one[side] for one in commands if one[0] >= since_s) for side in (1, 2))
    samples = tuple([(t, c * n + s * e, push) for t, n, e, push in fixes])
    return Run(heading_rad, north, east, left, right, samples, gained < _RISING * math.hypot(north, east))


def over_ground(inputs: RoutineInputs) -> tuple[float, float]:
    """Velocity north and east, by the receiver, else by the estimator."""
    fix, nav = inputs.fix, inputs.nav
    if fix is None or fix.north_m_s is None or fix.east_m_s is None:
        return nav.north_m_s, nav.east_m_s
    return fix.north_m_s, fix.east_m_s


def has_room(inputs: RoutineInputs, heading_rad: float) -> bool:
    """Whether a boat that continues on this heading can still stop within the radius."""
    nav, c, s = inputs.nav, math.cos(heading_rad), math.sin(heading_rad)
    north, east = nav.north_m - inputs.centre.north_m, nav.east_m - inputs.centre.east_m
    along, across = c * north + s * east, c * east - s * north
    room_m = math.sqrt(max((END_SHARE * inputs.radius_m) ** 2 - across**2, 0.0)) - along
    speed = max(c * nav.north_m_s + s * nav.east_m_s, 0.0)
    handling, guidance = inputs.config.handling, inputs.config.guidance
    stop_m = speed * handling.surge_time_s + speed * speed / (2.0 * guidance.accel_m_s2)
    return room_m > (_BRAKED if inputs.is_fenced else 1.0) * stop_m


def go_to_edge(inputs: RoutineInputs, heading_rad: float) -> Step[None]:
    """Sail to the start of a run on this heading. Raises CalibrationError: it is not reached."""
    off_m = -START_SHARE * inputs.radius_m
    c, s = math.cos(heading_rad), math.sin(heading_rad)
    edge = Point(inputs.centre.north_m + off_m * c, inputs.centre.east_m + off_m * s)
    leg = FollowLeg(inputs.nav.point, edge, inputs.config.speed.cruise_m_s)
    until_s = inputs.now_s + _GOING_S
    while math.hypot(*(a - b for a, b in zip(inputs.nav.point, edge, strict=True))) > max(
        inputs.config.guidance.waypoint_radius_m, 0.1 * inputs.radius_m
    ):
        if inputs.now_s > until_s:
            raise CalibrationError("the boat does not reach the start of a run")
        yield leg


class RunPair(NamedTuple):
    out: Run
    back: Run

    @property
    def speed_m_s(self) -> float:
        """Speed through the water."""
        out, back = self.out, self.back
        return 0.5 * math.hypot(out.north_m_s - back.north_m_s, out.east_m_s - back.east_m_s)

    @property
    def is_steady(self) -> bool:
        return self.out.is_steady and self.back.is_steady

    @property
    def left(self) -> float:
        return 0.5 * (self.out.left + self.back.left)

    @property
    def right(self) -> float:
        return 0.5 * (self.out.right + self.back.right)

    def current_along_m_s(self, run: Run) -> float:
        north = 0.5 * (self.out.north_m_s + self.back.north_m_s)
        east = 0.5 * (self.out.east_m_s + self.back.east_m_s)
        return math.cos(run.heading_rad) * north + math.sin(run.heading_rad) * east


def hard_turn_rad_s(inputs: RoutineInputs, heading_rad: float, drive: Drive) -> Step[float]:
    """Run to the centre, then turn with full steering to one side. Returns the rate after two seconds."""
    yield from aim(inputs, heading_rad)
    intent = HoldHeading(heading_rad, inputs.config.speed.cruise_m_s)
    c, s = math.cos(heading_rad), math.sin(heading_rad)
    while True:
        nav = inputs.nav
        along = c * (nav.north_m - inputs.centre.north_m) + s * (nav.east_m - inputs.centre.east_m)
        if along > 0.0 or not has_room(inputs, heading_rad):
            break
        yield intent
    began_s, turned, ticks = inputs.now_s, 0.0, 0
    while inputs.now_s - began_s < _TURN_S:
        yield drive
        if inputs.now_s - began_s > _TURN_S - _TURNING_S:
            turned, ticks = turned + inputs.nav.yaw_rate_rad_s, ticks + 1
    return abs(turned) / max(ticks, 1)


def surge_time_s(pair: RunPair, top_m_s: float, cruise_m_s: float, cruise_throttle: float) -> float:
    """The surge time constant that fits the estimator's model to both runs, by golden-section search."""
    low, high = math.log(0.1), math.log(30.0)
    golden = 0.5 * (math.sqrt(5.0) - 1.0)
    throttle = cruise_throttle * top_m_s / cruise_m_s  # at which the model reaches top speed
    for _ in range(_SEARCHES):
        first, second = high - golden * (high - low), low + golden * (high - low)
        costs = [
            sum(
                _misfit(run, pair.current_along_m_s(run), throttle, cruise_m_s, cruise_throttle, math.exp(at))
                for run in pair
            )
            for at in (first, second)
        ]
        if costs[0] < costs[1]:
            high = second
        else:
            low = first
    return math.exp(0.5 * (low + high))


def _misfit(
    run: Run, current_m_s: float, throttle: float, cruise_m_s: float, cruise_throttle: float, time_s: float
) -> float:
    """The sum of squared errors between run and model. throttle: of the steady part."""
    model, now_s, sum_ = SurgeModel(cruise_m_s, cruise_throttle, time_s), 0.0, 0.0
    surge_m_s = run.samples[0][1] - current_m_s
    scale = 2.0 * throttle / max(run.left + run.right, 1e-3)
    for t, speed, push in run.samples:
        share = scale * push
        while now_s + 0.5 * _MODEL_S < t - _LATENCY_S:
            surge_m_s = model.advance(surge_m_s, 0.0, share, share, 1.0, _MODEL_S)
            now_s += _MODEL_S
        sum_ += (surge_m_s + current_m_s - speed) ** 2
    return sum_


def opposite(heading_rad: float) -> float:
    """The heading of the way back."""
    return wrap_pi(heading_rad + math.pi)
