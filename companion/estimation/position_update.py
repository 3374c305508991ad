"""GNSS measurement update: gates fixes, corrects the filter, and reports when the position is lost.

While the receiver's velocities are accepted, its positions can be missing or rejected for a minute or more.
Positions that persistently disagree are accepted in the end; the farther off they are, the longer that takes.
With neither, the model alone propagates the position and the uncertainty grows at the model's rate.
"""

import math
from typing import Final

from companion.config.estimation import Estimation
from companion.core.evidence import MOST_SQUARE
from companion.core.state import EstimateFault
from companion.estimation.covariance import EAST, NORTH, SURGE, SWAY
from companion.estimation.delay import DELAYS, PAUSE_S, STEP_S, DelayEstimator
from companion.estimation.error_state import VELOCITY_M_S, ErrorStateFilter, PairUpdate
from companion.estimation.heading_update import HeadingUpdate
from companion.estimation.innovation import GATE_2
from companion.estimation.monitor import SensorMonitor

# Share of the stated speed accuracy. Receivers state it with a wide margin: the velocities of six u-blox
# receivers at rest, which stated 0.19 to 4.5 m/s, were off by 0.03 to 0.13 of that.
SPEED_ACCURACY_SHARE: Final = 0.2
_AT_REST: Final = 0.1  # share of cruise speed
_REJECTED: Final = 0.5  # share of fixes rejected in the last second that reports GNSS_JUMPING
# Of cruise speed: how fast the gate opens for positions that are rejected but agree with their velocities:
# 3 m are accepted after some 10 s, as when a receiver returns to its true position, and 10 m after 40 s
_OPENS: Final = 0.018
_NEIGHBOUR: Final = 0.2  # weight of a position whose error is like that of the one before
_IDLE_RESET_S: Final = 10.0  # without thrust, even a jump is accepted after this
_SWINGING_M_S: Final = 0.3  # error in a turn of the velocity that thrust and steering let expect
_LOST: Final = int(EstimateFault.GNSS_LOST)
_FROZEN: Final = int(EstimateFault.GNSS_FROZEN)
_JUMPING: Final = int(EstimateFault.GNSS_JUMPING)
_LATE: Final = int(EstimateFault.GNSS_LATE)
_POSITION_LOST: Final = int(EstimateFault.POSITION_LOST)


