"""How the boat moves by itself: heading, way through the water, and the set; what fixes teach about them."""

import cmath
import math
from typing import Final

from companion.config import Speed
from companion.estimation.current import CurrentFilter
from companion.estimation.heading import HeadingFilter
from companion.estimation.lag_watch import LagWatch
from companion.estimation.position import UNMODELLED_S
from companion.estimation.wake import Wake
from companion.estimation.water_speed import WaterSpeed
from companion.estimation.yaw_model import YawModel
from companion.sensors.readings import HeadingReading
from companion.settings.estimation import Estimation
from companion.state import EstimateFault, MotorCommand
from companion.units import wrap_pi

MAX_HEADING_RAD: Final = 100.0  # what lies beyond these two is a fault of the part
MAX_RATE_RAD_S: Final = 50.0
LOST_RAD: Final = 0.45  # a heading that is known no better is none
_UNDER_WAY: Final = 0.4  # share of cruise speed that tells a course
_SLIP: Final = 0.2  # of speed × yaw rate: what the model gets wrong in a turn,
_SURGE: Final = 0.3  # and of its own acceleration
_NUDGE_S: Final = 4.0  # how fast what is not modelled is taken for way through the water
_STRIDE_S: Final = 0.039  # the hull is slow: every second tick is enough
_IDLE_S: Final = 2.0  # without thrust
_COURSE_S: Final = 5.0  # how fast the course made good draws the heading, with a gyro
_COURSE_ALONE_S: Final = 0.7  # and without one
_COURSE_SIGMA_RAD: Final = 0.05
_OFF_RAD: Final = 0.6  # between course and compass
_OFF_S: Final = 4.0
_STEADY_RAD_S: Final = 0.1  # in a turn a receiver that lags shows another course
_GOOD_AGAIN_RAD: Final = 0.35
_FRESH_S: Final = 0.1  # a heading this old is carried on at its own rate, an older one by the yaw model,
_SELDOM_S: Final = 0.3  # from one reading to the next
_PAUSES: Final = 0.2  # share of the latest one in what is usual
_MOST_PAUSE_S: Final = 1.5
_FADE_S: Final = 1.0  # and what that does not know of its rate fades
_SILENT_S: Final = 0.5
_TURNING_RAD_S: Final = 0.1  # less turning to and fro does not tell how late the compass is
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
        "_compass_timeout_s", "_cruise_throttle", "_heard_s", "_is_turned_off", "_odd_rad_s", "_off_rad",
        "_pause_s", "_rate_then_rad_s", "_surge_time_s", "_turned_then_rad", "_turning_then", "_yaw_rad",
        "cruise_m_s", "current", "heading", "idle_since_s", "late", "now_s", "wake", "water", "yaw",
        "yaw_rate_rad_s",
    )  # fmt: skip

    def __init__(self, speed: Speed, setting: Estimation) -> None:
        self.cruise_m_s, self._cruise_throttle = speed.cruise_m_s, speed.cruise_throttle
        self._surge_time_s = setting.surge_time_s
        self._compass_timeout_s = setting.compass_timeout_s
        self.heading = HeadingFilter(setting.compass_gate_rad)
        self.water = WaterSpeed()
        self.wake = Wake()
        self.current = CurrentFilter(speed.cruise_m_s, setting.compass_doubt_rad)
        self.now_s = 0.0
        self.idle_since_s = 0.0
        self.yaw = YawModel()
        self.late = LagWatch(_TURNING_RAD_S)  # the compass, with its gyro
        self.yaw_rate_rad_s = self._yaw_rad = 0.0
        self._heard_s = -math.inf  # when the latest reading came, whatever it is about
        # The yaw model's, at the time that the latest reading is about
        self._turned_then_rad = self._rate_then_rad_s = self._turning_then = 0.0
        self._pause_s = 0.0  # usual between two readings
        self._odd_rad_s = 0.0  # what the yaw model did not know of its rate
        self._off_rad = 0.0
        self._is_turned_off = False

    @property
    def has_heading(self) -> bool:
        """Whether the heading has ever been known."""
        return self.heading.time_s > -math.inf

    @property
    def is_compass_good(self) -> bool:
        """Whether the heading rests on the compass."""
        heading = self.heading
        return not heading.is_off and self.now_s - heading.compass_s <= self._patience_s

    def advance(self, reading: HeadingReading | None, now_s: float, command: MotorCommand | None) -> float:
        """Go on to now_s; the heading of then, without the compass's offset.

        command: what the motors have been doing meanwhile; None: nobody knows, so nothing.
        """
        heading, dt = self.heading, now_s - self.now_s
        self.now_s = now_s
        if reading is not None and self._heard_s < reading.time_s <= now_s:
            self._hear(reading)
        if heading.time_s == -math.inf:
            return 0.0
        ahead_s = now_s - heading.time_s
        if ahead_s <= _FRESH_S:
            self.yaw_rate_rad_s = heading.yaw_rate_rad_s
            yaw = wrap_pi(heading.heading_rad + heading.yaw_rate_rad_s * ahead_s)
        else:
            yaw = self._reckon_yaw(ahead_s, now_s)
            if now_s - self._heard_s > _SILENT_S:
                heading.stray(dt)
        self._yaw_rad = yaw
        dt = now_s - self.wake.time_s
        if dt >= _STRIDE_S:
            self._move(yaw, now_s, dt, command)
        return yaw

    def _hear(self, reading: HeadingReading) -> None:
        """Take a reading of compass and gyro, about the time that its stamp less its lag says."""
        heading, model, late = self.heading, self.yaw, self.late
        self._pause_s += _PAUSES * (min(reading.time_s - self._heard_s, _MOST_PAUSE_S) - self._pause_s)
        self._heard_s = reading.time_s
        time_s = reading.time_s - late.lag_s
        dt = time_s - heading.time_s
        if not dt > 0.0:
            return  # stamps were believed before that have turned out too fresh
        turned, turning, bent = model.turned_rad, model.turning, 0.0
        if late.lag_s > 0.0:
            turned, turning = model.at(time_s)
        rate = model.rate_of(turning)
        if dt > _FRESH_S:
            bent = turned - self._turned_then_rad - 0.5 * (rate + self._rate_then_rad_s) * dt
        if not _take_heading(heading, reading, time_s, bent):
            return
        self._turned_then_rad, self._rate_then_rad_s, self._turning_then = turned, rate, turning
        self._odd_rad_s = heading.yaw_rate_rad_s - rate
        late.compare(reading.time_s, complex(heading.yaw_rate_rad_s, 0.0))

    def _reckon_yaw(self, ahead_s: float, now_s: float) -> float:
        """The heading of now, from an old one and how the boat has been steered since."""
        model, heading = self.yaw, self.heading
        fading = math.exp(-ahead_s / _FADE_S)
        self.yaw_rate_rad_s = model.rate_rad_s + self._odd_rad_s * fading
        turned = model.turned_rad + model.rate_rad_s * (now_s - model.time_s) - self._turned_then_rad
        return wrap_pi(heading.heading_rad + turned + self._odd_rad_s * _FADE_S * (1.0 - fading))

    @property
    def _patience_s(self) -> float:
        """For how long nothing need be heard of the compass."""
        return self._compass_timeout_s + self.late.lag_s

    def _move(self, yaw: float, now_s: float, dt: float, command: MotorCommand | None) -> None:
        """Go on through the water."""
        heading, velocity = self.heading, 0j
        if command is not None:
            water = self.water
            left, right = command.left, command.right
            water.update(
                left, right, self.yaw_rate_rad_s, self.cruise_m_s, self._cruise_throttle,
                self._surge_time_s, dt,
            )  # fmt: skip
            velocity = complex(water.surge_m_s, water.sway_m_s) * complex(math.cos(yaw), math.sin(yaw))
            if left or right:
                self.idle_since_s = now_s
            self.yaw.advance(now_s, left, right)
            if self.late.is_due(now_s):
                self.late.expect(now_s, complex(self.yaw.rate_of(self.yaw.turning), 0.0))
        heading.is_idle = now_s - self.idle_since_s > _IDLE_S
        self.wake.advance(now_s, velocity)

    def pushed_m2_s3(self, through: complex) -> float:
        """How noisy the model is just now, because the boat turns or gathers way."""
        slip = _SLIP * self.yaw_rate_rad_s * abs(through)
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
            self._draw_to_course(velocity, through, dt)
            return 0j
        self._compare_course(velocity, through, dt)
        self._learn_yaw(dt)
        # What is not modelled lasts for UNMODELLED_S, so each fix tells less than its own variance says.
        return self.current.update(
            velocity, through, variance + noise_m2_s3 * UNMODELLED_S * UNMODELLED_S / dt, dt
        )

    def nudge(self, unmodelled_m_s: complex, dt: float) -> complex:
        """Way that the boat still has, or has not yet, shows in what is not modelled: take it for that.

        Returns by how much more of the velocity is modelled now.
        """
        if not self.has_heading:
            return 0j
        yaw, gain = self._yaw_rad, self.current.gain
        bow = gain * complex(math.cos(yaw), math.sin(yaw))
        ahead = (unmodelled_m_s * bow.conjugate()).real / (abs(gain) ** 2)
        step = min(dt / _NUDGE_S, 1.0) * ahead
        self.water.surge_m_s += step
        return step * bow

    def doubt_m_s(self) -> float:
        """One standard deviation, per axis, of the velocity over ground that the model gives now."""
        through = self.wake.velocity_m_s
        doubt = 0.01 if self.is_compass_good else self.heading.sigma_rad
        variance = self.current.variance(through) + (doubt * abs(through)) ** 2
        return math.sqrt(max(variance, 0.0))

    def is_blind(self) -> bool:
        """Whether nobody knows where the bow points."""
        return not self.has_heading or self.heading.sigma_rad > LOST_RAD

    def faults(self) -> int:
        """Bits of EstimateFault."""
        heading, faults = self.heading, 0
        if not self.has_heading:
            return 0
        if heading.is_off or self._is_turned_off:
            faults = _OFF
        elif self.now_s - heading.compass_s > self._patience_s:
            faults = _LOST
        elif self.late.lag_s > 0.0 or self._pause_s > _SELDOM_S:
            faults = _LATE
        return faults | _HEADING_LOST if heading.sigma_rad > LOST_RAD else faults

    def _learn_yaw(self, dt: float) -> None:
        """How fast steering turns the boat, for the day when no gyro says so."""
        if not self.late.is_odd:
            self.yaw.learn(self.heading.yaw_rate_rad_s, self._turning_then, dt)

    def _course_turn_rad(self, velocity: complex, through: complex) -> float:
        """How far the boat's course through the water is off its bow, NaN while there is no course."""
        current, least = self.current, _UNDER_WAY * self.cruise_m_s
        course, bow = velocity - current.set_m_s, current.gain * through
        if abs(course) < least or abs(bow) < least:
            return math.nan
        return cmath.phase(course / bow)

    def _draw_to_course(self, velocity: complex, through: complex, dt: float) -> None:
        """Where the bow points, from where the boat goes."""
        heading, set_m_s = self.heading, self.current.set_m_s
        turn = self._course_turn_rad(velocity, through)
        if not math.isnan(turn):
            doubt = math.sqrt(self.current.set_variance()) / abs(velocity - set_m_s) + _COURSE_SIGMA_RAD
            heading.draw(turn, _COURSE_S if heading.has_gyro else _COURSE_ALONE_S, dt, doubt)

    def _compare_course(self, velocity: complex, through: complex, dt: float) -> None:
        """Whether the compass goes with the course; if not by far, it is the compass that is wrong."""
        if abs(self.yaw_rate_rad_s) > _STEADY_RAD_S:
            return
        turn = self._course_turn_rad(velocity, through)
        self._off_rad += min(dt / _OFF_S, 1.0) * ((0.0 if math.isnan(turn) else turn) - self._off_rad)
        if abs(self._off_rad) > _OFF_RAD:
            self.current.turn(self._off_rad, 0.2)
            self._off_rad = 0.0
        self._is_turned_off = abs(self.current.turn_rad) > _GOOD_AGAIN_RAD


def _take_heading(compass: HeadingFilter, reading: HeadingReading, time_s: float, bent_rad: float) -> bool:
    """Whether it was taken."""
    rate, heading = reading.yaw_rate_rad_s, reading.heading_rad
    is_heading = abs(heading) <= MAX_HEADING_RAD
    if rate is None:
        if not is_heading:
            return False
    elif not (abs(rate) <= MAX_RATE_RAD_S and (is_heading or math.isnan(heading))):
        return False
    compass.update(time_s, heading, rate, bent_rad)
    return True
