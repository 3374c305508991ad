"""Motion model of the boat: heading, speed through the water and current, and how GNSS fixes correct them."""

import cmath
import math
from typing import Final

from companion.config.boat_config import Speed
from companion.config.drive import DIFFERENTIAL, DriveSetting
from companion.config.estimation import Estimation
from companion.control.allocation import rudder_effect
from companion.core.state import EstimateFault, MotorCommand
from companion.estimation.current import CurrentFilter
from companion.estimation.heading_consistency import HeadingConsistencyMonitor, HeadingVerdict
from companion.estimation.heading_propagation import HeadingPropagation
from companion.estimation.position import UNMODELLED_S
from companion.estimation.state_history import StateHistory
from companion.estimation.water_speed import WaterSpeed
from companion.sensors.readings import HeadingReading

# A boat approaches its target while the heading error is below 90°, which is 2.2 of these standard
# deviations. With a larger one the heading is lost.
LOST_RAD: Final = 0.7
BLIND_RAD: Final = 0.45  # heading uncertainty that makes dead reckoning useless: error of half the distance
FOUND_RAD: Final = 0.4  # uncertainty at which a lost heading counts as found
_UNDER_WAY: Final = 0.4  # share of cruise speed above which the course is informative,
_CREEPING: Final = 0.15  # and the least that is used if there is no other heading source
_SLIP: Final = 0.2  # of speed × yaw rate: model error in a turn,
_SURGE: Final = 0.3  # and of the acceleration
# time constant with which unmodelled velocity is assigned to the speed through the water
_NUDGE_S: Final = 4.0
_STRIDE_S: Final = 0.039  # the hull is slow: every second tick is enough
_IDLE_S: Final = 2.0  # without thrust
_COURSE_SIGMA_RAD: Final = 0.03
_COURSE_SIGMA_M_S: Final = 0.04
_OFF_RAD: Final = 0.6  # between course and compass
_OFF_S: Final = 4.0
_STEADY_RAD_S: Final = 0.1  # in a turn, a receiver with latency reports another course
_GOOD_AGAIN_RAD: Final = 0.35
# Plain numbers: an IntFlag's arithmetic costs microseconds
_LOST: Final = int(EstimateFault.COMPASS_LOST)
_OFF: Final = int(EstimateFault.COMPASS_OFF)
_LATE: Final = int(EstimateFault.COMPASS_LATE)
_HEADING_LOST: Final = int(EstimateFault.HEADING_LOST)


