"""GNSS measurement update: gates fixes, corrects the position, and reports when the position is lost.

While the receiver's velocities are accepted, its positions can be missing or rejected for a minute or more.
Positions that persistently disagree are accepted in the end; the farther off they are, the longer that takes.
With neither, the model alone propagates the position and the uncertainty grows at the model's rate.
"""

import math
from typing import Final

from companion.config.estimation import Estimation
from companion.core.state import EstimateFault
from companion.estimation.current import CURRENT_SHARE
from companion.estimation.gnss_integrity import GnssIntegrityMonitor
from companion.estimation.latency import PAUSE_S, LatencyEstimator
from companion.estimation.model import Model
from companion.estimation.position import UNMODELLED_S, PositionFilter

VELOCITY_SIGMA_M_S: Final = 0.05  # Doppler velocity of a common receiver, per axis
# Share of the stated speed accuracy. Receivers state it with a wide margin: the velocities of six u-blox
# receivers at rest, which stated 0.19 to 4.5 m/s, were off by 0.03 to 0.13 of that.
SPEED_ACCURACY_SHARE: Final = 0.2
_AT_REST: Final = 0.1  # share of cruise speed
_GAP_S: Final = 0.5  # after a longer gap between fixes the position uncertainty grows:
_BY_VELOCITY: Final = 0.025  # by this share of cruise speed while velocities are accepted
_HUNG_S: Final = 0.5  # after a longer stall of the loop the motion meanwhile is unknown,
_HUNG: Final = 0.5  # within this share of cruise speed
_REJECTED: Final = 0.5  # share of fixes rejected in the last second that reports GNSS_JUMPING
_SUSPECT: Final = 0.3  # share that tightens the acceptance
# A jump no longer than this at cruise speed may be a return to the true position,
_STEP_S: Final = 1.5
_STEP_WAIT_S: Final = 10.0  # if it lasts
_IDLE_RESET_S: Final = 10.0  # without thrust, even a jump is accepted after this
_SWINGING_M_S: Final = 0.2  # velocity changes below this carry no information on latency
_LOST: Final = int(EstimateFault.GNSS_LOST)
_FROZEN: Final = int(EstimateFault.GNSS_FROZEN)
_JUMPING: Final = int(EstimateFault.GNSS_JUMPING)
_LATE: Final = int(EstimateFault.GNSS_LATE)
_POSITION_LOST: Final = int(EstimateFault.POSITION_LOST)