class PositionUpdate:
    """accepted_s: time of the latest accepted position; fix_s: of the latest fix; resets: restarts so far."""

    def __init__(self, state: ErrorStateFilter, heading: HeadingUpdate, setting: Estimation) -> None:
        self._state, self._heading, self._setting = state, heading, setting
        self._bank = heading.bank
        self._monitor = SensorMonitor()
        self.latency = DelayEstimator(_SWINGING_M_S)
        self.fix_s = self.accepted_s = self._velocity_s = self._time_s = -math.inf
        self._rejected_share = 0.0
        self._reset_counter = self.resets = 0

    @property
    def sigma_m(self) -> float:
        """Standard deviation of the position, per axis."""
        covariance = self._state.covariance
        return math.sqrt(0.5 * (covariance.variance(NORTH) + covariance.variance(EAST)))

    def advance(self, now_s: float) -> None:
        """Tell the delay estimator what to expect. Call several times a second."""
        state = self._state
        if self.latency.is_due(now_s):
            self.latency.add_expected(now_s, state.through_water(state.heading_rad))

    def _inflate(self, variance_m2: float) -> None:
        self._state.covariance.add(NORTH, variance_m2)
        self._state.covariance.add(EAST, variance_m2)

    def update(
        self,
        stamp_s: float,
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
        state, bank = self._state, self._bank
        pause_s, self.fix_s = stamp_s - self.fix_s, stamp_s
        if PAUSE_S < pause_s < math.inf:
            self.latency.note_gap(stamp_s, pause_s)
        is_otherwise_late = velocity is not None and self.latency.compare(stamp_s, velocity)
        time_s = stamp_s - self.latency.delay_s
        if speed_accuracy_m_s is None:
            # A camera pose is a hundred times more accurate than GNSS; so is its velocity.
            variance = VELOCITY_M_S**2
        else:
            variance = max(VELOCITY_M_S, SPEED_ACCURACY_SHARE * speed_accuracy_m_s) ** 2
        if self.accepted_s == -math.inf or reset_counter != self._reset_counter or is_otherwise_late:
            self.resets += self.accepted_s > -math.inf
            self._reset_counter = reset_counter
            self._start(time_s, stamp_s, at, velocity, sigma_m, variance)
            return
        dt, self._time_s = time_s - self._time_s, time_s
        predicted = state.at(time_s)[3]
        speed_m_s = max(abs(predicted), abs(velocity or 0j))
        if self._is_repeated(stamp_s, at, velocity, speed_m_s * dt):
            return
        drift_m = bank.weigh_position(
            stamp_s,
            at,
            predicted if velocity is None else velocity,
            sigma_m,
            variance,
            is_measured=velocity is not None,
        )
        if velocity is not None:
            channels = state.velocity_north, state.velocity_east
            self._update_velocity(time_s, stamp_s, velocity, variance)
            self._heading.check_velocity(velocity, time_s, 0.5 * sum(one.variance for one in channels), dt)
        position = state.predict_position(time_s, at, sigma_m)
        rejected_s = min(stamp_s - self.accepted_s, bank.drift.steady_s)
        is_good = position.nis <= GATE_2
        if bank.is_gnss_wrong:
            if is_good:  # the estimate may already have followed
                self._raise(drift_m)
            is_good = False
        elif not is_good and self._is_otherwise_late(stamp_s, at, position, dt):
            state.commit()
            self._start(stamp_s - self.latency.delay_s, stamp_s, at, velocity, sigma_m, variance)
            return
        elif not is_good and rejected_s > 1.0:
            open_m2 = (_OPENS * state.cruise_m_s * rejected_s) ** 2
            is_good = position.nis_with(open_m2) <= GATE_2
            if is_good:
                self._inflate(open_m2)
                position = state.predict_position(time_s, at, sigma_m)
        self._rejected_share += min(dt, 1.0) * ((0.0 if is_good else 1.0) - self._rejected_share)
        if is_good:
            state.apply(position)
            self.accepted_s = stamp_s
        state.commit()
        if not is_good and self._may_restart(time_s):
            self.resets += 1
            self._start(time_s, stamp_s, at, velocity, sigma_m, variance)
        state.learn_yaw(dt, self._heading.is_in_time)

    def _is_repeated(self, stamp_s: float, at: complex, velocity: complex | None, moved_m: float) -> bool:
        """Whether a fix repeats the last one bit by bit: it tells nothing, and may be of a stuck receiver."""
        monitor = self._monitor
        if not monitor.update((at, velocity), stamp_s, moved_m / (_AT_REST * self._state.cruise_m_s)):
            self._bank.drift.restart()
        elif monitor.run_s > 0.0:
            self.accepted_s = stamp_s
        return monitor.run_s > 0.0

    def _is_otherwise_late(self, stamp_s: float, at: complex, position: PairUpdate, dt_s: float) -> bool:
        """Whether a position that does not fit is that of another time, which changes the delay."""
        if not self.latency.is_watching(stamp_s):
            return False
        state, costs = self._state, []
        weight = 0.5 * _NEIGHBOUR * position.nis / abs(position.innovation) ** 2
        for delay in range(DELAYS):
            north_m, east_m, _, _ = state.at(stamp_s - delay * STEP_S)
            off_m = abs(at - complex(north_m + state.gnss_north_m, east_m + state.gnss_east_m))
            costs.append(min(weight * off_m * off_m, _NEIGHBOUR * MOST_SQUARE))
        return self.latency.weigh(costs, dt_s)

    def _update_velocity(self, time_s: float, stamp_s: float, velocity: complex, variance: float) -> None:
        state = self._state
        pair = state.predict_velocity(time_s, velocity, variance)
        if pair.nis > GATE_2:
            if self._bank.drift.steady_s == 0.0 or self.latency.is_uncertain(stamp_s):
                return
            more = 0.5 * abs(pair.innovation) ** 2  # the receiver is right, the model is not
            state.covariance.add(SURGE, more)
            state.covariance.add(SWAY, more)
            pair = state.predict_velocity(time_s, velocity, variance)
        state.adapt(pair)
        state.apply(pair)
        self._velocity_s = stamp_s

    def _raise(self, sigma_m: float) -> None:
        self._state.covariance.raise_to(NORTH, sigma_m * sigma_m)
        self._state.covariance.raise_to(EAST, sigma_m * sigma_m)

    def _may_restart(self, time_s: float) -> bool:
        """Whether fixes that do not fit are better than the present estimate."""
        is_idle = time_s - max(self._state.idle_since_s + 2.0, self.accepted_s) > _IDLE_RESET_S
        return self.has_expired(time_s) or (is_idle and self._bank.drift.steady_s > 0.0)

    def _start(
        self,
        time_s: float,
        stamp_s: float,
        at: complex,
        velocity: complex | None,
        sigma_m: float,
        variance: float,
    ) -> None:
        """Start the position at a fix."""
        state = self._state
        north_m, east_m, _, _ = state.at(time_s)
        moved = complex(state.north_m - north_m, state.east_m - east_m)
        state.start_position(at.real + moved.real, at.imag + moved.imag, sigma_m)
        if velocity is not None:
            state.apply(state.predict_velocity(time_s, velocity, variance))
            state.commit()
            self._velocity_s = stamp_s
        self._bank.drift.restart()
        self.accepted_s, self._time_s = stamp_s, time_s
        self._rejected_share = 0.0

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
        faults = _LATE if self.latency.delay_s > 0.0 else 0
        if now_s - self.fix_s > self._setting.gnss_timeout_s:
            faults = _LOST
        elif self._monitor.is_stuck:
            faults = _FROZEN
        if self._rejected_share > _REJECTED or self._bank.is_gnss_wrong:
            faults |= _JUMPING
        if now_s - self.accepted_s > self._setting.gnss_timeout_s and self.has_expired(now_s):
            faults |= _POSITION_LOST
        return faults
