"""GNSS measurement update: gates fixes, corrects the filter, and reports when the position is lost.

While the receiver's velocities are accepted, its positions can be missing or rejected for a minute or more.
Positions that persistently disagree are accepted in the end; the farther off they are, the longer that takes.
With neither, the model alone propagates the position and the uncertainty grows at the model's rate.
"""

import math
from typing import Final

from companion.config.tuning import Estimation
from companion.core.evidence import MOST_SQUARE
from companion.core.state import EstimateFault
from companion.estimation.covariance import EAST, NORTH, SURGE, SWAY
from companion.estimation.delay import DELAYS, PAUSE_S, STEP_S, DelayEstimator
from companion.estimation.error_state import ErrorStateFilter, InnovationPair
from companion.estimation.fix_error import FixError
from companion.estimation.heading_update import HeadingUpdate
from companion.estimation.innovation import DISAGREES_S, GATE_2
from companion.estimation.monitor import SensorMonitor

_AT_REST: Final = 0.1  # share of cruise speed
_IDLE_S: Final = 10.0  # without thrust, steady positions are accepted after this, however far
# Cruise speeds: how fast the gate opens for positions that are rejected but agree with their velocities:
# 3 m are accepted after some 10 s, as when a receiver returns to its true position, and 10 m after 40 s
_OPENS: Final = 0.018
# Of the white noise that the class of the solution has. Averaged over four seconds at 5 Hz it is known to a
# sixth; sound receivers have 0.2 to 1
_NOISY_FACTOR: Final = 2.0
_SWINGING_M_S: Final = 0.3  # error in a turn of the velocity that thrust and steering let expect


