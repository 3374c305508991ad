"""Readings of compass and gyro: checks them, and passes them to the filter."""

import cmath
import math
from typing import Final

from companion.config.estimation import Estimation
from companion.core.evidence import MOST_SQUARE
from companion.core.state import EstimateFault
from companion.core.units import wrap_pi
from companion.estimation.covariance import HEADING, RATE_BIAS
from companion.estimation.delay import DELAYS, PAUSE_S, STEP_S, DelayEstimator
from companion.estimation.error_state import GYRO_BIAS_RAD_S, ErrorStateFilter
from companion.estimation.hypotheses import Sensor, SensorBank
from companion.estimation.monitor import JumpMonitor, SensorMonitor
from companion.sensors.readings import HeadingReading

MAX_HEADING_RAD: Final = 100.0  # larger values of these two are treated as faults
MAX_RATE_RAD_S: Final = 50.0
# A boat approaches its target while the heading error is below 90°, which is 2.2 of these standard
# deviations. With a larger one the heading is lost.
LOST_RAD: Final = 0.7
FOUND_RAD: Final = 0.4  # uncertainty at which a lost heading counts as found
BLIND_RAD: Final = 0.45  # heading uncertainty that makes dead reckoning useless: error of half the distance
_BLOCK_S: Final = 0.19  # readings are averaged over this with a gyro,
_BLOCK_ALONE_S: Final = 0.09  # and without
_LEAP_RAD, _LEAP_RAD_S = 0.2, 3.0  # limit of the change between two compass readings: constant, per second
_JERK_RAD_S, _JERK_RAD_S2 = 0.15, 3.0  # the same for the gyro
_STUCK_RAD: Final = 0.1  # turned by the gyro while the compass repeats its value,
_STUCK_RAD_S: Final = 0.03  # plus this per second for an unknown gyro bias
_ODD: Final = 0.45  # share of outliers in the last second that rejects the compass
_EVEN: Final = 0.1  # share below which it is accepted again
_GIVE_IN_RAD_S: Final = 0.005  # how fast the gate opens for a compass that keeps disagreeing,
_GIVE_IN_IDLE_RAD_S: Final = 0.1  # and while the boat is idle
_IDLE_S: Final = 2.0  # without thrust
_TURNING_RAD_S: Final = 0.15  # error in a turn of the rate that steering lets expect
_NEIGHBOUR: Final = 0.3  # weight of a heading whose error is like that of the one before
_SELDOM_S: Final = 0.3  # period of readings that counts as slow
_PAUSES: Final = 0.2  # weight of the latest period in the mean
_MOST_PAUSE_S: Final = 1.5
_OFF_RAD: Final = 0.6  # between course and compass
_OFF_S: Final = 4.0
_UNDER_WAY: Final = 0.4  # share of cruise speed above which the course is informative
_STEADY_RAD_S: Final = 0.1  # in a turn, a receiver with latency reports another course
_GOOD_AGAIN_RAD: Final = 0.35
# Plain numbers: an IntFlag's arithmetic costs microseconds
_LOST: Final = int(EstimateFault.COMPASS_LOST)
_OFF: Final = int(EstimateFault.COMPASS_OFF)
_LATE: Final = int(EstimateFault.COMPASS_LATE)
_HEADING_LOST: Final = int(EstimateFault.HEADING_LOST)


