"""Readings of compass and gyro: checks them, and passes them to the filter."""

import cmath
import math
from typing import Final

from companion.config.tuning import Estimation
from companion.core.readings import HeadingReading
from companion.core.state import EstimateFault
from companion.core.units import wrap_pi
from companion.estimation.covariance import HEADING, RATE_BIAS
from companion.estimation.delay import PAUSE_S, DelayEstimator
from companion.estimation.error_state import ErrorStateFilter
from companion.estimation.hypotheses import GAP_RAD, SensorBank, SuspectedSensor
from companion.estimation.innovation import DISAGREES_S
from companion.estimation.monitor import STUCK_S, SensorMonitor
from companion.sensors import plausibility

# A boat approaches its target while the heading error is below 90°, which is 2.2 of these standard
# deviations. With a larger one the heading is lost; dead reckoning is useless at an error of half the
# distance.
LOST_RAD: Final = 0.7
BLIND_RAD: Final = 0.45
_BLOCK_S: Final = 0.24  # readings are averaged over this: a bit more than the period of common receivers
_HEADING: Final = plausibility.HEADING["heading_rad"]  # a larger step of the residual begins a new block
_RATE: Final = plausibility.HEADING["yaw_rate_rad_s"]
_TURNING_RAD_S: Final = 0.15  # error in a turn of the rate that steering lets expect
_GYRO_OFF_RAD_S: Final = 0.06  # 3.4°/s; a BNO055's data sheet allows 3


