"""How the boat moves by itself: heading, way through the water, and the set; what fixes teach about them."""

import cmath
import math
from typing import Final

from companion.config.boat_config import Speed
from companion.config.estimation import Estimation
from companion.core.state import EstimateFault, MotorCommand
from companion.estimation.current import CurrentFilter
from companion.estimation.heading_consistency import HeadingConsistencyMonitor, HeadingVerdict
from companion.estimation.heading_propagation import HeadingPropagation
from companion.estimation.position import UNMODELLED_S
from companion.estimation.state_history import StateHistory
from companion.estimation.water_speed import WaterSpeed
from companion.sensors.readings import HeadingReading

# A boat that steers for a point comes nearer while its heading is off by less than a right angle. That is 2.2
# standard deviations of this: a heading known no better is lost.
LOST_RAD: Final = 0.7
BLIND_RAD: Final = 0.45  # dead reckoning by a heading known no better is off by half of the way
FOUND_RAD: Final = 0.4  # and known again at this: by its course at a walking pace, not while it creeps
_UNDER_WAY: Final = 0.4  # share of cruise speed that tells a course,
_CREEPING: Final = 0.15  # and that which has to do where nothing else tells where the bow points
_SLIP: Final = 0.2  # of speed × yaw rate: what the model gets wrong in a turn,
_SURGE: Final = 0.3  # and of its own acceleration
_NUDGE_S: Final = 4.0  # how fast what is not modelled is taken for way through the water
_STRIDE_S: Final = 0.039  # the hull is slow: every second tick is enough
_IDLE_S: Final = 2.0  # without thrust
_COURSE_SIGMA_RAD: Final = 0.03
_COURSE_SIGMA_M_S: Final = 0.04
_OFF_RAD: Final = 0.6  # between course and compass
_OFF_S: Final = 4.0
_STEADY_RAD_S: Final = 0.1  # in a turn a receiver that lags shows another course
_GOOD_AGAIN_RAD: Final = 0.35
# Plain numbers: an IntFlag's arithmetic costs microseconds
_LOST: Final = int(EstimateFault.COMPASS_LOST)
_OFF: Final = int(EstimateFault.COMPASS_OFF)
_LATE: Final = int(EstimateFault.COMPASS_LATE)
_HEADING_LOST: Final = int(EstimateFault.HEADING_LOST)


