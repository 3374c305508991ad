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
nominal state of its time. The noises of compass and Doppler are scaled to the size of their innovations:
their normalised squares must be 1 on average (R. K. Mehra, *On the identification of variances and adaptive
Kalman filtering*, IEEE Trans. Automatic Control 15(2), 1970).

Without a gyro ψ̇ is that of the yaw model, and b is its error.
"""

import math
from typing import Final

from companion.config.actuators import DIFFERENTIAL, DriveSetting, Handling
from companion.config.tuning import Estimation, Speed
from companion.core.evidence import MOST_SQUARE
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
    Covariance,
)  # fmt: skip
from companion.estimation.fix_error import FixError
from companion.estimation.hull_model import GAIN, GAIN_WALK
from companion.estimation.innovation import NO_INNOVATION, square
from companion.estimation.nominal_state import STALL_S, UNMODELLED_S, NominalState

# Deviations. Process noises were chosen by `benchmarks.estimation`: NEES and NIS near 1
_UNMODELLED: Final = 0.02  # of the speed, in cruise speeds,
_ACCELERATION: Final = 0.3  # and of the model's accelerations
_CURRENT: Final = 0.5  # of the initial current, in cruise speeds; also what a stall of the loop adds a second
_CURRENT_WALK: Final = 0.004  # in cruise speeds per √s: tides, and leeway in gusts
_BIAS_RAD_S: Final = 0.03  # of a gyro's initial bias: a BNO055's data sheet allows 3°/s, typical 1
_BIAS_WALK: Final = 2e-4  # rad/s per √s
_BLIND_RAD_S: Final = 0.25  # of the yaw model's rate without a gyro,
_BLIND_SHARE: Final = 0.5  # and of it, as a share: 30 % off in thrust and in inertia turn at 0.54 to 1.86
_LATE_RAD_S: Final = 0.005  # the same with a gyro that is late
_COMPASS_RAD: Final = 0.02  # of one reading, initially (BNO055: 2.5° in all, most of it deviation)
_DEVIATION: Final = 0.015  # of gyro scale and compass deviation, between two headings one rad apart
_DELAY_S: Final = 0.03  # of the receiver's delay beyond the configured one
_UNKNOWN_RAD: Final = 1.0  # a larger deviation of the heading has no meaning
_ADAPTS: Final = 0.05  # weight of one innovation in the noise: a memory of four seconds at 5 Hz
_TELLS: Final = 3.0  # deviations of a velocity, through the water, from which its course tells the heading
_CLIP: Final = 4.0  # largest normalised square in it: an outlier is no noise


class ErrorStateFilter(NominalState):
    """The nominal state with the covariance of its error, and the latest innovations.

    compass_noise: learned factor of the stated variance. is_pending: measurements wait for `commit`.
    """

    def __init__(
        self, speed: Speed, setting: Estimation, drive: DriveSetting = DIFFERENTIAL,
        handling: Handling | None = None,
    ) -> None:  # fmt: skip
        super().__init__(speed, setting, drive, handling or Handling())
        self._setting, self._covariance_s = setting, 0.0
        self._wander_variance, self._wander_s = 0.0, 1.0
        self._gyro_bias_variance = _BIAS_RAD_S * _BIAS_RAD_S
        current = _CURRENT * speed.cruise_m_s
        self.covariance = Covariance(
            (0.0, 0.0, _UNKNOWN_RAD, _UNMODELLED * speed.cruise_m_s, 0.0, current, current, _BLIND_RAD_S,
             setting.compass_doubt_rad, GAIN, 0.0, 0.0, _DELAY_S)
        )  # fmt: skip
        self._stalled_s, self._stalled_m2 = -math.inf, 0.0  # end of a stall, and the variance that it adds
        self.is_pending = False
        self._q = 2.0 * (_UNMODELLED * speed.cruise_m_s) ** 2 / UNMODELLED_S
        self.compass, self.compass_noise = NO_INNOVATION, 1.0
        self.position, self.velocity = InnovationPair(), InnovationPair()

    def use_gyro(self, *, has_gyro: bool) -> None:
        self.commit()
        self._propagate()
        if has_gyro:
            variance = self._gyro_bias_variance
        else:
            variance, self._gyro_bias_variance = self._blind_variance, self.covariance.variance(RATE_BIAS)
        self.covariance.reset(RATE_BIAS, variance)
        super().use_gyro(has_gyro=has_gyro)

    @property
    def _blind_variance(self) -> float:
        if self.is_late:
            return _LATE_RAD_S * _LATE_RAD_S
        return _BLIND_RAD_S * _BLIND_RAD_S + (_BLIND_SHARE * self.yaw_rate_rad_s) ** 2

    def _propagate(self) -> None:
        """Advance the covariance to the latest tick."""
        dt = self.turned_s - self._covariance_s
        if not dt > 0.0:
            return
        self._covariance_s = self.turned_s
        covariance, surge, cruise = self.covariance, self.surge_model, self.cruise_m_s
        heading = self.heading_rad
        if dt > STALL_S:
            self._stalled_s = self.turned_s
            self._stalled_m2 += (_CURRENT * cruise * dt) ** 2
            covariance.add(NORTH, self._stalled_m2)
            covariance.add(EAST, self._stalled_m2)
            dt = STALL_S
        cos, sin, through = math.cos(heading) * dt, math.sin(heading) * dt, self.through_water(heading) * dt
        covariance.mix(
            NORTH, ((NORTH, 1.0), (HEADING, -through.imag), (SURGE, cos), (SWAY, -sin), (CURRENT_NORTH, dt))
        )
        covariance.mix(
            EAST, ((EAST, 1.0), (HEADING, through.real), (SURGE, sin), (SWAY, cos), (CURRENT_EAST, dt))
        )
        covariance.mix(HEADING, ((HEADING, 1.0), (RATE_BIAS, -dt)))
        fade = math.exp(surge.slope * dt)
        covariance.mix(SURGE, ((SURGE, fade), (THRUST_GAIN, surge.per_gain * (1.0 - fade) / -surge.slope)))
        covariance.mix(SWAY, ((SWAY, 1.0 - dt / UNMODELLED_S),))
        keep = math.exp(-dt / self._wander_s)
        self.gnss_north_m *= keep
        self.gnss_east_m *= keep
        walk, fresh = (_CURRENT_WALK * cruise) ** 2 * dt, self._wander_variance * (1.0 - keep * keep)
        for wandering, current in ((GNSS_NORTH, CURRENT_NORTH), (GNSS_EAST, CURRENT_EAST)):
            covariance.mix(wandering, ((wandering, keep),))
            covariance.add(wandering, fresh)
            covariance.add(current, walk)
        covariance.add(SURGE, (self._q + (_ACCELERATION * surge.accel_m_s2) ** 2) * dt)
        covariance.add(SWAY, (self._q + (_ACCELERATION * surge.slip_m_s2) ** 2) * dt)
        deviation = _DEVIATION**2 * abs(self.yaw_rate_rad_s) * dt
        covariance.add(HEADING, deviation)
        covariance.add(COMPASS_OFFSET, deviation)
        covariance.add(THRUST_GAIN, GAIN_WALK**2 * dt)
        if self.has_gyro:
            covariance.add(RATE_BIAS, _BIAS_WALK**2 * dt)
        else:
            keep = math.exp(-dt / UNMODELLED_S)
            covariance.mix(RATE_BIAS, ((RATE_BIAS, keep),))
            covariance.add(RATE_BIAS, self._blind_variance * (1.0 - keep * keep))
        if covariance.variance(HEADING) > _UNKNOWN_RAD**2:
            covariance.reset(HEADING, _UNKNOWN_RAD**2)

    def commit(self) -> None:
        """Apply all pending measurements to state and covariance."""
        if not self.is_pending:
            return
        self.is_pending = False
        self._correct(self.covariance.commit())
        if self._stalled_m2 > 0.0:  # nothing measured before its end tells how far the boat went
            self.raise_position(self._stalled_m2)

    def end_stall(self, time_s: float) -> None:
        """A position of this time tells where the boat is after a stall, if that has ended before."""
        if time_s > self._stalled_s:
            self._stalled_m2 = 0.0

    def raise_position(self, variance_m2: float) -> None:
        """Raise the variance of the position to at least this."""
        self.covariance.raise_to(NORTH, variance_m2)
        self.covariance.raise_to(EAST, variance_m2)

    def start_heading(self, compass_rad: float) -> None:
        """Take the heading from the compass."""
        self.commit()
        self._propagate()
        self._turn_by(wrap_pi(compass_rad - self.offset_rad - self.heading_rad))
        self.has_heading = True
        self.covariance.reset(HEADING, _COMPASS_RAD * _COMPASS_RAD)
        self.covariance.mix(HEADING, ((HEADING, 1.0), (COMPASS_OFFSET, -1.0)))

    def update_compass(self, residual_rad: float, count: int) -> None:
        """Measure the mean of this many compass readings less their predictions; pending until `commit`."""
        self._propagate()
        self.is_pending = True
        white = self.compass_variance(count)
        self.compass = heard = self.compass.next(
            self.turned_s,
            *self.covariance.measure(((HEADING, 1.0), (COMPASS_OFFSET, 1.0)), residual_rad, white),
        )
        heard.is_accepted = True
        self.compass_noise = _adapted(self.compass_noise, heard.nis, share=white / heard.variance)

    def compass_variance(self, count: int) -> float:
        """Variance of the mean of this many compass readings."""
        return self.compass_noise * _COMPASS_RAD * _COMPASS_RAD / count

    def keep_covariance(self) -> None:
        """Bring the covariance up to date if no measurement has for a while."""
        if self.turned_s - self._covariance_s > 0.5 * STALL_S:
            self._propagate()

    def forget_bias(self) -> None:
        """Doubt the gyro's bias."""
        self.covariance.raise_to(RATE_BIAS, _BIAS_RAD_S**2)

    def forget_offset(self) -> None:
        """Take the compass offset for zero, with its initial uncertainty."""
        self.commit()
        self._propagate()
        self.offset_rad = 0.0
        self.covariance.reset(COMPASS_OFFSET, self._setting.compass_doubt_rad**2)

    def restore(self, gap_rad: float, offset_rad: float, bias_rad_s: float, current_m_s: complex) -> None:
        """The compass was wrong: return to an earlier offset, bias and current, and turn by gap_rad."""
        self.commit()
        self._turn_by(gap_rad + self.offset_rad - offset_rad)
        self.offset_rad, self.bias_rad_s = offset_rad, bias_rad_s
        self.current_north_m_s, self.current_east_m_s = current_m_s.real, current_m_s.imag

    def start_position(self, north_m: float, east_m: float, error: FixError) -> None:
        """Take the position from a fix of now."""
        self.commit()
        self._propagate()
        covariance, wander = self.covariance, error.wander_m2
        self._wander_variance, self._wander_s = wander, error.wander_s
        self._place(north_m - self.north_m, east_m - self.east_m)
        self.gnss_north_m = self.gnss_east_m = 0.0
        least = (_CURRENT * self.cruise_m_s) ** 2
        for here, wandering, current in (
            (NORTH, GNSS_NORTH, CURRENT_NORTH), (EAST, GNSS_EAST, CURRENT_EAST)
        ):  # fmt: skip
            covariance.reset(here, error.white_m2)
            covariance.reset(wandering, wander)
            covariance.mix(here, ((here, 1.0), (wandering, -1.0)))
            covariance.raise_to(current, least)

    def predict_velocity(
        self, heading_rad: float, before_m_s: complex, velocity_m_s: complex, error: FixError
    ) -> "InnovationPair":
        """Measure a velocity over ground; pending until `commit`, or until it is withdrawn.

        heading_rad and before_m_s: state and velocity at its time.
        """
        self._propagate()
        self.is_pending = True
        cos, sin, measure = math.cos(heading_rad), math.sin(heading_rad), self.covariance.measure
        through = before_m_s - self.current_m_s
        off, white = velocity_m_s - before_m_s, error.velocity_m2_s2 * self.velocity.noise
        if square(through) < _TELLS * _TELLS * white:  # noise has a direction, too
            through = 0j
        coloured, white = (error.density - 1.0) * white, error.density * white
        north = ((HEADING, -through.imag), (SURGE, cos), (SWAY, -sin), (CURRENT_NORTH, 1.0))
        east = ((HEADING, through.real), (SURGE, sin), (SWAY, cos), (CURRENT_EAST, 1.0))
        return self.velocity.next(
            self.turned_s, measure(north, off.real, white), measure(east, off.imag, white), off, coloured
        )

    def predict_position(
        self, then: complex, velocity_m_s: complex, at: complex, error: FixError
    ) -> "InnovationPair":
        """The same for a position, north + i east; then: where the boat was."""
        self._propagate()
        self.is_pending = True
        self._wander_variance, self._wander_s = error.wander_m2, error.wander_s
        off, measure = at - then - complex(self.gnss_north_m, self.gnss_east_m), self.covariance.measure
        white = self.position.noise * error.white_m2
        north = ((NORTH, 1.0), (GNSS_NORTH, 1.0), (GNSS_DELAY, -velocity_m_s.real))
        east = ((EAST, 1.0), (GNSS_EAST, 1.0), (GNSS_DELAY, -velocity_m_s.imag))
        return self.position.next(
            self.turned_s, measure(north, off.real, white), measure(east, off.imag, white), off
        )

    def withdraw(self, pair: "InnovationPair") -> None:
        """Withdraw a measurement, the one predicted last."""
        self.covariance.withdraw(2)
        pair.north.is_accepted = pair.east.is_accepted = False


