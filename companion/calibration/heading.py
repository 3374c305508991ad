"""Heading autotune: relay feedback, a yaw model identified from it, and gains computed from the model.

At cruise speed, steering is switched from one side to the other whenever the heading error exceeds a small
hysteresis (K. J. Åström and T. Hägglund, *Automatic tuning of simple regulators with specifications on phase
and amplitude margins*, Automatica 20, 1984). The oscillation stays small on any boat. Two alternating
hystereses give two periods, from which `yaw_model.py` identifies gain, lag and delay. An offset of the relay,
adjusted until both half-periods are equal, cancels wind and unequal motors.

The gains follow S. Skogestad, *Simple analytic rules for model reduction and PID controller tuning*,
J. Process Control 13, 2003, for an integrating process with a lag, in the parallel form:

    Kc = 1 / (K (τc + θ))     Td = τ     Ti = 4 (τc + θ)     Kp = Kc (1 + Td / Ti)     Kd = Kc Td

τc is the longest of θ, a twelfth of the oscillation's period (θ does not include the motors' lag), and the
time at which the gyro's noise moves the steering by _NOISE_SHARE.

The integral time is far longer, _INTEGRAL periods: wind and unequal motors change slowly, guidance corrects
the drift, and every turn would wind the integral up.
"""

import math
from statistics import median
from typing import Final

from companion.calibration.routine import (
    CalibrationError,
    Routine,
    RoutineInputs,
    Step,
    TrialFinding,
    aim,
    come_back,
)
from companion.calibration.runs import go_to_edge, has_room, opposite
from companion.calibration.yaw_model import FittedYawModel, YawFit, yaw_model
from companion.control.allocation import rudder_effect
from companion.core.intent import Drive, HoldHeading
from companion.core.state import NavState
from companion.core.units import clamp, wrap_pi

_THROW: Final = 0.3
_LEAST_DAMPING_PER_S: Final = 0.1  # a hull that hardly damps: T is 10 s
_LEAST_THROW: Final = 0.1
_HYSTERESES_RAD: Final = (0.02, 0.08)
_CYCLES: Final = 4  # of each hysteresis
_FEWEST: Final = 2  # the same, accepted after _LEGS
_LEGS: Final = 8
_SETTLING: Final = 3  # half-periods discarded at the start of a leg
_EASE: Final = 0.5  # share of the offset's error corrected at a time
_MOST_OFFSET: Final = 0.7  # share of the amplitude
_LONGEST_HALF_S: Final = 30.0
_OFF_RAD: Final = 1.0  # a larger heading error ends the test
_INTEGRAL: Final = 4.0
_NOISE_SHARE: Final = 0.015  # of full steering, one standard deviation: the gyro's noise times Kd
_SHORTEST: Final = 1.0 / 12.0  # of the oscillation's period: lower bound of τc


class RelayFeedback:
    """The relay of one leg: `steering` switches about `offset`. periods_s: the periods measured."""

    def __init__(self, throw: float, hysteresis_rad: float, offset: float, now_s: float) -> None:
        self.periods_s: list[float] = []
        self.offset = offset
        self.steering = offset + throw
        self._throw = throw
        self._hysteresis_rad = hysteresis_rad
        self._turned_s = now_s
        self._half_s = 0.0
        self._halves = 0

    def update(self, off_rad: float, now_s: float) -> None:
        """Switch if needed. off_rad: heading error, starboard positive. CalibrationError: no oscillation."""
        side = 1.0 if self.steering > self.offset else -1.0
        if side * off_rad > self._hysteresis_rad:
            self._switch(-side, now_s)
        elif now_s - self._turned_s > _LONGEST_HALF_S or abs(off_rad) > _OFF_RAD:
            raise CalibrationError("the bow does not swing about the heading")

    def _switch(self, side: float, now_s: float) -> None:
        half_s, before_s = now_s - self._turned_s, self._half_s
        self._turned_s, self._half_s = now_s, half_s
        self._halves += 1
        if side > 0.0 and self._halves > _SETTLING:
            self.periods_s.append(half_s + before_s)
            # The half that ends was steered to port; the side that takes longer is the weaker one
            lacking = _EASE * self._throw * (before_s - half_s) / (before_s + half_s)
            most = _MOST_OFFSET * self._throw
            self.offset = clamp(self.offset + lacking, -most, most)
        self.steering = self.offset + side * self._throw


