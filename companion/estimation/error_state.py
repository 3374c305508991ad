"""Error-state Kalman filter of the boat's motion.

The nominal state follows gyro, motor commands and the hull's model (`hull_model.py`) tick by tick. The
covariance of its error, 13 states (`covariance.py`), is propagated only when a measurement is due; the
measurement's correction is added to the nominal state (J. Solà, *Quaternion kinematics for the error-state
Kalman filter*, 2017, sections 5 and 6, here in the plane). North and east p, heading ψ, surge u and sway v
through the water, current c, rate bias b, compass offset δ, thrust gain g, coloured receiver error w and
receiver delay τ:

    ṗ = R(ψ) (u, v) + c       ψ̇ = gyro − b                        u̇: hull model, v̇ = model − v_e/T_e
    compass = ψ + δ           position = p(t − τ) + w             Doppler velocity = ṗ(t − τ)

w is a first-order Gauss-Markov process (Y. Bar-Shalom, X. R. Li, T. Kirubarajan, *Estimation with
Applications to Tracking and Navigation*, 2001, section 8.3). A fix that arrives late is compared with the
nominal state of its time, and its Jacobian is carried back over the delay (the same book, section 3.2 of
the delayed measurements of Y. Bar-Shalom, *Update with out-of-sequence measurements in tracking*, IEEE
Trans. AES 38(3), 2002, without the process noise in between). The noise of the receiver's velocity is
scaled to the size of the innovations, and the noise of the process to their correlation: an innovation
sequence must be white (R. K. Mehra, *On the identification of variances and adaptive Kalman filtering*,
IEEE Trans. Automatic Control 15(2), 1970).

Without a gyro ψ̇ is that of the yaw model, and b is its error.
"""

import math
from collections.abc import Callable, Sequence
from typing import Any, Final

from companion.config.boat_config import Speed
from companion.config.drive import DIFFERENTIAL, DriveSetting
from companion.config.estimation import Estimation
from companion.core.units import wrap_pi
from companion.estimation.covariance import (
    COMPASS_OFFSET,
    CURRENT_EAST,
    CURRENT_NORTH,
    EAST,
    GNSS_DELAY,
    GNSS_EAST,
    GNSS_NORTH,
    HEADING,
    NORTH,
    RATE_BIAS,
    SURGE,
    SWAY,
    THRUST_GAIN,
)  # fmt: skip
from companion.estimation.innovation import NO_INNOVATION, Innovation
from companion.estimation.nominal_state import STALL_S, UNMODELLED_S, NominalState
from companion.planning.kernels import load

_new_covariance: Callable[[Sequence[float]], Any] = load("_covariance", "covariance", __package__).Covariance