class GnssUpdate:
    """accepted_s: time of the latest accepted position; resets: how often the position was restarted."""

    def __init__(self, model: Model, setting: Estimation) -> None:
        self._model = model
        self._setting = setting
        self._integrity = GnssIntegrityMonitor()
        self.latency = LatencyEstimator(_SWINGING_M_S)
        self.fix_s = -math.inf  # of the latest fix, accepted or not
        self._velocity_s = self._outlier_since_s = -math.inf
        self._displacement_m = 0j  # through the water, at the time of the latest fix
        self._drift_m = self._rejected_share = self._stall_drift_m = 0.0
        self._stalled_s = math.inf  # start of a loop stall, with the position uncertainty that it caused
        self._passed_s = 0.0
        self._is_frozen = False
        self._reset_counter = 0
        self.accepted_s = -math.inf
        self.resets = 0
        self.position = PositionFilter(model.cruise_m_s, setting.wander_s, setting.wander_share)

    @property
    def sigma_m(self) -> float:
        """Standard deviation of the position, per axis."""
        return math.sqrt(self.position.variance_m2) + self._drift_m + self._stall_drift_m

    def here(self, now_s: float) -> tuple[complex, complex]:
        """Position in m and velocity over ground in m/s, north + i east."""
        position, current, history = self.position, self._model.current, self._model.history
        ahead_s = now_s - position.time_s
        fading = math.exp(-ahead_s / UNMODELLED_S)
        unmodelled = position.unmodelled_m_s
        through = history.velocity_m_s
        way_m = history.displacement_m + through * (now_s - history.time_s) - self._displacement_m
        carried = current.gain * way_m + current.current_m_s * ahead_s
        return (
            position.position_m + carried + unmodelled * (UNMODELLED_S * (1.0 - fading)),
            current.gain * through + current.current_m_s + unmodelled * fading,
        )

    def advance(self, now_s: float) -> None:
        """Grow the uncertainty while no position is accepted. Call several times a second."""
        dt = now_s - self._passed_s
        self._passed_s = now_s
        if self.latency.is_due(now_s):
            self.latency.add_expected(now_s, self._model.current.gain * self._model.history.velocity_m_s)
        if dt > _HUNG_S:
            self._stalled_s, self._stall_drift_m = (
                now_s - dt,
                self._stall_drift_m + _HUNG * self._model.cruise_m_s * dt,
            )
        if now_s - self.accepted_s > _GAP_S:
            model = self._model
            by_velocity = now_s - self._velocity_s <= _GAP_S
            doubt_m_s = _BY_VELOCITY * model.cruise_m_s if by_velocity else model.doubt_m_s()
            self._drift_m += dt * doubt_m_s

    def update(
        self,
        time_s: float,
        at: complex,
        velocity: complex | None,
        sigma_m: float,
        reset_counter: int,
        speed_accuracy_m_s: float | None = None,
    ) -> None:
        """Process a fix, at the time of its measurement.

        at: m, velocity: m/s, None if not reported. sigma_m: per axis. A changed reset_counter means that the
        source has restarted; its position is then accepted unconditionally. speed_accuracy_m_s: as stated.
        """
        position, model, watch = self.position, self._model, self._integrity
        pause_s, self.fix_s = time_s - self.fix_s, time_s
        watch.update(time_s, at, velocity, sigma_m)
        if PAUSE_S < pause_s < math.inf:
            self.latency.note_gap(time_s, pause_s)
        is_otherwise_late = velocity is not None and self.latency.compare(time_s, velocity)
        stamp_s, time_s = time_s, time_s - self.latency.lag_s
        way_m, through = model.history.at(time_s)
        if speed_accuracy_m_s is None:
            # A camera pose is a hundred times more accurate than GNSS; so is its velocity.
            variance = min(VELOCITY_SIGMA_M_S, sigma_m) ** 2
        else:
            variance = max(VELOCITY_SIGMA_M_S, SPEED_ACCURACY_SHARE * speed_accuracy_m_s) ** 2
        is_new = reset_counter != self._reset_counter or is_otherwise_late
        if self.accepted_s == -math.inf or is_new:
            self.resets += self.accepted_s > -math.inf
            self._reset_counter = reset_counter
            self._start(time_s, at, velocity, sigma_m, variance, way_m, through)
            self.accepted_s = self._velocity_s = stamp_s
            return
        if time_s > self._stalled_s:  # an older fix has no information on the drift since
            self._drift_m += self._stall_drift_m
            self._stall_drift_m, self._stalled_s = 0.0, math.inf
        modelled = model.current.velocity_m_s(through)
        self._is_frozen = watch.is_frozen(abs(modelled), _AT_REST * model.cruise_m_s)
        if self._is_frozen:
            watch.reset_creep()
            return
        dt = time_s - position.time_s
        carried = model.current.gain * (way_m - self._displacement_m) + model.current.current_m_s * dt
        self._displacement_m = way_m
        pushed = model.process_noise_m2_s3(through)
        position.predict(time_s, carried, sigma_m, pushed)
        noise = position.noise_m2_s3 + pushed
        is_consistent = watch.is_consistent()
        # Positions that do not fit because they are late have late velocities, too.
        is_doubtful = self.latency.is_uncertain(stamp_s) and not position.fits(
            at, sigma_m, self._drift_m * self._drift_m
        )
        if (
            velocity is not None
            and not is_doubtful
            and position.update_velocity(
                velocity - modelled - position.unmodelled_m_s, variance, is_consistent
            )
        ):
            self._velocity_s = stamp_s
            position.unmodelled_m_s -= model.learn(velocity, through, variance, noise, dt)
            position.unmodelled_m_s -= model.absorb_unmodelled(position.unmodelled_m_s, dt)
        if self._accepts(time_s, at, sigma_m, is_consistent, dt):
            position.inflate(self._drift_m * self._drift_m)
            self._drift_m = 0.0
            position.update_position(at, sigma_m)
            self.accepted_s = stamp_s
            if velocity is None:
                measured = model.current.velocity_m_s(through) + position.unmodelled_m_s
                position.unmodelled_m_s -= model.learn(
                    measured, through, position.unmodelled_variance, noise, dt
                )
        elif self._may_restart(time_s, is_consistent):
            self.resets += 1
            self._start(time_s, at, velocity, sigma_m, variance, way_m, through)

    def _accepts(self, time_s: float, at: complex, sigma_m: float, is_consistent: bool, dt: float) -> bool:
        """Whether a position is accepted."""
        position, watch = self.position, self._integrity
        fits = position.fits(at, sigma_m, self._drift_m * self._drift_m)
        if not is_consistent:
            watch.reset_creep()
        crept_m = watch.creep_m()
        is_good = fits and crept_m == 0.0 and (is_consistent or self._rejected_share < _SUSPECT)
        self._rejected_share += min(dt, 1.0) * ((0.0 if is_good else 1.0) - self._rejected_share)
        if is_good:
            self._outlier_since_s = math.inf
            return True
        if not is_consistent or self._outlier_since_s == math.inf:
            self._outlier_since_s = time_s
        step_m = abs(at - position.position_m)
        if crept_m > 0.0:
            if fits:  # the estimate may already have followed it
                self._drift_m = max(self._drift_m, crept_m)
        elif step_m < _STEP_S * self._model.cruise_m_s and time_s - self._outlier_since_s > _STEP_WAIT_S:
            self._drift_m = max(self._drift_m, step_m)
        return False

    def _may_restart(self, time_s: float, is_consistent: bool) -> bool:
        """Whether fixes that do not fit are better than the present estimate."""
        is_idle = time_s - max(self._model.idle_since_s, self.accepted_s) > _IDLE_RESET_S
        return self.has_expired(time_s) or (is_idle and is_consistent)

    def _start(
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
        position, model = self.position, self._model
        position.start(time_s, at, sigma_m, CURRENT_SHARE * model.cruise_m_s)
        if velocity is not None:
            position.update_velocity(velocity - model.current.velocity_m_s(through), variance, True)
            self._velocity_s = time_s
        self._integrity.reset_creep()
        self._displacement_m = way_m
        self.accepted_s = self._passed_s = time_s
        self._outlier_since_s = math.inf
        self._drift_m = self._rejected_share = self._stall_drift_m = 0.0
        self._stalled_s = math.inf

    def has_expired(self, now_s: float) -> bool:
        """Whether dead reckoning has lasted too long; without a heading there is none."""
        setting = self._setting
        age_s = now_s - max(self.accepted_s, self._velocity_s)
        if age_s <= setting.gnss_timeout_s:
            return False
        is_over = age_s > setting.dead_reckoning_s or self.sigma_m > setting.lost_sigma_m
        return is_over or self._model.is_blind()

    def faults(self, now_s: float) -> int:
        """Bits of EstimateFault."""
        faults = _LATE if self.latency.lag_s > 0.0 else 0
        if now_s - self.fix_s > self._setting.gnss_timeout_s:
            faults = _LOST
        elif self._is_frozen:
            faults = _FROZEN
        if self._rejected_share > _REJECTED:
            faults |= _JUMPING
        if now_s - self.accepted_s > self._setting.gnss_timeout_s and self.has_expired(now_s):
            faults |= _POSITION_LOST
        return faults
