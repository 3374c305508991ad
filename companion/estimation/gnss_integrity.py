"""Integrity of a GNSS receiver: detects frozen fixes, and positions that contradict their velocities."""

import math
from collections import deque
from typing import Final

from companion.estimation.stuck_value import StuckValueDetector

FROZEN_S: Final = 1.0  # identical fixes for this long while the boat moves
_SPAN_S: Final = 1.2  # window in which positions and velocities are compared
_MOST: Final = 30  # fixes kept
_OFF_SIGMAS: Final = 4.0
_CREEP_S: Final = 30  # longer window, for slow drift
_CREEP_SIGMAS: Final = 6.0
_CREEP_M_S: Final = 0.03  # more than the error of a receiver's velocity
_SHARE: Final = 0.75  # of a standard deviation: how far the error changes within half a minute
_SCATTERS: Final = 3.0
_SCATTER_S: Final = 10.0  # time constant of the learned scatter
_ODD_STEP: Final = 9.0  # of its variance: larger steps are excluded from the scatter


class GnssIntegrityMonitor:
    """Checks each fix before it is used."""

    def __init__(self) -> None:
        self._repetition = StuckValueDetector()
        self._at = 0j
        self._velocity: complex | None = None
        self._displacement_m = 0j
        self._sigma_m = self._variance_m2 = 0.0
        self._history: deque[tuple[float, complex]] = deque(maxlen=_MOST)
        self._long_history: deque[tuple[float, complex]] = deque(maxlen=_CREEP_S + 1)

    def update(self, time_s: float, at: complex, velocity: complex | None, sigma_m: float) -> None:
        """Add a fix later than the last: position in m and velocity in m/s, north + i east.

        sigma_m: of the position error within minutes, per axis.
        """
        is_same = bool(self._history) and at == self._at and velocity == self._velocity
        if self._history:
            dt = time_s - self._history[-1][0]
            if dt > _SPAN_S:
                self._history.clear()
                self._long_history.clear()
            else:
                now, before = velocity or 0j, self._velocity or 0j
                self._displacement_m += 0.5 * dt * (now + before)
        self._at, self._velocity = at, velocity
        self._learn(time_s, at - self._displacement_m, sigma_m)
        self._history.append((time_s, at - self._displacement_m))
        if velocity is None:
            self._long_history.clear()
        elif not self._long_history or time_s - self._long_history[-1][0] >= 1.0:
            self._long_history.append(self._history[-1])
        while time_s - self._history[0][0] > _SPAN_S:
            self._history.popleft()
        if is_same:
            self._repetition.repeat(time_s)
        else:
            self._repetition.change(time_s)

    def _learn(self, time_s: float, expected: complex, sigma_m: float) -> None:
        """Learn the scatter of positions about the path that their velocities integrate to."""
        self._sigma_m = sigma_m
        if self._variance_m2 == 0.0:
            self._variance_m2 = (sigma_m / _SCATTERS) ** 2
        if self._history and self._velocity is not None:
            (before_s, before), variance = self._history[-1], self._variance_m2
            step = 0.25 * abs(expected - before) ** 2  # two axes, two positions
            if step < _ODD_STEP * max(variance, (sigma_m / _SCATTERS) ** 2):
                self._variance_m2 += min((time_s - before_s) / _SCATTER_S, 0.2) * (step - variance)

    @property
    def scatter_m(self) -> float:
        """Standard deviation, per axis, of the position error within half a minute."""
        return max(_SHARE * self._sigma_m, _SCATTERS * math.sqrt(self._variance_m2))

    def is_frozen(self, speed_m_s: float, least_m_s: float) -> bool:
        """Whether the fix repeats although the boat moves.

        speed_m_s: estimated speed over ground. least_m_s: below this the boat counts as at rest.
        """
        repetition = self._repetition
        if repetition.run_s < FROZEN_S:
            return False
        reported_m_s = 0.0 if self._velocity is None else abs(self._velocity)
        if max(reported_m_s, speed_m_s) > least_m_s or repetition.is_unusual(FROZEN_S):
            repetition.is_faulty = True
        return repetition.is_faulty

    def is_consistent(self) -> bool:
        """Whether the positions of the last second agree with the velocities."""
        first, last = self._history[0][1], self._history[-1][1]
        return len(self._history) > 1 and abs(last - first) < _OFF_SIGMAS * self.scatter_m

    def creep_m(self) -> float:
        """Drift of the positions from their velocities over half a minute; 0 if within the noise."""
        if len(self._long_history) < 2:
            return 0.0
        (began_s, first), (time_s, last) = self._long_history[0], self._history[-1]
        crept_m = abs(last - first)
        most_m = _CREEP_SIGMAS * self.scatter_m + _CREEP_M_S * (time_s - began_s)
        return crept_m if crept_m > most_m else 0.0

    def reset_creep(self) -> None:
        """Restart the drift window."""
        self._long_history.clear()