# Limits and initial value of the unmodelled speed, shares of cruise speed: flat water to breaking waves
_LEAST, _FIRST, _MOST = 0.01, 0.05, 0.5
_SLIP: Final = 0.2  # model error in a turn, of surge × yaw rate,
_SURGE: Final = 0.3  # and of the acceleration
_CURRENT: Final = 0.5  # initial standard deviation of the current, of cruise speed
_CURRENT_WALK: Final = 0.004  # of cruise speed, per √s: tides and gusts
_SPEED_STEP: Final = 0.1  # of cruise speed: a smaller change is noise
IDLE_S: Final = 2.0  # without thrust
_IDLE: Final = 0.15  # of cruise speed: at rest, the observed current may be the effect of a mooring
_GAIN: Final = 0.2  # initial standard deviation of the thrust gain
_GAIN_WALK: Final = 0.002  # per √s: battery voltage falls
_GAIN_SPREAD: Final = 0.1  # of the thrust gain, between two speeds one cruise speed apart
GYRO_BIAS_RAD_S: Final = 0.03  # rad/s, initial: a BNO055's data sheet allows 3°/s, typical 1
_BIAS_WALK: Final = 2e-4  # rad/s per √s
_BLIND_RATE: Final = 0.25  # rad/s, deviation of the yaw model's rate without a gyro, and its time constant
_LATE_RATE: Final = 0.005  # the same with a gyro that is late
_BLIND_S: Final = 1.5
_GYRO_WALK: Final = 1e-3  # rad per √s: white noise of 0.3°/s at 50 Hz
_SCALE: Final = 0.02  # gyro scale error, and deviation of the compass between two headings one rad apart
_COMPASS_RAD: Final = 0.02  # white noise of one reading (BNO055: 2.5° in all, most of it deviation)
_COMPASS_FLOOR: Final = 0.02  # of the mean of many
_TURN_STEP_RAD: Final = 0.2  # a smaller turn is yawing about a course
_TILT: Final = 0.05  # s²/m rad: tilt error of the compass for a centripetal acceleration u r
_OFFSET_WALK: Final = 0.0005  # rad per √s
_DELAY_S: Final = 0.03  # initial standard deviation of the receiver's delay beyond the configured one
_MAST_M2: Final = 0.03**2  # an antenna half a metre up, rolling by 3°
_STALLED: Final = 0.5  # of cruise speed: how far the boat has gone while the loop stalled, per second
_CREEPING: Final = 0.15  # share of cruise speed
_WIDEST: Final = 1.0  # rad: beyond, a heading is unknown and its linearisation has no meaning
_TURN_RAD: Final = 0.2  # standard deviation of a compass offset that the course shows
_RESTORED: Final = 0.03  # of cruise speed: change of the current since the restored estimate was valid
_COVARIANCE_S: Final = 0.45  # longest step of the covariance
_MEHRA: Final = 0.05  # weight of one fix in both noise adaptations
_CLIP: Final = 4.0  # largest NIS in them: an outlier is no noise
_LEAST_NOISE: Final = 0.02
_MOST_NOISE: Final = 10.0  # of the stated variance of the velocity
VELOCITY_M_S: Final = 0.05  # Doppler noise of a common receiver, per axis