def _adapted(noise: float, square: float, most: float = _CLIP, share: float = 1.0) -> float:
    """The factor of a noise after an innovation; share: that of the noise in its variance."""
    return noise * (1.0 + _ADAPTS * share * (min(square, most) - 1.0))


class InnovationPair:
    """The latest measurement of a position or a velocity.

    north: its innovation; east: the same given north; value: both, without that. nis: joint, of two degrees
    of freedom. noise: learned factor of the stated variance.
    """

    def __init__(self) -> None:
        self.north = self.east = NO_INNOVATION
        self.nis, self.noise = 0.0, 1.0
        self.value = self._before = 0j

    def next(
        self, time_s: float, north: tuple[float, float], east: tuple[float, float], value: complex,
        coloured: float = 0.0,
    ) -> "InnovationPair":  # fmt: skip
        """Take the measurement that follows: innovation and variance of each component, and how much of the
        latter stands for the errors that last.
        """
        self.north = self.north.next(time_s, north[0], north[1] - coloured)
        self.east = self.east.next(time_s, east[0], east[1] - coloured)
        self.north.is_accepted = self.east.is_accepted = True
        self.nis, self.value = self.north.nis + self.east.nis, value
        return self

    def adapt(self, lasts: float = 0.0, most: float = _CLIP) -> None:
        """Adapt the noise to what changes from one measurement to the next: a lag or a drift is no noise (J.
        von Neumann's mean square successive difference, 1941).
        """
        step, self._before = self.value - self._before, self.value
        share = 1.0 / self.north.variance + 1.0 / self.east.variance
        self.noise = _adapted(self.noise, 0.125 * share * square(step) / (1.0 - lasts), most)  # 1 on average

    def adapt_rejected(self, stated_m2: float) -> None:
        """Raise it by a rejected measurement, too, while the steps are within five deviations of the stated
        error: noise that grows is followed, and lies are not.
        """
        if 0.25 * square(self.value - self._before) > MOST_SQUARE * stated_m2:
            self._before = self.value
            return
        least = self.noise
        self.adapt(most=MOST_SQUARE)
        self.noise = max(self.noise, least)