class PositionUpdate:
    """accepted_s: time of the latest accepted position; fix_s: of the latest fix."""

    def __init__(self, state: ErrorStateFilter, heading: HeadingUpdate, setting: Estimation) -> None:
        self._state, self._heading, self._setting = state, heading, setting
        self._bank = heading.bank
        self._monitor = SensorMonitor()
        self.latency = DelayEstimator(_SWINGING_M_S)
        self.fix_s = self.accepted_s = self._velocity_s = self._time_s = -math.inf
        self._rejected_s = 0.0
        self._reset_counter = 0

    @property
    def sigma_m(self) -> float:
        """Standard deviation of the position, per axis."""
        covariance = self._state.covariance
        return math.sqrt(0.5 * (covariance.variance(NORTH) + covariance.variance(EAST)))

    def add_expected(self, now_s: float) -> None:
        """Tell the delay estimator what velocity thrust and steering let expect."""
        state = self._state
        self.latency.add_expected(now_s, state.through_water(state.heading_rad))

    def update(
        self,
        stamp_s: float,
        at: complex,
        velocity: complex | None,
        error: FixError,
        reset_counter: int,
    ) -> None:
        """Process a fix, at the time of its measurement.

        at: m, velocity: m/s, None if not reported. A changed reset_counter means that the source has
        restarted; its position is then accepted unconditionally.
        """
        state, bank = self._state, self._bank
        pause_s, self.fix_s = stamp_s - self.fix_s, stamp_s
        if PAUSE_S < pause_s < math.inf:
            self.latency.note_gap(stamp_s, pause_s)
        is_otherwise_late = velocity is not None and self.latency.compare(stamp_s, velocity)
        time_s = stamp_s - self.latency.delay_s
        north_m, east_m, heading_rad, predicted = state.at(time_s - state.delay_s)
        then = complex(north_m, east_m)
        dt, self._time_s = time_s - self._time_s, time_s
        speed_m_s = max(abs(predicted), abs(velocity or 0j))
        is_good = self._monitor.update(
            (at, velocity), stamp_s, speed_m_s * dt / (_AT_REST * state.cruise_m_s)
        )
        is_first = self.accepted_s == -math.inf
        if is_first or reset_counter != self._reset_counter or is_otherwise_late or (
            is_good and (self.has_expired(time_s) or self._is_idle)
        ):  # fmt: skip
            self._reset_counter = reset_counter
            here = at + complex(state.north_m, state.east_m) - then
            state.start_position(here.real, here.imag, error)
            if velocity is not None:
                state.predict_velocity(heading_rad, predicted, velocity, error)
                self._velocity_s = stamp_s
            bank.drift.restart()
            self.accepted_s, self._rejected_s = stamp_s, 0.0
            return
        # A repeat tells nothing, and may be of a stuck receiver; a rejected one goes on disagreeing
        if self._monitor.run_s > 0.0 and not (is_good and self._rejected_s > 0.0):
            if is_good:
                self.accepted_s = stamp_s
            else:
                bank.drift.restart()
            return
        bank.weigh_position(
            stamp_s, at, velocity, predicted, error, state.position.noise, state.velocity.noise
        )
        if velocity is not None and self._has_updated_velocity(heading_rad, predicted, velocity, error):
            self._velocity_s = stamp_s
            white = 0.5 * (state.velocity.north.variance + state.velocity.east.variance)
            self._heading.check_velocity(velocity, heading_rad, predicted, white, dt)
        state.end_stall(time_s)
        position = state.predict_position(then, predicted, at, error)
        if position.nis <= GATE_2 and not bank.is_gnss_wrong:
            position.adapt()
            self.accepted_s, self._rejected_s = stamp_s, 0.0
            return
        state.withdraw(position)
        state.commit()
        if self.latency.is_watching(stamp_s) and self._fits_another_time(stamp_s, at, position, dt):
            self._reset_counter = -1  # starts at the next fix
        position.adapt_rejected(max(error.white_m2 + error.wander_m2, position.noise * error.white_m2))
        self._rejected_s += dt
        self._doubt()

    def _doubt(self) -> None:
        """Doubt the position after a fix was rejected: the longer that lasts, the more."""
        state, drift = self._state, self._bank.drift
        waited_s = min(self._rejected_s, drift.steady_s)
        if self._bank.is_gnss_wrong:  # the estimate may already have followed
            state.raise_position(drift.drift_m**2)
        elif waited_s > DISAGREES_S:
            state.raise_position((_OPENS * state.cruise_m_s * waited_s) ** 2)

    def _fits_another_time(self, stamp_s: float, at: complex, position: InnovationPair, dt: float) -> bool:
        """Whether a position that does not fit is that of another time, which changes the delay.

        Errors of positions last for about a second: one counts for as much as dt.
        """
        state, costs = self._state, []
        weight = 0.5 * dt * position.nis / abs(position.value) ** 2
        for delay in range(DELAYS):
            north_m, east_m, _, _ = state.at(stamp_s - delay * STEP_S)
            off_m = abs(at - complex(north_m + state.gnss_north_m, east_m + state.gnss_east_m))
            costs.append(min(weight * off_m * off_m, dt * MOST_SQUARE))
        return self.latency.weigh(costs, dt)

    @property
    def _is_idle(self) -> bool:
        waited_s = min(self._rejected_s, self._bank.drift.steady_s)
        return min(waited_s, self._state.turned_s - self._state.driven_s) > _IDLE_S

    def _has_updated_velocity(
        self, heading_rad: float, predicted: complex, velocity: complex, error: FixError
    ) -> bool:
        state = self._state
        pair = state.predict_velocity(heading_rad, predicted, velocity, error)
        if pair.nis > GATE_2:
            state.withdraw(pair)
            if self._bank.drift.steady_s > 0.0:  # the receiver is right, the model is not
                state.covariance.add(SURGE, abs(pair.value) ** 2)
                state.covariance.add(SWAY, abs(pair.value) ** 2)
            return False
        pair.adapt(error.lasts)
        return True

    def has_expired(self, now_s: float) -> bool:
        """Whether dead reckoning has lasted too long; without a heading there is none."""
        setting = self._setting
        age_s = now_s - max(self.accepted_s, self._velocity_s)
        if age_s <= setting.gnss_timeout_s:
            return False
        is_over = age_s > setting.dead_reckoning_s or self.sigma_m > setting.lost_sigma_m
        return is_over or self._heading.is_blind

    def faults(self, now_s: float) -> int:
        """Bits of EstimateFault."""
        faults = EstimateFault.GNSS_LATE.value if self.latency.delay_s > 0.0 else 0
        if now_s - self.fix_s > self._setting.gnss_timeout_s:
            faults = EstimateFault.GNSS_LOST.value
        elif self._monitor.is_stuck:
            faults = EstimateFault.GNSS_FROZEN.value
        if now_s < self._monitor.intermittent_until_s:
            faults |= EstimateFault.GNSS_INTERMITTENT.value
        if self._state.position.noise > _NOISY_FACTOR:
            faults |= EstimateFault.GNSS_NOISY.value
        elif self._rejected_s > DISAGREES_S or self._bank.is_gnss_wrong:
            faults |= EstimateFault.GNSS_JUMPING.value
        if now_s - self.accepted_s > self._setting.gnss_timeout_s and self.has_expired(now_s):
            faults |= EstimateFault.POSITION_LOST.value
        return faults