def tune_heading(inputs: RoutineInputs) -> Routine:
    """Oscillate about a heading and its opposite until there are enough cycles.

    Raises CalibrationError: the heading does not oscillate, or there is too little room.
    """
    config, heading, offset = inputs.config, inputs.nav.heading_rad, 0.0
    room = 1.0 - config.speed.cruise_throttle if config.drive.has_pair else 1.0
    throw = min(_THROW, room)
    if throw < _LEAST_THROW:
        raise CalibrationError("cruise speed leaves no thrust to steer with")
    periods: dict[float, list[float]] = {one: [] for one in _HYSTERESES_RAD}
    stretches: list[YawFit] = []
    for _ in range(_LEGS):
        lacking = [one for one in _HYSTERESES_RAD if len(periods[one]) < _CYCLES]
        if not lacking:
            break
        yield from go_to_edge(inputs, heading)
        yield from aim(inputs, heading, config.speed.cruise_m_s)
        relay, stretch = RelayFeedback(throw, lacking[0], offset, inputs.now_s), YawFit()
        wanted = _CYCLES - len(periods[lacking[0]])
        yield from _swing(inputs, heading, relay, stretch, wanted)
        heading, offset = opposite(heading), relay.offset
        periods[lacking[0]] += relay.periods_s
        if relay.periods_s:
            stretches.append(stretch)
    if min(len(found) for found in periods.values()) < _FEWEST:
        raise CalibrationError("too little room to swing")
    model = yaw_model(stretches)
    if model is None:
        raise CalibrationError("the swings do not tell how the bow answers")
    yield from come_back(inputs)
    return [*gains(model, median(periods[_HYSTERESES_RAD[0]])), *hull(inputs.nav)]


def _swing(
    inputs: RoutineInputs, heading_rad: float, relay: RelayFeedback, stretch: YawFit, wanted: int
) -> Step[None]:
    """Reach cruise speed, then run the relay."""
    config = inputs.config
    until_s = inputs.now_s + config.estimation.surge_time_s
    intent = HoldHeading(heading_rad, config.speed.cruise_m_s)
    while inputs.now_s < until_s:
        yield intent
    while len(relay.periods_s) < wanted and has_room(inputs, heading_rad) and not inputs.is_slowed:
        relay.update(wrap_pi(inputs.nav.heading_rad - heading_rad), inputs.now_s)
        yield Drive(config.speed.cruise_throttle, relay.steering)
        stretch.add(_steered(inputs), inputs.nav.measured_yaw_rate_rad_s)


def _steered(inputs: RoutineInputs) -> float:
    """The steering given, in shares of full steering."""
    command, config, nav = inputs.command, inputs.config, inputs.nav
    if config.drive.has_pair:
        return 0.5 * (command.left - command.right)
    water_m_s = nav.water_speed_m_s
    return command.rudder * rudder_effect(command.left, water_m_s, config.drive, config.speed)


def hull(nav: NavState) -> list[TrialFinding]:
    """The hull that the gains are for, as the filter has learned it; nothing if it has not."""
    if not nav.yaw_accel_rad_s2 > 0.0:
        return []
    damping_per_s = max(nav.yaw_damping_per_s, _LEAST_DAMPING_PER_S)
    return [
        TrialFinding("HND_TURN_ACCEL", math.degrees(nav.yaw_accel_rad_s2)),
        TrialFinding("HND_TURN_TIME", 1.0 / damping_per_s),
    ]


def gains(model: FittedYawModel, period_s: float) -> list[TrialFinding]:
    """Kp, Ki and Kd, as derived above."""
    calm_s = model.time_s * model.noise_rad_s / (model.gain_rad_s * _NOISE_SHARE)
    answer_s = max(max(model.delay_s, _SHORTEST * period_s) + model.delay_s, calm_s)
    gain = 1.0 / (model.gain_rad_s * answer_s)
    kp = gain * (1.0 + model.time_s / (4.0 * answer_s))
    return [
        TrialFinding("HDG_KP", kp),
        TrialFinding("HDG_KI", kp / (_INTEGRAL * period_s)),
        TrialFinding("HDG_KD", gain * model.time_s),
    ]
