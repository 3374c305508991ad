"""The present heading: late or infrequent readings, propagated by the yaw model."""

import math
from typing import Final

from companion.core.units import wrap_pi
from companion.estimation.heading import HeadingFilter
from companion.estimation.latency import PAUSE_S, LatencyEstimator
from companion.estimation.yaw_model import YawRateModel
from companion.sensors.readings import HeadingReading

MAX_HEADING_RAD: Final = 100.0  # larger values of these two are treated as faults
MAX_RATE_RAD_S: Final = 50.0
_FRESH_S: Final = 0.1  # up to this age the heading is propagated at its own rate, then by the yaw model,
_FADE_S: Final = 1.0  # and the residual rate decays
_SILENT_S: Final = 0.5
_SELDOM_S: Final = 0.3  # period of readings that counts as slow
_PAUSES: Final = 0.2  # weight of the latest period in the mean
_MOST_PAUSE_S: Final = 1.5
_TURNING_RAD_S: Final = 0.1  # changes of yaw rate below this carry no information on latency
_COURSE_S: Final = 5.0  # time constant of the correction by course over ground, with a gyro
_COURSE_ALONE_S: Final = 0.7  # and without,
_ALONE_RAD: Final = 0.1  # with more uncertainty,
_LEAN_S: Final = 4.0  # where it also corrects the yaw bias


class HeadingPropagation:
    """heading_rad and yaw_rate_rad_s are present values; `filter` holds those of the latest reading."""

    def __init__(self, gate_rad: float) -> None:
        """gate_rad: largest accepted difference of compass and gyro."""
        self.filter = HeadingFilter(gate_rad)
        self.model = YawRateModel()
        self.latency = LatencyEstimator(_TURNING_RAD_S)  # of compass and gyro
        self.heading_rad = self.yaw_rate_rad_s = 0.0
        self._stamp_s = -math.inf  # arrival of the latest reading
        self._pause_s = 0.0  # mean period of readings

        # Of the yaw model, at the measurement time of the latest reading
        self._reading_turned_rad = self._reading_turning = 0.0

    @property
    def is_late(self) -> bool:
        """Whether readings are late or infrequent."""
        return self.latency.lag_s > 0.0 or self._pause_s > _SELDOM_S

    def advance(self, reading: HeadingReading | None, now_s: float, dt_s: float) -> None:
        """Advance by dt_s to now_s, with the latest reading."""
        heading = self.filter
        if reading is not None and self._stamp_s < reading.time_s <= now_s:
            self._ingest(reading)
        if heading.time_s == -math.inf:
            return
        ahead_s = now_s - heading.time_s
        if ahead_s <= _FRESH_S:
            self.yaw_rate_rad_s = heading.yaw_rate_rad_s
            self.heading_rad = wrap_pi(heading.heading_rad + heading.yaw_rate_rad_s * ahead_s)
            return
        model, fading = self.model, math.exp(-ahead_s / _FADE_S)
        residual_rate = heading.yaw_rate_rad_s - model.rate_of(self._reading_turning)  # residual rate
        self.yaw_rate_rad_s = model.rate_rad_s + residual_rate * fading
        turned = model.turned_rad + model.rate_rad_s * (now_s - model.time_s) - self._reading_turned_rad
        self.heading_rad = wrap_pi(heading.heading_rad + turned + residual_rate * _FADE_S * (1.0 - fading))
        if now_s - self._stamp_s > _SILENT_S:
            heading.add_process_noise(dt_s)

    def steer(self, now_s: float, left: float, right: float, rudder: float = 0.0) -> None:
        """Advance the yaw model with the motor commands and the rudder's moment up to now."""
        self.model.advance(now_s, left, right, rudder)
        if self.latency.is_due(now_s):
            self.latency.add_expected(now_s, complex(self.model.rate_of(self.model.turning), 0.0))

    def learn(self, now_s: float, dt_s: float) -> None:
        """Update the yaw model from the gyro."""
        if not self.latency.is_uncertain(now_s):
            self.model.learn(self.filter.yaw_rate_rad_s, self._reading_turning, dt_s)

    def correct_by_course(self, turn_rad: float, dt_s: float, doubt_rad: float) -> None:
        """Correct the heading by turn_rad, from the course over ground; doubt_rad: standard deviation."""
        if self.filter.has_gyro:
            self.filter.correct(turn_rad, _COURSE_S, dt_s, doubt_rad)
        else:
            self.filter.correct(turn_rad, _COURSE_ALONE_S, dt_s, doubt_rad + _ALONE_RAD)
            self.model.adjust_bias(turn_rad * dt_s / (_COURSE_ALONE_S * _LEAN_S))

    def _ingest(self, reading: HeadingReading) -> None:
        """Process a reading of compass and gyro at its stamp less its latency."""
        heading, model, late = self.filter, self.model, self.latency
        rate, stamp_s = reading.yaw_rate_rad_s, reading.time_s
        is_heading = abs(reading.heading_rad) <= MAX_HEADING_RAD
        if not is_heading and (rate is None or not math.isnan(reading.heading_rad)):
            return
        if rate is not None and not abs(rate) <= MAX_RATE_RAD_S:
            return
        pause_s = stamp_s - self._stamp_s
        self._stamp_s = stamp_s
        if pause_s > PAUSE_S:
            if pause_s < math.inf:
                late.note_gap(stamp_s, pause_s)
            pause_s = min(pause_s, _MOST_PAUSE_S)
        self._pause_s += _PAUSES * (pause_s - self._pause_s)
        lag_s = late.lag_s
        time_s = stamp_s - lag_s
        dt = time_s - heading.time_s
        if not dt > 0.0:
            return  # the latency was underestimated before
        turned, turning, extra_turn = model.turned_rad, model.turning, 0.0
        if lag_s > 0.0:
            turned, turning = model.at(time_s)
        if dt > _FRESH_S:
            rates = model.rate_of(turning) + model.rate_of(self._reading_turning)
            extra_turn = turned - self._reading_turned_rad - 0.5 * rates * dt
        heading.update(time_s, reading.heading_rad, rate, extra_turn)
        self._reading_turned_rad, self._reading_turning = turned, turning
        if stamp_s > late.until_s and lag_s == 0.0:
            return
        is_otherwise_late = late.compare(stamp_s, complex(heading.yaw_rate_rad_s, 0.0))
        if is_otherwise_late and is_heading and not heading.is_off:
            time_s = stamp_s - late.lag_s
            heading.start(time_s, reading.heading_rad, rate)
            self._reading_turned_rad, self._reading_turning = model.at(time_s)