class ErrorStateFilter(NominalState):
    """The nominal state with the covariance of its error, and the latest innovations."""

    def __init__(self, speed: Speed, setting: Estimation, drive: DriveSetting = DIFFERENTIAL) -> None:
        super().__init__(speed, setting, drive)
        cruise, self._covariance_s = speed.cruise_m_s, 0.0
        self._wander_s, self._wander_share, self._wander_variance = (
            setting.wander_s,
            setting.wander_share,
            0.0,
        )
        self._gyro_bias_variance = GYRO_BIAS_RAD_S * GYRO_BIAS_RAD_S
        self._doubt_variance = setting.compass_doubt_rad**2
        current = _CURRENT * cruise
        self.covariance: Any = _new_covariance(
            (0.0, 0.0, _WIDEST, 0.0, 0.0, current, current, _BLIND_RATE, setting.compass_doubt_rad, _GAIN,
             0.0, 0.0, _DELAY_S)
        )  # fmt: skip
        self._is_pending = False
        self._stalled_s, self._stalled_m2 = -math.inf, 0.0  # end of a stall, and its share of the variance
        self._changed_m_s = 0.0  # surge at its last considerable change
        self.velocity_noise = 1.0  # of the stated variance
        scale = 2.0 * cruise * cruise / UNMODELLED_S
        self._least_q, self._q, self._most_q = scale * _LEAST**2, scale * _FIRST**2, scale * _MOST**2
        self._velocity_nu = (0.0, 0.0)
        self.compass = self.position_north = self.position_east = NO_INNOVATION
        self.velocity_north = self.velocity_east = NO_INNOVATION

    @property
    def _blind_rate(self) -> float:
        return _LATE_RATE if self.is_late else _BLIND_RATE

    def use_gyro(self, *, has_gyro: bool) -> None:
        self._propagate_covariance()
        if has_gyro:
            variance = self._gyro_bias_variance
        else:
            variance, self._gyro_bias_variance = self._blind_rate**2, self.covariance.variance(RATE_BIAS)
        self.covariance.reset(RATE_BIAS, variance)
        super().use_gyro(has_gyro=has_gyro)

    def _propagate_covariance(self) -> None:
        """Advance the covariance to the latest tick."""
        dt = self.turned_s - self._covariance_s
        if not dt > 0.0:
            return
        self._covariance_s = self.turned_s
        covariance, heading, surge = self.covariance, self.heading_rad, self.surge_model
        if dt > STALL_S:
            self._stalled_s = self.turned_s
            self._stalled_m2 += (_STALLED * self.cruise_m_s * dt) ** 2
            covariance.add(NORTH, self._stalled_m2)
            covariance.add(EAST, self._stalled_m2)
            dt = STALL_S
        cos, sin, through = math.cos(heading), math.sin(heading), self.through_water(heading)
        covariance.carry(NORTH, -through.imag * dt, cos * dt, -sin * dt, CURRENT_NORTH, dt)
        covariance.carry(EAST, through.real * dt, sin * dt, cos * dt, CURRENT_EAST, dt)
        covariance.combine(HEADING, 1.0, RATE_BIAS, -dt)
        fade = math.exp(surge.slope * dt)
        covariance.combine(SURGE, fade, THRUST_GAIN, surge.per_gain * (1.0 - fade) / -surge.slope)
        covariance.scale(SWAY, math.exp(-dt / UNMODELLED_S))
        keep = math.exp(-dt / self._wander_s)
        covariance.scale(GNSS_NORTH, keep)
        covariance.scale(GNSS_EAST, keep)
        self.gnss_north_m *= keep
        self.gnss_east_m *= keep
        fresh = self._wander_variance * (1.0 - keep * keep)
        covariance.add(GNSS_NORTH, fresh)
        covariance.add(GNSS_EAST, fresh)
        self._add_noise(dt)

    def _add_noise(self, dt: float) -> None:
        """Add the process noise of dt. Small changes of heading and speed are noise of the estimate."""
        cruise, surge, covariance = self.cruise_m_s, self.surge_model, self.covariance
        turned, sped = abs(self._turned_rad), abs(self.surge_m_s - self._changed_m_s) / cruise
        if turned < _TURN_STEP_RAD:
            turned = 0.0
        else:
            self._turned_rad = 0.0
        if sped < _SPEED_STEP:
            sped = 0.0
        else:
            self._changed_m_s = self.surge_m_s
        slip, accel = _SLIP * self.yaw_rate_rad_s * abs(self.surge_m_s), _SURGE * surge.accel_m_s2
        covariance.add(SURGE, (self._q + accel * accel) * dt)
        covariance.add(SWAY, (self._q + slip * slip) * dt)
        walk = (_CURRENT_WALK * cruise) ** 2 * dt
        for state in (CURRENT_NORTH, CURRENT_EAST):
            covariance.add(state, walk)
            if abs(self.surge_m_s) < 0.1 * cruise and self.turned_s - self.idle_since_s > IDLE_S:
                covariance.raise_to(state, (_IDLE * cruise) ** 2)
        deviation = _SCALE**2 * turned
        covariance.add(HEADING, _GYRO_WALK**2 * dt + deviation)
        covariance.add(COMPASS_OFFSET, _OFFSET_WALK**2 * dt + deviation)
        if self.has_gyro:
            covariance.add(RATE_BIAS, _BIAS_WALK**2 * dt)
        else:
            keep = math.exp(-dt / _BLIND_S)
            if self.turned_s - self.compass.time_s > _BLIND_S:  # with a compass the error is measured
                covariance.scale(RATE_BIAS, keep)
            covariance.add(RATE_BIAS, self._blind_rate**2 * (1.0 - keep * keep))
        if covariance.variance(HEADING) > _WIDEST**2:
            covariance.reset(HEADING, _WIDEST**2)
        covariance.add(THRUST_GAIN, _GAIN_WALK**2 * dt + _GAIN_SPREAD**2 * sped)

    def commit(self) -> None:
        """Apply all accepted measurements to state and covariance."""
        if self._is_pending:
            self._is_pending = False
            self._correct(self.covariance.commit())
            if self._stalled_m2 > 0.0:  # nothing measured before its end tells how far the boat went
                self.covariance.raise_to(NORTH, self._stalled_m2)
                self.covariance.raise_to(EAST, self._stalled_m2)

    def start_heading(self, compass_rad: float) -> None:
        """Take the heading from the compass."""
        self._propagate_covariance()
        self._turn_by(wrap_pi(compass_rad - self.offset_rad - self.heading_rad))
        self.has_heading = True
        covariance = self.covariance
        covariance.reset(HEADING, _COMPASS_RAD * _COMPASS_RAD)
        covariance.combine(HEADING, 1.0, COMPASS_OFFSET, -1.0)

    def compass_variance(self, count: int) -> float:
        """Variance of the mean of this many compass readings."""
        tilt = _TILT * self.surge_m_s * self.yaw_rate_rad_s
        return _COMPASS_RAD * _COMPASS_RAD / count + _COMPASS_FLOOR * _COMPASS_FLOOR + tilt * tilt

    def update_compass(self, residual_rad: float, count: int, gate: float) -> bool:
        """Update with the mean of this many compass readings less their predictions."""
        self._propagate_covariance()
        self.commit()
        _, variance = self.covariance.tell_heading(residual_rad, self.compass_variance(count))
        is_accepted = residual_rad * residual_rad <= gate * variance
        self.compass = self.compass.next(self.turned_s, residual_rad, variance)
        self.compass.is_accepted = bool(is_accepted)
        if is_accepted:
            self.covariance.accept(1)
            self._is_pending = True
            self.commit()
        return bool(is_accepted)

    def keep_covariance(self) -> None:
        """Bring the covariance up to date if no measurement has for a while."""
        if self.turned_s - self._covariance_s > _COVARIANCE_S:
            self._propagate_covariance()

    def learn_yaw(self, dt_s: float, is_in_time: bool) -> None:
        """Update the yaw model from the present rate."""
        if is_in_time and self.has_heading:
            self.yaw_model.learn(self.yaw_rate_rad_s, dt_s)

    def rotate(self, turn_rad: float) -> None:
        """Take this angle for an offset of the compass."""
        self.commit()
        self._propagate_covariance()
        self._turn_by(turn_rad)
        self.offset_rad -= turn_rad
        self.covariance.add(HEADING, _TURN_RAD * _TURN_RAD)
        self.covariance.reset(COMPASS_OFFSET, _TURN_RAD * _TURN_RAD)

    def forget_offset(self) -> None:
        """Take the compass offset for zero, with its initial uncertainty."""
        self.commit()
        self._propagate_covariance()
        self.offset_rad = 0.0
        self.covariance.reset(COMPASS_OFFSET, self._doubt_variance)

    def restore(self, gap_rad: float, offset_rad: float, bias_rad_s: float, current_m_s: complex) -> None:
        """The compass was wrong: return to an earlier offset, bias and current, and turn by gap_rad."""
        self.commit()
        self._propagate_covariance()
        self._turn_by(gap_rad + self.offset_rad - offset_rad)
        self.offset_rad, self.bias_rad_s = offset_rad, bias_rad_s
        self.current_north_m_s, self.current_east_m_s = current_m_s.real, current_m_s.imag
        for state in (CURRENT_NORTH, CURRENT_EAST):
            self.covariance.add(state, (_RESTORED * self.cruise_m_s) ** 2)

    def start_position(self, north_m: float, east_m: float, sigma_m: float) -> None:
        """Take the position from a fix of now. sigma_m: its deviation per axis."""
        self._propagate_covariance()
        self.commit()
        covariance, wander = self.covariance, (self._wander_share * sigma_m) ** 2
        self._wander_variance = wander
        self._place(north_m - self.north_m, east_m - self.east_m)
        self.gnss_north_m = self.gnss_east_m = 0.0
        for here, wandering in ((NORTH, GNSS_NORTH), (EAST, GNSS_EAST)):
            covariance.reset(here, sigma_m * sigma_m - wander)
            covariance.reset(wandering, wander)
            covariance.combine(here, 1.0, wandering, -1.0)
        least = (_CURRENT * self.cruise_m_s) ** 2
        covariance.raise_to(SURGE, (_FIRST * self.cruise_m_s) ** 2)
        covariance.raise_to(SWAY, (_FIRST * self.cruise_m_s) ** 2)
        covariance.raise_to(CURRENT_NORTH, least)
        covariance.raise_to(CURRENT_EAST, least)

    def predict_velocity(self, time_s: float, velocity_m_s: complex, variance: float) -> "PairUpdate":
        """Compare a velocity over ground of this time with its prediction. variance: stated, per axis."""
        self._propagate_covariance()
        _, _, heading, velocity = self.at(time_s - self.delay_s)
        cos, sin, through, tell = (
            math.cos(heading),
            math.sin(heading),
            self._telling(velocity),
            self.covariance,
        )
        innovation, white = velocity_m_s - velocity, variance * self.velocity_noise
        first = tell.tell_velocity(0, -through.imag, cos, -sin, CURRENT_NORTH, innovation.real, white)
        second = tell.tell_velocity(1, through.real, sin, cos, CURRENT_EAST, innovation.imag, white)
        self.velocity_north = self.velocity_north.next(self.turned_s, *first)
        self.velocity_east = self.velocity_east.next(self.turned_s, *second)
        return PairUpdate(self.velocity_north, self.velocity_east, innovation, white)

    def predict_position(self, time_s: float, at: complex, sigma_m: float) -> "PairUpdate":
        """Compare a position of this time, north + i east, with its prediction. sigma_m: per axis."""
        self._propagate_covariance()
        self._wander_variance = (self._wander_share * sigma_m) ** 2
        covariance, time_s = self.covariance, time_s - self.delay_s
        if time_s > self._stalled_s:
            self._stalled_m2 = 0.0
        north_m, east_m, heading, velocity = self.at(time_s)
        cos, sin, through = math.cos(heading), math.sin(heading), self._telling(velocity)
        back_s = min(time_s - self.turned_s, 0.0)
        rolling = _MAST_M2 + covariance.variance(GNSS_DELAY) * covariance.variance(SURGE)
        white = (sigma_m * sigma_m - self._wander_variance) + rolling
        innovation = at - complex(north_m + self.gnss_north_m, east_m + self.gnss_east_m)
        first = covariance.tell_position(
            0, back_s, velocity.real, -through.imag, cos, -sin, CURRENT_NORTH, innovation.real, white
        )
        second = covariance.tell_position(
            1, back_s, velocity.imag, through.real, sin, cos, CURRENT_EAST, innovation.imag, white
        )
        self.position_north = self.position_north.next(self.turned_s, *first)
        self.position_east = self.position_east.next(self.turned_s, *second)
        return PairUpdate(self.position_north, self.position_east, innovation, white)

    def _telling(self, velocity: complex) -> complex:
        """Velocity through the water, as far as it tells of the heading: near rest its direction is noise."""
        through = velocity - self.current_m_s
        return through if abs(through) > _CREEPING * self.cruise_m_s else 0j

    def apply(self, pair: "PairUpdate") -> None:
        """Accept a measurement, the one predicted last: it is applied by `commit`."""
        self.covariance.accept(2)
        self._is_pending = True
        pair.north.is_accepted = pair.east.is_accepted = True

    def adapt(self, pair: "PairUpdate") -> None:
        """Adapt both noises to an accepted velocity's innovations."""
        north, east = pair.north, pair.east
        before_north, before_east = self._velocity_nu
        now_north, now_east = north.value / math.sqrt(north.variance), east.value / math.sqrt(east.variance)
        self._velocity_nu = now_north, now_east
        # Two innovations differ by their white noise alone; what they have in common is the model's error
        size = min(0.25 * ((now_north - before_north) ** 2 + (now_east - before_east) ** 2), _CLIP)
        alike = 0.5 * (now_north * before_north + now_east * before_east)
        own = (
            0.5 * pair.white * (1.0 / north.variance + 1.0 / east.variance)
        )  # share of the innovation's variance
        noise = self.velocity_noise * (1.0 + _MEHRA * own * (size - 1.0))
        self.velocity_noise = min(max(noise, _LEAST_NOISE), _MOST_NOISE)
        wanted = self._q * (1.0 + _MEHRA * min(max(alike, -1.0), 1.0))
        self._q = min(max(wanted, self._least_q), self._most_q)


class PairUpdate:
    """North and east of one measurement, and its joint NIS, of two degrees of freedom."""

    def __init__(self, north: Innovation, east: Innovation, innovation: complex, white: float) -> None:
        """north: its innovation; east: the same given north. innovation: without that. white: own noise."""
        self.north, self.east, self.innovation, self.white = north, east, innovation, white
        self.nis = north.nis + east.nis

    def nis_with(self, more: float) -> float:
        """The joint NIS with this much more variance per axis."""
        north, east = self.north, self.east
        return north.value**2 / (north.variance + more) + east.value**2 / (east.variance + more)