class Model:
    """now_s is the tick, idle_since_s the last time with thrust.

    Speed figures are those of the configuration at the start: changing cruise speed does not change the
    motors.
    """

    def __init__(self, speed: Speed, setting: Estimation, drive: DriveSetting = DIFFERENTIAL) -> None:
        self._speed, self._drive = speed, drive
        self.cruise_m_s, self._cruise_throttle = speed.cruise_m_s, speed.cruise_throttle
        self._surge_time_s = setting.surge_time_s
        self._compass_timeout_s = setting.compass_timeout_s
        self.propagation = HeadingPropagation(setting.compass_gate_rad)
        self.heading = self.propagation.filter
        self.water = WaterSpeed()
        self.history = StateHistory()
        self.current = CurrentFilter(speed.cruise_m_s, setting.compass_doubt_rad)
        self.now_s = 0.0
        self.idle_since_s = 0.0
        self._consistency = HeadingConsistencyMonitor()
        self._starts = 0  # of the heading, as known to the monitor
        self._off_rad = 0.0
        self._is_turned_off = False
        self._is_lost = False  # the heading

    @property
    def has_heading(self) -> bool:
        """Whether there has ever been a heading."""
        return self.heading.time_s > -math.inf

    @property
    def is_compass_good(self) -> bool:
        """Whether the heading relies on the compass."""
        heading = self.heading
        return not heading.is_off and self.now_s - heading.compass_s <= self._compass_timeout_with_lag_s

    def advance(self, reading: HeadingReading | None, now_s: float, command: MotorCommand | None) -> float:
        """Advance to now_s; returns the heading without the compass offset.

        command: the motor command since the last call; None if unknown, taken as zero.
        """
        propagation, dt = self.propagation, now_s - self.now_s
        self.now_s = now_s
        propagation.advance(reading, now_s, dt)
        if self.heading.time_s == -math.inf:
            return 0.0
        dt = now_s - self.history.time_s
        if dt >= _STRIDE_S:
            self._move(propagation.heading_rad, now_s, dt, command)
        return propagation.heading_rad

    @property
    def _compass_timeout_with_lag_s(self) -> float:
        """Longest accepted silence of the compass."""
        return self._compass_timeout_s + self.propagation.latency.lag_s

    def _move(self, yaw: float, now_s: float, dt: float, command: MotorCommand | None) -> None:
        """Advance the speed through the water."""
        heading, velocity = self.heading, 0j
        if command is not None:
            water = self.water
            left, right = command.left, command.right
            water.update(
                left, right, self.propagation.yaw_rate_rad_s, self.cruise_m_s, self._cruise_throttle,
                self._surge_time_s, dt,
            )  # fmt: skip
            velocity = complex(water.surge_m_s, water.sway_m_s) * complex(math.cos(yaw), math.sin(yaw))
            if left or right:
                self.idle_since_s = now_s
            rudder = command.rudder
            if rudder:
                rudder *= rudder_effect(0.5 * (left + right), water.surge_m_s, self._drive, self._speed)
            self.propagation.steer(now_s, left, right, rudder)
        heading.is_idle = now_s - self.idle_since_s > _IDLE_S
        self.history.advance(now_s, velocity)

    def process_noise_m2_s3(self, through: complex) -> float:
        """Additional process noise while turning or accelerating."""
        slip = _SLIP * self.propagation.yaw_rate_rad_s * abs(through)
        surge = _SURGE * self.water.surge_m_s2
        return slip * slip + surge * surge

    def learn(
        self, velocity: complex, through: complex, variance: float, noise_m2_s3: float, dt: float
    ) -> complex:
        """Update current, gain and compass offset from simultaneous velocities over ground and through the
        water.

        variance: of the measured velocity, per axis. noise_m2_s3: of the model. Returns the increase of the
        modelled velocity.
        """
        if not self.has_heading:
            return 0j
        if not self.is_compass_good:
            self._correct_by_course(velocity, through, dt)
            return 0j
        self._compare_course(velocity, through, dt)
        self.propagation.learn(self.now_s, dt)
        if self.heading.has_gyro and self._is_compass_faulty(velocity, through, dt):
            return self._reject_compass(through)
        # The model error is correlated over UNMODELLED_S: a fix has less information than its variance says.
        return self.current.update(
            velocity, through, variance + noise_m2_s3 * UNMODELLED_S * UNMODELLED_S / dt, dt
        )

    def _is_compass_faulty(self, velocity: complex, through: complex, dt: float) -> bool:
        """Whether the consistency monitor finds the compass faulty."""
        heading, monitor = self.heading, self._consistency
        if heading.starts != self._starts:
            self._starts = heading.starts
            monitor.reset(heading.corrected_rad, heading.bias_rad_s)
        monitor.update(heading.corrected_rad, heading.bias_rad_s, dt)
        if not monitor.is_disagreeing:
            monitor.record(self.current.current_m_s, self.current.gain, dt)
            return False
        verdict = monitor.judge(velocity, through, dt)
        if verdict is HeadingVerdict.GYRO:
            monitor.reset(heading.corrected_rad, heading.bias_rad_s)
        return verdict is HeadingVerdict.COMPASS

    def _reject_compass(self, through: complex) -> complex:
        """Reject the compass and undo what was learned from it; returns as `learn` does."""
        current, monitor = self.current, self._consistency
        before = current.velocity_m_s(through)
        self.heading.reject_offset(monitor.gap_rad, monitor.bias_rad_s)
        current.restore(monitor.current_m_s, monitor.gain)
        after = current.velocity_m_s(through * cmath.rect(1.0, monitor.gap_rad))
        monitor.reset(self.heading.corrected_rad, monitor.bias_rad_s)
        return after - before

    def absorb_unmodelled(self, unmodelled_m_s: complex, dt: float) -> complex:
        """Move the unmodelled velocity along the bow into the speed through the water.

        Returns the increase of the modelled velocity.
        """
        if not self.has_heading:
            return 0j
        yaw, gain = self.propagation.heading_rad, self.current.gain
        bow = gain * complex(math.cos(yaw), math.sin(yaw))
        ahead = (unmodelled_m_s * bow.conjugate()).real / (abs(gain) ** 2)
        step = min(dt / _NUDGE_S, 1.0) * ahead
        self.water.surge_m_s += step
        return step * bow

    def doubt_m_s(self) -> float:
        """Standard deviation, per axis, of the modelled velocity over ground."""
        through = self.history.velocity_m_s
        doubt = 0.01 if self.is_compass_good else self.heading.sigma_rad
        variance = self.current.variance(through) + (doubt * abs(through)) ** 2
        return math.sqrt(max(variance, 0.0))

    def is_blind(self) -> bool:
        """Whether the heading is too uncertain for dead reckoning."""
        return not self.has_heading or self._is_lost or self.heading.sigma_rad > BLIND_RAD

    def faults(self) -> int:
        """Bits of EstimateFault."""
        heading, faults = self.heading, 0
        if not self.has_heading:
            return 0
        if heading.is_off or self._is_turned_off:
            faults = _OFF
        elif self.now_s - heading.compass_s > self._compass_timeout_with_lag_s:
            faults = _LOST
        elif self.propagation.is_late:
            faults = _LATE
        self._is_lost = heading.sigma_rad > (FOUND_RAD if self._is_lost else LOST_RAD)
        return faults | _HEADING_LOST if self._is_lost else faults

    def _course_turn_rad(self, velocity: complex, through: complex) -> float:
        """Angle from the bow to the course through the water; NaN if there is no course."""
        is_alone = not self.heading.has_gyro and not self.is_compass_good
        current, least = self.current, (_CREEPING if is_alone else _UNDER_WAY) * self.cruise_m_s
        course, bow = velocity - current.current_m_s, current.gain * through
        if abs(course) < least or abs(bow) < least:
            return math.nan
        return cmath.phase(course / bow)

    def _correct_by_course(self, velocity: complex, through: complex, dt: float) -> None:
        """Correct the heading by the course over ground."""
        current_m_s = self.current.current_m_s
        turn = self._course_turn_rad(velocity, through)
        if not math.isnan(turn):
            doubt_m_s = math.sqrt(self.current.current_variance()) + _COURSE_SIGMA_M_S
            doubt = doubt_m_s / abs(velocity - current_m_s) + _COURSE_SIGMA_RAD
            self.propagation.correct_by_course(turn, dt, doubt)

    def _compare_course(self, velocity: complex, through: complex, dt: float) -> None:
        """Compare the compass with the course; a large difference is a compass fault."""
        if abs(self.propagation.yaw_rate_rad_s) > _STEADY_RAD_S:
            return
        turn = self._course_turn_rad(velocity, through)
        self._off_rad += min(dt / _OFF_S, 1.0) * ((0.0 if math.isnan(turn) else turn) - self._off_rad)
        if abs(self._off_rad) > _OFF_RAD:
            self.current.rotate(self._off_rad, 0.2)
            self._off_rad = 0.0
        self._is_turned_off = abs(self.current.turn_rad) > _GOOD_AGAIN_RAD
