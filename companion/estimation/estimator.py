"""The boat's estimate: position, velocity, heading and the set of the water from whatever is heard.

Every tick the boat is carried on by thrust, heading and set (`water_speed.py`, `heading.py`, `current.py`); a
fix, once it arrives, corrects where the boat was when the fix was taken (`position.py`), and what that
teaches moves the boat of now. So an outage of the receiver changes nothing but the doubt: this is dead
reckoning all the time, with corrections (T. I. Fossen, *Handbook of Marine Craft Hydrodynamics and Motion
Control*, 2nd ed. 2021, chapters 13 and 14).

Vectors of the water plane are complex numbers, north + i east: turning one clockwise by ψ is multiplying it
by exp(iψ).

What cannot be known: a receiver whose positions and velocities are led astray together, slower than the boat
could be carried, is a current. A position that creeps away from its own velocities is noticed.
"""

import cmath
import math
from typing import Final

from companion.config import Speed
from companion.estimation.current import SET_SHARE, CurrentFilter
from companion.estimation.fix_watch import FixWatch
from companion.estimation.heading import MAX_PREDICTION_S, HeadingFilter
from companion.estimation.position import UNMODELLED_S, PositionFilter
from companion.estimation.wake import Wake
from companion.estimation.water_speed import WaterSpeed
from companion.geo import LocalFrame, Point
from companion.sensors.readings import GnssFix, HeadingReading
from companion.settings.estimation import Estimation
from companion.state import EstimateFault, MotorCommand, NavState
from companion.units import wrap_pi

MIN_FIX_TYPE: Final = 3  # a 3-D fix
SIGMA_PER_HDOP_M: Final = 0.8  # for receivers that do not say how accurate they are
MIN_SIGMA_M: Final = 0.001
MAX_SIGMA_M: Final = 1000.0  # what lies beyond these four is a fault of the part; comparisons let no NaN pass
MAX_SPEED_M_S: Final = 100.0
MAX_HEADING_RAD: Final = 100.0
MAX_RATE_RAD_S: Final = 50.0
MAX_OFFSET_M: Final = 100_000.0  # from the frame's origin: its projection holds no farther
VELOCITY_SIGMA_M_S: Final = 0.05  # Doppler velocity of a common receiver, per axis
_UNDER_WAY: Final = 0.4  # share of cruise speed that tells a course
_AT_REST: Final = 0.1
_SLIP: Final = 0.2  # of speed × yaw rate: what the model gets wrong in a turn,
_SURGE: Final = 0.3  # and of its own acceleration
_NUDGE_S: Final = 4.0  # how fast what is not modelled is taken for way through the water
_COURSE_S: Final = 5.0  # how fast the course made good draws the heading, with a gyro
_COURSE_ALONE_S: Final = 0.7  # and without one
_OFF_RAD: Final = 0.6  # between course and compass
_OFF_S: Final = 2.0
_GOOD_AGAIN_RAD: Final = 0.35
_LOST_RAD: Final = 0.45
_GAP_S: Final = 0.5  # a fix older than this lets the position stray
_REJECTED: Final = 0.5  # share of the last second's fixes that is too much
_ACCEPTED: Final = 0.1  # and all is well again
_IDLE_RESET_S: Final = 10.0
# Plain numbers: an IntFlag's arithmetic costs microseconds
_LOST: Final = int(EstimateFault.GNSS_LOST)
_FROZEN: Final = int(EstimateFault.GNSS_FROZEN)
_JUMPING: Final = int(EstimateFault.GNSS_JUMPING)
_COMPASS_LOST: Final = int(EstimateFault.COMPASS_LOST)
_COMPASS_OFF: Final = int(EstimateFault.COMPASS_OFF)
_POSITION_LOST: Final = int(EstimateFault.POSITION_LOST)
_HEADING_LOST: Final = int(EstimateFault.HEADING_LOST)