class HeadingUpdate:
    """time_s: of the latest reading; compass_s: of the latest accepted heading; is_off: it disagrees."""

    def __init__(self, state: ErrorStateFilter, setting: Estimation) -> None:
        self._state = state
        self._gate_rad, self._timeout_s = setting.compass_gate_rad, setting.compass_timeout_s
        self.latency = DelayEstimator(_TURNING_RAD_S)  # of compass and gyro
        self.time_s = self.compass_s = self._stamp_s = self._block_s = -math.inf
        self.is_off = self._is_lost = False
        self._compass, self._gyro = SensorMonitor(), SensorMonitor()
        self._compass_jumps = JumpMonitor(_LEAP_RAD, _LEAP_RAD_S)
        self._gyro_jumps = JumpMonitor(_JERK_RAD_S, _JERK_RAD_S2)
        self._pause_s = self._sum_rad = self._outlier_share = 0.0
        self._count = 0
        self._off_since_s = math.inf
        self._course_off_rad = 0.0
        self.bank = SensorBank(setting.wander_s, setting.wander_share)

    def advance(self, reading: HeadingReading | None, now_s: float) -> None:
        """Advance the filter's heading to now_s, with the latest reading."""
        state = self._state
        if reading is None or not self._stamp_s < reading.time_s <= now_s or not _is_usable(reading):
            state.turn(now_s, None)
            return
        rate, stamp_s, late = reading.yaw_rate_rad_s, reading.time_s, self.latency
        pause_s = stamp_s - self._stamp_s
        self._stamp_s = stamp_s
        if pause_s > PAUSE_S:
            if pause_s < math.inf:
                late.note_gap(stamp_s, pause_s)
            pause_s = min(pause_s, _MOST_PAUSE_S)
        self._pause_s += _PAUSES * (pause_s - self._pause_s)
        has_heading = not math.isnan(reading.heading_rad)
        if rate is not None:
            self._gyro_jumps.update(rate, stamp_s)
            is_good = self._gyro.update(rate, stamp_s, 0.0) and not self._gyro_jumps.is_erratic
            if not is_good and has_heading:
                rate = None
        before_rad = state.heading_rad
        state.is_late = rate is not None and (late.delay_s > 0.0 or self._pause_s > _SELDOM_S)
        state.turn(now_s, rate if late.delay_s == 0.0 else None)
        dt, self.time_s = stamp_s - late.delay_s - self.time_s, stamp_s - late.delay_s
        time_s = self.time_s
        if late.delay_s > 0.0 and rate is not None and 0.0 < dt < PAUSE_S:
            state.turn_late(time_s, dt, rate)
        if has_heading:
            self._ingest(reading.heading_rad, time_s, now_s, wrap_pi(state.heading_rad - before_rad))
        if rate is not None and (stamp_s <= late.until_s or late.delay_s > 0.0):
            bias = state.bias_rad_s if state.has_gyro else 0.0
            if late.compare(stamp_s, complex(rate - bias, 0.0)) and has_heading and not self.is_off:
                self._start(reading.heading_rad, stamp_s - late.delay_s)

    def _ingest(self, heading_rad: float, time_s: float, now_s: float, turned_rad: float) -> None:
        """Process a heading."""
        state, compass = self._state, self._compass
        moved = abs(turned_rad) / (_STUCK_RAD + _STUCK_RAD_S * compass.run_s) if state.has_gyro else 0.0
        self._compass_jumps.update(heading_rad, time_s)
        is_good = compass.update(heading_rad, time_s, moved) and not self._compass_jumps.is_erratic
        if not state.has_heading or (
            is_good and not self.is_off and state.covariance.variance(HEADING) > BLIND_RAD**2
        ):
            self._start(heading_rad, time_s)
            return
        if not is_good:
            self._sum_rad, self._count = 0.0, 0
            return
        here_rad = state.heading_rad
        if self.latency.delay_s > 0.0:
            here_rad = state.at(time_s)[2]
        elif time_s < now_s:
            here_rad -= state.yaw_rate_rad_s * (now_s - time_s)
        self._sum_rad += wrap_pi(heading_rad - state.offset_rad - here_rad)
        self._count += 1
        if time_s - self._block_s >= (_BLOCK_S if state.has_gyro else _BLOCK_ALONE_S):
            self._update_block(time_s)

    def _start(self, heading_rad: float, time_s: float) -> None:
        """Take the heading from the compass."""
        state = self._state
        turned_rad = state.heading_rad - state.at(time_s)[2] if self.latency.delay_s > 0.0 else 0.0
        state.start_heading(wrap_pi(heading_rad + turned_rad))
        self._sum_rad, self._count, self._outlier_share = 0.0, 0, 0.0
        self.bank.is_compass_wrong = False
        state.compass.value = 0.0
        self.bank.restart(state.heading_sum + state.offset_rad, state.bias_rad_s)
        self._accept(time_s)

    def forget_offset(self) -> None:
        """The compass has been calibrated anew: what was learned of its offset is not true any more."""
        state = self._state
        state.forget_offset()
        self._sum_rad, self._count = 0.0, 0
        self.bank.restart(state.heading_sum + state.offset_rad, state.bias_rad_s)

    def _accept(self, time_s: float) -> None:
        self.compass_s = self._block_s = time_s
        self._off_since_s = math.inf
        self.is_off = False

    def _update_block(self, time_s: float) -> None:
        """Correct the heading by the mean compass residual since the last block."""
        state, count = self._state, self._count
        residual, span = self._sum_rad / count, min(time_s - self._block_s, 2.0)
        self._sum_rad, self._count = 0.0, 0
        self._block_s = time_s
        is_idle = state.turned_s - state.idle_since_s > _IDLE_S
        if self.bank.is_compass_wrong:
            if not self.bank.acquit_compass(residual, span, is_idle=is_idle):
                return
            if abs(residual) > self._gate_rad:
                self._start(wrap_pi(state.heading_rad + state.offset_rad + residual), time_s)
                return
        waited_s = max(time_s - self._off_since_s, 0.0)
        gate_rad = math.hypot(self._gate_rad, 3.0 * self._sigma_rad) + waited_s * (
            _GIVE_IN_IDLE_RAD_S if is_idle else _GIVE_IN_RAD_S
        )
        is_outlier = abs(residual) > gate_rad
        if is_outlier and self.latency.is_watching(self._stamp_s) and self._is_otherwise_late(residual, span):
            self._start(
                wrap_pi(state.at(time_s)[2] + state.offset_rad + residual),
                self._stamp_s - self.latency.delay_s,
            )
            return
        if state.has_gyro:
            self._outlier_share += min(span, 1.0) * ((1.0 if is_outlier else 0.0) - self._outlier_share)
            if is_outlier and self._off_since_s == math.inf:
                self._off_since_s = time_s
            if is_outlier or (self.is_off and self._outlier_share > _EVEN):
                self.is_off = self.is_off or self._outlier_share > _ODD
                return
            if self.is_off and abs(residual) > self._gate_rad:
                self._start(wrap_pi(state.heading_rad + state.offset_rad + residual), time_s)
                return
        state.update_compass(residual, count, math.inf)
        self._accept(time_s)

    def _is_otherwise_late(self, residual_rad: float, span_s: float) -> bool:
        """Whether a heading that does not fit is that of another time, which changes the delay."""
        state, late, costs = self._state, self.latency, []
        heading_rad = state.at(self._stamp_s - late.delay_s)[2] + residual_rad
        variance = state.covariance.variance(HEADING) + state.compass_variance(1)
        for delay in range(DELAYS):
            off_rad = wrap_pi(heading_rad - state.at(self._stamp_s - delay * STEP_S)[2])
            costs.append(_NEIGHBOUR * min(off_rad * off_rad / variance, MOST_SQUARE))
        return late.weigh(costs, span_s)

    def add_expected(self, now_s: float) -> None:
        """Tell the latency estimator what rate the steering lets expect."""
        if self.latency.is_due(now_s):
            yaw = self._state.yaw_model
            self.latency.add_expected(now_s, complex(yaw.gain_rad_s * yaw.turning + yaw.trim_rad_s, 0.0))

    @property
    def _sigma_rad(self) -> float:
        return math.sqrt(self._state.covariance.variance(HEADING))

    @property
    def is_in_time(self) -> bool:
        """Whether the gyro is known not to be late."""
        late = self.latency
        return self._state.has_gyro and late.delay_s == 0.0 and not late.is_uncertain(self._stamp_s)

    @property
    def is_compass_good(self) -> bool:
        """Whether the heading relies on the compass."""
        silent_s = self._state.turned_s - self.compass_s
        return not self.is_off and silent_s <= self._timeout_s + self.latency.delay_s

    def check_velocity(self, velocity: complex, time_s: float, variance: float, dt_s: float) -> None:
        """Judge compass and gyro by a velocity over ground. variance: of it less the modelled one."""
        state = self._state
        if not state.has_heading or not self.is_compass_good:
            return
        _, _, heading_rad, predicted = state.at(time_s)
        # What compass and course leave unexplained is taken for sway: it would hide a wrong compass
        through = predicted - state.current_m_s - 1j * state.side_m_s * cmath.rect(1.0, heading_rad)
        self._compare_course(velocity - state.current_m_s, through, dt_s)
        if not state.has_gyro:
            return
        bank, lies_rad = self.bank, state.offset_rad + state.compass.value
        bank.turn(state.heading_sum + lies_rad, state.bias_rad_s, dt_s)
        bank.keep(state.current_m_s, lies_rad, dt_s)
        wrong = bank.weigh_velocity(velocity, through, lies_rad, variance, dt_s)
        if wrong is Sensor.COMPASS:
            self.is_off, self._outlier_share = True, 1.0
            gap_rad = bank.gap_rad + state.compass.value
            state.restore(gap_rad, bank.offset_rad, bank.bias_rad_s, bank.current_m_s)
            bank.reject_compass()
        elif wrong is Sensor.GYRO:
            state.covariance.raise_to(RATE_BIAS, GYRO_BIAS_RAD_S**2)
        if wrong is not None:
            bank.restart(state.heading_sum + state.offset_rad + state.compass.value, state.bias_rad_s)

    def _compare_course(self, course: complex, through: complex, dt_s: float) -> None:
        """Compare the compass with the course; a large difference is a compass fault."""
        state = self._state
        if abs(state.yaw_rate_rad_s) > _STEADY_RAD_S:
            return
        least, turn = _UNDER_WAY * state.cruise_m_s, 0.0
        if abs(course) >= least and abs(through) >= least:
            turn = math.atan2(
                course.imag * through.real - course.real * through.imag,
                course.real * through.real + course.imag * through.imag,
            )
        self._course_off_rad += min(dt_s / _OFF_S, 1.0) * (turn - self._course_off_rad)
        if abs(self._course_off_rad) > _OFF_RAD:
            state.rotate(self._course_off_rad)
            self._course_off_rad = 0.0

    def faults(self, now_s: float) -> int:
        """Bits of EstimateFault."""
        faults, state = 0, self._state
        if not state.has_heading:
            return 0
        if self.is_off or abs(state.offset_rad) > _GOOD_AGAIN_RAD:
            faults = _OFF
        elif (
            self._compass.is_stuck
            or self._compass_jumps.is_erratic
            or now_s - self.compass_s > self._timeout_s + self.latency.delay_s
        ):
            faults = _LOST
        elif self.latency.delay_s > 0.0 or self._pause_s > _SELDOM_S:
            faults = _LATE
        sigma_rad = self._sigma_rad
        self._is_lost = sigma_rad > (FOUND_RAD if self._is_lost else LOST_RAD)
        return faults | _HEADING_LOST if self._is_lost else faults

    @property
    def is_blind(self) -> bool:
        """Whether the heading is too uncertain for dead reckoning."""
        state = self._state
        return not state.has_heading or self._is_lost or state.covariance.variance(HEADING) > BLIND_RAD**2


def _is_usable(reading: HeadingReading) -> bool:
    rate = reading.yaw_rate_rad_s
    if rate is not None and not abs(rate) <= MAX_RATE_RAD_S:
        return False
    return abs(reading.heading_rad) <= MAX_HEADING_RAD or (
        rate is not None and math.isnan(reading.heading_rad)
    )