class Model:
    """Heading, water speed, wake and current. now_s is the tick, idle_since_s when thrust was last asked for.

    The boat's size is taken from the configuration of its start: a cruise speed that is changed under way
    does not change what its motors do.
    """

    __slots__ = (
        "_compass_timeout_s",
        "_consistency",
        "_cruise_throttle",
        "_is_lost",
        "_is_turned_off",
        "_off_rad",
        "_starts",
        "_surge_time_s",
        "cruise_m_s",
        "current",
        "heading",
        "history",
        "idle_since_s",
        "now_s",
        "propagation",
        "water",
    )  # fmt: skip

    def __init__(self, speed: Speed, setting: Estimation) -> None:
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
        self._starts = 0  # of the heading, as the witness has it
        self._off_rad = 0.0
        self._is_turned_off = False
        self._is_lost = False  # the heading

    @property
    def has_heading(self) -> bool:
        """Whether the heading has ever been known."""
        return self.heading.time_s > -math.inf

    @property
    def is_compass_good(self) -> bool:
        """Whether the heading rests on the compass."""
        heading = self.heading
        return not heading.is_off and self.now_s - heading.compass_s <= self._compass_timeout_with_lag_s

    def advance(self, reading: HeadingReading | None, now_s: float, command: MotorCommand | None) -> float:
        """Go on to now_s; the heading of then, without the compass's offset.

        command: what the motors have been doing meanwhile; None: nobody knows, so nothing.
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
        """For how long nothing need be heard of the compass."""
        return self._compass_timeout_s + self.propagation.latency.lag_s

    def _move(self, yaw: float, now_s: float, dt: float, command: MotorCommand | None) -> None:
        """Go on through the water."""
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
            self.propagation.steer(now_s, left, right)
        heading.is_idle = now_s - self.idle_since_s > _IDLE_S
        self.history.advance(now_s, velocity)

    def process_noise_m2_s3(self, through: complex) -> float:
        """How noisy the model is just now, because the boat turns or gathers way."""
        slip = _SLIP * self.propagation.yaw_rate_rad_s * abs(through)
        surge = _SURGE * self.water.surge_m_s2
        return slip * slip + surge * surge

    def learn(
        self, velocity: complex, through: complex, variance: float, noise_m2_s3: float, dt: float
    ) -> complex:
        """Set, gain and compass from a velocity over ground and the one through the water at the same time.

        variance: of the measured velocity, per axis. noise_m2_s3: of the model. Returns by how much more of
        the velocity is modelled now.
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
        # What is not modelled lasts for UNMODELLED_S, so each fix tells less than its own variance says.
        return self.current.update(
            velocity, through, variance + noise_m2_s3 * UNMODELLED_S * UNMODELLED_S / dt, dt
        )

    def _is_compass_faulty(self, velocity: complex, through: complex, dt: float) -> bool:
        """Whether the witness knows that the compass has led the heading astray."""
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
        """The compass is not believed any more, nor what it has taught; what `learn` returns."""
        current, monitor = self.current, self._consistency
        before = current.velocity_m_s(through)
        self.heading.reject_offset(monitor.gap_rad, monitor.bias_rad_s)
        current.restore(monitor.current_m_s, monitor.gain)
        after = current.velocity_m_s(through * cmath.rect(1.0, monitor.gap_rad))
        monitor.reset(self.heading.corrected_rad, monitor.bias_rad_s)
        return after - before

    def absorb_unmodelled(self, unmodelled_m_s: complex, dt: float) -> complex:
        """Way that the boat still has, or has not yet, shows in what is not modelled: take it for that.

        Returns by how much more of the velocity is modelled now.
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
        """One standard deviation, per axis, of the velocity over ground that the model gives now."""
        through = self.history.velocity_m_s
        doubt = 0.01 if self.is_compass_good else self.heading.sigma_rad
        variance = self.current.variance(through) + (doubt * abs(through)) ** 2
        return math.sqrt(max(variance, 0.0))

    def is_blind(self) -> bool:
        """Whether the heading is too uncertain to reckon a position by."""
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
        """How far the boat's course through the water is off its bow, NaN while there is no course."""
        is_alone = not self.heading.has_gyro and not self.is_compass_good
        current, least = self.current, (_CREEPING if is_alone else _UNDER_WAY) * self.cruise_m_s
        course, bow = velocity - current.current_m_s, current.gain * through
        if abs(course) < least or abs(bow) < least:
            return math.nan
        return cmath.phase(course / bow)

    def _correct_by_course(self, velocity: complex, through: complex, dt: float) -> None:
        """Where the bow points, from where the boat goes."""
        current_m_s = self.current.current_m_s
        turn = self._course_turn_rad(velocity, through)
        if not math.isnan(turn):
            doubt_m_s = math.sqrt(self.current.current_variance()) + _COURSE_SIGMA_M_S
            doubt = doubt_m_s / abs(velocity - current_m_s) + _COURSE_SIGMA_RAD
            self.propagation.correct_by_course(turn, dt, doubt)

    def _compare_course(self, velocity: complex, through: complex, dt: float) -> None:
        """Whether the compass goes with the course; if not by far, it is the compass that is wrong."""
        if abs(self.propagation.yaw_rate_rad_s) > _STEADY_RAD_S:
            return
        turn = self._course_turn_rad(velocity, through)
        self._off_rad += min(dt / _OFF_S, 1.0) * ((0.0 if math.isnan(turn) else turn) - self._off_rad)
        if abs(self._off_rad) > _OFF_RAD:
            self.current.rotate(self._off_rad, 0.2)
            self._off_rad = 0.0
        self._is_turned_off = abs(self.current.turn_rad) > _GOOD_AGAIN_RAD