class Estimator:
    """`frame` is None before the first good fix. resets: how often the position was given up for another one.

    The boat's size is taken from the configuration of its start: a cruise speed that is changed under way
    does not change what its motors do.
    """

    __slots__ = (
        "_accepted_s", "_cruise_m_s", "_cruise_throttle", "_fix_s", "_idle_since_s", "_is_frozen",
        "_is_turned_off", "_now_s", "_off_rad", "_rejected", "_reset_counter", "_setting", "_strayed_m",
        "_watch", "_way_m", "current", "frame", "frame_to_lay", "heading", "position", "resets", "wake",
        "water",
    )  # fmt: skip

    def __init__(self, speed: Speed | None = None, setting: Estimation | None = None) -> None:
        """speed: what the motors achieve; setting: how much is believed."""
        speed, setting = speed or Speed(), setting or Estimation()
        self.frame: LocalFrame | None = None
        self.frame_to_lay: LocalFrame | None = None  # chosen beforehand; None: at the first good fix
        self.resets = 0
        self.water = WaterSpeed()
        self.wake = Wake()
        self.heading = HeadingFilter(setting.compass_gate_rad)
        self.current = CurrentFilter(speed.cruise_m_s, setting.compass_doubt_rad)
        self.position = PositionFilter(speed.cruise_m_s, setting.wander_s)
        self._setting = setting
        self._cruise_m_s, self._cruise_throttle = speed.cruise_m_s, speed.cruise_throttle
        self._watch = FixWatch()
        self._now_s = 0.0
        self._fix_s = self._accepted_s = -math.inf
        self._way_m = 0j  # through the water, at the time of the latest fix
        self._strayed_m = 0.0
        self._rejected = 0.0
        self._reset_counter = 0
        self._idle_since_s = 0.0
        self._is_frozen = self._is_turned_off = False
        self._off_rad = 0.0

    def update(
        self,
        fix: GnssFix | None,
        heading: HeadingReading | None,
        now_s: float,
        command: MotorCommand | None = None,
    ) -> NavState | None:
        """Advance to now_s. None before anything was accepted.

        command: what the motors have been doing since the last call; None: nobody knows, so nothing.
        With only one of position and heading known, the other one is 0 with an infinite age.
        """
        dt = now_s - self._now_s
        self._now_s = now_s
        yaw = self._steer(heading, now_s, dt, command)
        if fix is not None and self._fix_s < fix.time_s <= now_s and fix.fix_type >= MIN_FIX_TYPE:
            self._take_fix(fix)
        fix_age, heading_age = now_s - self._accepted_s, now_s - self.heading.time_s
        if fix_age == math.inf and heading_age == math.inf:
            return None
        current, position, wake = self.current, self.position, self.wake
        yaw = wrap_pi(yaw + current.turn_rad)
        sigma_m = 0.0
        if self.frame is None:
            here = velocity = 0j
        else:
            ahead_s = now_s - position.time_s
            fading = math.exp(-ahead_s / UNMODELLED_S)
            unmodelled = position.unmodelled_m_s
            carried = current.gain * (wake.way_m - self._way_m) + current.set_m_s * ahead_s
            here = position.position_m + carried + unmodelled * (UNMODELLED_S * (1.0 - fading))
            velocity = current.velocity_m_s(wake.velocity_m_s) + unmodelled * fading
            if fix_age > _GAP_S:
                self._stray(dt)
            sigma_m = math.sqrt(position.variance_m2) + self._strayed_m
        faults = self._faults(now_s, fix_age, sigma_m)
        through = velocity * complex(math.cos(yaw), -math.sin(yaw))
        set_m_s = current.set_m_s
        timeout_s = self._setting.gnss_timeout_s
        if timeout_s < fix_age < math.inf and not faults & (_POSITION_LOST | _HEADING_LOST):
            fix_age = timeout_s  # dead reckoning stands in
        return NavState(
            now_s,
            here.real,
            here.imag,
            yaw,
            self.heading.yaw_rate_rad_s,
            velocity.real,
            velocity.imag,
            through.real,
            through.imag,
            fix_age,
            heading_age,
            set_m_s.real,
            set_m_s.imag,
            sigma_m,
            faults,
        )

    def _steer(
        self, reading: HeadingReading | None, now_s: float, dt: float, command: MotorCommand | None
    ) -> float:
        """Take the heading, and go on through the water; the heading of now, without the compass's offset."""
        heading = self.heading
        if reading is not None and heading.time_s < reading.time_s <= now_s:
            _take_heading(heading, reading)
        if heading.time_s == -math.inf:
            self.wake.advance(now_s, 0j)
            return 0.0
        if now_s - heading.time_s > MAX_PREDICTION_S:
            heading.stray(dt)
        yaw = heading.heading_at_rad(now_s)
        velocity = 0j
        if command is not None:
            water = self.water
            water.update(
                command.left, command.right, heading.yaw_rate_rad_s, self._cruise_m_s, self._cruise_throttle,
                self._setting.surge_time_s, dt,
            )  # fmt: skip
            velocity = complex(water.surge_m_s, water.sway_m_s) * complex(math.cos(yaw), math.sin(yaw))
            if command.left or command.right:
                self._idle_since_s = now_s
        heading.is_idle = now_s - self._idle_since_s > _OFF_S
        self.wake.advance(now_s, velocity)
        return yaw

    def _take_fix(self, fix: GnssFix) -> None:
        sigma_m = fix.horizontal_accuracy_m
        if sigma_m is None:
            sigma_m = SIGMA_PER_HDOP_M * fix.hdop
        if not sigma_m <= MAX_SIGMA_M:
            return
        velocity = None
        if fix.north_m_s is not None and fix.east_m_s is not None:
            velocity = complex(fix.north_m_s, fix.east_m_s)
            if not abs(fix.north_m_s) + abs(fix.east_m_s) <= MAX_SPEED_M_S:
                return
        if self.frame is None:
            chosen = self.frame_to_lay
            if chosen is None or not _is_near(chosen.to_local(fix.position)):
                chosen = LocalFrame(fix.position)
            self.frame = chosen
        at = self.frame.to_local(fix.position)
        if _is_near(at):
            sigma_m = max(sigma_m, MIN_SIGMA_M) / math.sqrt(2.0)
            self._correct(fix.time_s, complex(*at), velocity, sigma_m)

    def _correct(self, time_s: float, at: complex, velocity: complex | None, sigma_m: float) -> None:
        """What a fix says about the boat where it was then. sigma_m is per axis."""
        position, current, watch = self.position, self.current, self._watch
        self._fix_s = time_s
        watch.update(time_s, at, velocity)
        way_m, through = self.wake.at(time_s)
        # A pose from a camera over a pool is a hundred times finer than a satellite's; so is its velocity.
        variance = min(VELOCITY_SIGMA_M_S, sigma_m) ** 2
        if self._accepted_s == -math.inf:
            self._begin(time_s, at, velocity, sigma_m, variance, way_m, through)
            return
        model = current.velocity_m_s(through)
        self._is_frozen = watch.is_frozen(abs(model), _AT_REST * self._cruise_m_s)
        if self._is_frozen:
            return
        dt = time_s - position.time_s
        carried = current.gain * (way_m - self._way_m) + current.set_m_s * dt
        self._way_m = way_m
        slip, surge = _SLIP * self.heading.yaw_rate_rad_s * abs(through), _SURGE * self.water.surge_m_s2
        pushed = slip * slip + surge * surge
        position.predict(time_s, carried, sigma_m, pushed)
        is_consistent = watch.is_consistent(sigma_m)
        if velocity is not None and position.take_velocity(
            velocity - model - position.unmodelled_m_s, variance, is_consistent
        ):
            self._learn(velocity, through, variance, pushed, dt)
        is_accepted = position.fits(at, sigma_m, self._strayed_m * self._strayed_m)
        self._rejected += min(dt, 1.0) * ((0.0 if is_accepted else 1.0) - self._rejected)
        if is_accepted:
            if self._strayed_m > 0.0:
                position.stray(self._strayed_m * self._strayed_m)
                self._strayed_m = 0.0
            position.take_position(at, sigma_m)
            self._accepted_s = time_s
            if velocity is None:
                measured = current.velocity_m_s(through) + position.unmodelled_m_s
                self._learn(measured, through, position.unmodelled_variance, pushed, dt)
        elif self._may_begin_anew(time_s, is_consistent):
            self.resets += 1
            self._begin(time_s, at, velocity, sigma_m, variance, way_m, through)

    def _may_begin_anew(self, time_s: float, is_consistent: bool) -> bool:
        """Whether fixes that do not fit are better than what the boat has left."""
        is_spent = self._is_spent(time_s - self._accepted_s, self._sigma_m)
        is_idle = time_s - max(self._idle_since_s, self._accepted_s) > _IDLE_RESET_S
        return is_spent or (is_idle and is_consistent)

    def _begin(
        self,
        time_s: float,
        at: complex,
        velocity: complex | None,
        sigma_m: float,
        variance: float,
        way_m: complex,
        through: complex,
    ) -> None:
        """Start the position at a fix."""
        position, current = self.position, self.current
        position.start(time_s, at, sigma_m, SET_SHARE * self._cruise_m_s)
        if velocity is not None:
            position.take_velocity(velocity - current.velocity_m_s(through), variance, True)
        self._way_m = way_m
        self._accepted_s = time_s
        self._strayed_m = self._rejected = 0.0

    def _learn(
        self, velocity: complex, through: complex, variance: float, pushed_m2_s3: float, dt: float
    ) -> None:
        """Set, gain and compass from a velocity over ground and the one through the water."""
        heading, current, position = self.heading, self.current, self.position
        if heading.time_s == -math.inf:
            return
        if not self._is_compass_good:
            self._draw_to_course(velocity, through, dt)
            return
        self._compare_course(velocity, through, dt)
        noise = (position.noise_m2_s3 + pushed_m2_s3) * UNMODELLED_S * UNMODELLED_S / dt
        position.unmodelled_m_s -= current.update(velocity, through, variance + noise, dt)
        self._nudge(dt)

    def _nudge(self, dt: float) -> None:
        """Way that the boat still has, or has not yet, shows in what is not modelled: take it for that."""
        yaw, position, gain = self.heading.heading_rad, self.position, self.current.gain
        bow = gain * complex(math.cos(yaw), math.sin(yaw))
        size = abs(gain)
        ahead = (position.unmodelled_m_s * bow.conjugate()).real / size
        step = min(dt / _NUDGE_S, 1.0) * ahead / size
        self.water.surge_m_s += step
        position.unmodelled_m_s -= step * bow

    def _course_turn_rad(self, velocity: complex, through: complex) -> float:
        """How far the boat's course through the water is off its bow, NaN while there is no course."""
        current, least = self.current, _UNDER_WAY * self._cruise_m_s
        course, bow = velocity - current.set_m_s, current.gain * through
        if abs(course) < least or abs(bow) < least:
            return math.nan
        return cmath.phase(course / bow)

    def _draw_to_course(self, velocity: complex, through: complex, dt: float) -> None:
        """Where the bow points, from where the boat goes."""
        turn = self._course_turn_rad(velocity, through)
        if not math.isnan(turn):
            has_gyro = self._now_s - self.heading.time_s <= MAX_PREDICTION_S and self.heading.has_gyro
            doubt = math.sqrt(self.current.set_variance()) / abs(velocity - self.current.set_m_s)
            self.heading.draw(turn, _COURSE_S if has_gyro else _COURSE_ALONE_S, dt, doubt + 0.05)

    def _compare_course(self, velocity: complex, through: complex, dt: float) -> None:
        """Whether the compass goes with the course; if not by far, it is the compass that is wrong."""
        turn = self._course_turn_rad(velocity, through)
        share = min(dt / _OFF_S, 1.0)
        self._off_rad += share * ((0.0 if math.isnan(turn) else turn) - self._off_rad)
        if abs(self._off_rad) > _OFF_RAD:
            self.current.turn(self._off_rad, 0.2)
            self._off_rad = 0.0
        self._is_turned_off = abs(self.current.turn_rad) > _GOOD_AGAIN_RAD

    def _stray(self, dt: float) -> None:
        """The position has gone without a fix for dt."""
        through = self.wake.velocity_m_s
        speed = abs(through)
        doubt = 0.01 if self._is_compass_good else self.heading.sigma_rad
        variance = self.current.variance(through) + (doubt * speed) ** 2
        self._strayed_m += dt * math.sqrt(max(variance, 0.0))

    @property
    def _is_compass_good(self) -> bool:
        heading = self.heading
        return not heading.is_off and self._now_s - heading.compass_s <= self._setting.compass_timeout_s

    @property
    def _sigma_m(self) -> float:
        return math.sqrt(self.position.variance_m2) + self._strayed_m

    def _is_spent(self, fix_age_s: float, sigma_m: float) -> bool:
        """Whether dead reckoning has gone on for too long; without a heading there is none."""
        setting, heading = self._setting, self.heading
        if fix_age_s <= setting.gnss_timeout_s:
            return False
        is_blind = self._now_s - heading.time_s > setting.compass_timeout_s or heading.sigma_rad > _LOST_RAD
        return is_blind or fix_age_s > setting.dead_reckoning_s or sigma_m > setting.lost_sigma_m

    def _faults(self, now_s: float, fix_age_s: float, sigma_m: float) -> int:
        faults, setting, heading = 0, self._setting, self.heading
        if self.frame is not None:
            if now_s - self._fix_s > setting.gnss_timeout_s:
                faults |= _LOST
            elif self._is_frozen:
                faults |= _FROZEN
            if self._rejected > _REJECTED:
                faults |= _JUMPING
            if self._is_spent(fix_age_s, sigma_m):
                faults |= _POSITION_LOST
        if heading.time_s > -math.inf:
            if heading.is_off or self._is_turned_off:
                faults |= _COMPASS_OFF
            elif now_s - heading.compass_s > setting.compass_timeout_s:
                faults |= _COMPASS_LOST
            if heading.sigma_rad > _LOST_RAD:
                faults |= _HEADING_LOST
        return faults


def _is_near(at: Point) -> bool:
    return math.hypot(at.north_m, at.east_m) <= MAX_OFFSET_M


def _take_heading(compass: HeadingFilter, reading: HeadingReading) -> None:
    rate, heading = reading.yaw_rate_rad_s, reading.heading_rad
    is_heading = abs(heading) <= MAX_HEADING_RAD
    if rate is None:
        if is_heading:
            compass.update(reading.time_s, heading, None)
    elif abs(rate) <= MAX_RATE_RAD_S and (is_heading or math.isnan(heading)):
        compass.update(reading.time_s, heading, rate)