class HeadingUpdate:
    """time_s: of the latest reading; compass_s: of the latest accepted heading; is_off: it disagrees."""

    def __init__(self, state: ErrorStateFilter, setting: Estimation) -> None:
        self._state = state
        self._gate_rad, self._timeout_s = setting.compass_gate_rad, setting.compass_timeout_s
        self.latency = DelayEstimator(_TURNING_RAD_S)  # of compass and gyro
        self._rate_s = math.inf  # of the gyro's latest reading; infinite before the first
        self.time_s = self.compass_s = self._stamp_s = self._block_s = self._disagreed_s = -math.inf
        self.is_off = self._is_lost = False
        self._compass, self._gyro = SensorMonitor(), SensorMonitor()
        self._pause_s = self._before_s = self._sum_rad = 0.0  # shorter of the last two pauses, last pause
        self._count = 0
        self.bank = SensorBank()

    def advance(self, reading: HeadingReading | None, now_s: float, *, ends_block: bool) -> None:
        """Advance the filter's heading to now_s, with the latest reading. ends_block: a fix has arrived."""
        state = self._state
        if reading is None or not self._stamp_s < reading.time_s <= now_s or not _is_usable(reading):
            state.turn(now_s, None)
            return
        rate, stamp_s, late = reading.yaw_rate_rad_s, reading.time_s, self.latency
        pause_s, self._stamp_s = stamp_s - self._stamp_s, stamp_s
        if PAUSE_S < pause_s < math.inf:
            late.note_gap(stamp_s, pause_s)
        self._pause_s, self._before_s = min(pause_s, self._before_s), pause_s
        has_heading = not math.isnan(reading.heading_rad)
        if rate is not None and not self._gyro.update(rate, stamp_s, 0.0) and has_heading:
            rate = None
        if rate is not None:
            self._rate_s = stamp_s
        before_rad, had_gyro = state.heading_rad, state.has_gyro
        state.is_late = rate is not None and (late.delay_s > 0.0 or self._pause_s > PAUSE_S)
        state.turn(now_s, rate if late.delay_s == 0.0 else None, learns=not late.is_watching(stamp_s))
        if state.has_gyro and not had_gyro:  # the shadow's heading, by the gyro alone, begins anew
            self.bank.restart(state.heading_sum + state.offset_rad, state.bias_rad_s)
        time_s = stamp_s - late.delay_s
        dt, self.time_s = time_s - self.time_s, time_s
        if late.delay_s > 0.0 and rate is not None and 0.0 < dt < PAUSE_S:
            state.turn_late(time_s, dt, rate)
        if has_heading:
            self._ingest(reading.heading_rad, now_s, wrap_pi(state.heading_rad - before_rad), ends_block)
        if rate is not None and late.is_watching(stamp_s):
            bias = state.bias_rad_s if state.has_gyro else 0.0
            if late.compare(stamp_s, complex(rate - bias, 0.0)) and has_heading and not self.is_off:
                self._start(reading.heading_rad, stamp_s - late.delay_s)

    def _ingest(self, heading_rad: float, now_s: float, turned_rad: float, ends_block: bool) -> None:
        """Process a heading."""
        state, time_s = self._state, self.time_s
        moved = abs(turned_rad) / GAP_RAD if state.has_gyro else 0.0
        is_good = self._compass.update(heading_rad, time_s, moved)
        if not is_good:
            self._sum_rad, self._count = 0.0, 0
        # without a gyro, a wrong compass is not found out a second time
        if is_good and self.is_blind and (state.has_gyro or not self.is_off):
            self._start(heading_rad, time_s)
            return
        if not is_good or 0.0 < self._compass.run_s < STUCK_S:  # a repeat may be of a stuck compass
            return
        here_rad = state.heading_rad
        if self.latency.delay_s > 0.0:
            here_rad = state.at(time_s)[2]
        elif time_s < now_s:
            here_rad -= state.yaw_rate_rad_s * (now_s - time_s)
        residual_rad = wrap_pi(heading_rad - state.offset_rad - here_rad)
        step_rad = _HEADING.step + _HEADING.per_s * self._before_s
        if self._count and abs(residual_rad - self._sum_rad / self._count) > step_rad:
            self._sum_rad, self._count = 0.0, 0
        self._sum_rad += residual_rad
        self._count += 1
        span_s = time_s - self._block_s
        if span_s > _BLOCK_S or (2.0 * span_s > _BLOCK_S and (ends_block or not state.has_gyro)):
            self._update_block(time_s)

    def _start(self, heading_rad: float, time_s: float) -> None:
        """Take the heading from the compass."""
        state = self._state
        turned_rad = state.heading_rad - state.at(time_s)[2] if self.latency.delay_s > 0.0 else 0.0
        state.start_heading(wrap_pi(heading_rad + turned_rad))
        self.bank.is_compass_wrong = self.is_off = False
        self.compass_s = self._block_s = time_s
        self._restart()

    def _restart(self) -> None:
        self._sum_rad, self._count = 0.0, 0
        state = self._state
        state.compass.value = 0.0
        self.bank.restart(state.heading_sum + state.offset_rad, state.bias_rad_s)

    def forget_offset(self) -> None:
        """The compass has been calibrated anew: what was learned of its offset is not true any more."""
        self._state.forget_offset()
        self._restart()

    def _update_block(self, time_s: float) -> None:
        """Correct the heading by the mean compass residual since the last block."""
        state, count, bank = self._state, self._count, self.bank
        residual, dt = self._sum_rad / count, time_s - self._block_s
        self._sum_rad, self._count = 0.0, 0
        self._block_s = time_s
        is_outlier = abs(residual) > math.hypot(self._gate_rad, 3.0 * self._sigma_rad)
        if bank.is_compass_wrong and not bank.acquit_compass(agrees=not is_outlier, dt_s=min(dt, PAUSE_S)):
            return
        if state.has_gyro:
            if is_outlier:
                self._disagreed_s = time_s
                self.is_off = self.is_off or time_s - self.compass_s > DISAGREES_S
            elif self.is_off:
                self.is_off = time_s - self._disagreed_s < DISAGREES_S
            if is_outlier or self.is_off:
                return
        state.update_compass(residual, count)
        self.compass_s = time_s
        self.is_off = False

    def add_expected(self, now_s: float) -> None:
        """Tell the latency estimator what rate the steering lets expect.

        By the configured gain: late readings teach one that explains their delay.
        """
        yaw = self._state.yaw_model
        self.latency.add_expected(now_s, complex(yaw.nominal_rad_s * yaw.turning, 0.0))

    @property
    def _sigma_rad(self) -> float:
        return math.sqrt(self._state.covariance.variance(HEADING))

    def check_velocity(
        self, velocity: complex, heading_rad: float, predicted: complex, variance: float, dt_s: float
    ) -> None:
        """Judge compass and gyro by a velocity over ground.

        heading_rad and predicted velocity: the filter's of its time. variance: of the difference of both.
        """
        state, bank = self._state, self.bank
        silent_s = state.turned_s - self.compass_s
        if self.is_off or silent_s > self._timeout_s + self.latency.delay_s or not state.has_gyro:
            return
        # What compass and course leave unexplained is taken for sway: it would hide a wrong compass
        through = predicted - state.current_m_s - 1j * state.side_m_s * cmath.rect(1.0, heading_rad)
        error_rad = state.offset_rad + state.compass.value
        bank.follow(state.heading_sum + error_rad, state.bias_rad_s, state.current_m_s, error_rad, dt_s)
        wrong = bank.weigh_velocity(velocity, through, error_rad, variance, dt_s)
        if wrong is None:
            return
        if wrong is SuspectedSensor.COMPASS:
            self.is_off, self._disagreed_s = True, self.time_s
            gap_rad = bank.gap_rad + state.compass.value
            state.restore(gap_rad, bank.offset_rad, bank.bias_rad_s, bank.current_m_s)
            bank.reject_compass()
        else:
            state.forget_bias()
        self._restart()

    def faults(self, now_s: float) -> int:
        """Bits of EstimateFault."""
        faults, state = 0, self._state
        if not state.has_heading:
            return 0
        if self._compass.is_stuck:
            faults = EstimateFault.COMPASS_FROZEN.value
        elif self.is_off or abs(state.offset_rad) > self._gate_rad:
            faults = EstimateFault.COMPASS_OFF.value
        elif now_s - self.compass_s > self._timeout_s + self.latency.delay_s:
            faults = EstimateFault.COMPASS_LOST.value
        elif self.latency.delay_s > 0.0 or self._pause_s > PAUSE_S:
            faults = EstimateFault.COMPASS_LATE.value
        if now_s < self._compass.intermittent_until_s:
            faults |= EstimateFault.COMPASS_INTERMITTENT.value
        if self._stamp_s - self._rate_s > self._timeout_s:
            faults |= EstimateFault.GYRO_LOST.value
        elif state.has_gyro:
            unsure_rad_s = 3.0 * math.sqrt(state.covariance.variance(RATE_BIAS))
            if abs(state.bias_rad_s) > _GYRO_OFF_RAD_S + unsure_rad_s:
                faults |= EstimateFault.GYRO_OFF.value
        self._is_lost = self._sigma_rad > (BLIND_RAD if self._is_lost else LOST_RAD)
        return faults | EstimateFault.HEADING_LOST.value if self._is_lost else faults

    @property
    def is_blind(self) -> bool:
        """Whether the heading is too uncertain for dead reckoning."""
        return not self._state.has_heading or self._sigma_rad > BLIND_RAD


def _is_usable(reading: HeadingReading) -> bool:
    rate = reading.yaw_rate_rad_s
    if rate is not None and not abs(rate) <= _RATE.high:  # of an external source
        return False
    return math.isfinite(reading.heading_rad) or (rate is not None and math.isnan(reading.heading_rad))
