"""Identifies the yaw model K e^(−θs) / (s (τ s + 1)) from steering to heading: gain, time constant, delay.

With the steering u as the motors received it, the turn rate r and the heading ψ,

    r(t) = (K/τ) ∫ u(t − θ) dt − ψ(t)/τ + a t + b

where a and b absorb wind and unequal motors. For a given θ this is a linear regression; the θ with the
smallest residual is chosen.
"""

import math
from collections import deque
from typing import Final, NamedTuple

from companion.core.fitting import Fit

_DELAYS: Final = tuple(2 * step for step in range(13))  # in samples
SAMPLE_S: Final = 0.02


class FittedYawModel(NamedTuple):
    """K in rad/s for full steering, τ and θ in seconds. noise_rad_s: one standard deviation of the rate."""

    gain_rad_s: float
    time_s: float
    delay_s: float
    noise_rad_s: float = 0.0


class YawFit:
    """Regressions over one stretch of samples, SAMPLE_S apart. fits: one a delay. count: of samples."""

    def __init__(self) -> None:
        self.fits = [Fit(4) for _ in _DELAYS]
        self._steered: deque[float] = deque([0.0] * (_DELAYS[-1] + 1), maxlen=_DELAYS[-1] + 1)
        self._turned_rad = 0.0
        self._last_rad_s = (0.0, 0.0)
        self._bends = 0.0
        self.count = 0

    def add(self, steering: float, yaw_rate_rad_s: float) -> None:
        """Add a sample: the steering of the last SAMPLE_S, −1..1, and the turn rate at its end."""
        self._steered.append(self._steered[-1] + SAMPLE_S * steering)
        self._turned_rad += SAMPLE_S * yaw_rate_rad_s
        self.count += 1
        last, before = self._last_rad_s
        self._last_rad_s = yaw_rate_rad_s, last
        if self.count > 2:
            self._bends += (yaw_rate_rad_s - 2.0 * last + before) ** 2
        if self.count <= _DELAYS[-1]:
            return
        time_s = SAMPLE_S * self.count
        for fit, delay in zip(self.fits, _DELAYS, strict=True):
            fit.add((self._steered[-1 - delay], self._turned_rad, time_s, 1.0), yaw_rate_rad_s)

    @property
    def noise_rad_s(self) -> float:
        """Standard deviation of the rate's white noise, from second differences."""
        return math.sqrt(self._bends / (6.0 * max(self.count - 2, 1)))


def yaw_model(stretches: list[YawFit]) -> FittedYawModel | None:
    """The model of all stretches together; None if they do not determine it."""
    best: FittedYawModel | None = None
    least, noise = math.inf, max((stretch.noise_rad_s for stretch in stretches), default=0.0)
    weights = [stretch.count for stretch in stretches]
    for at, delay in enumerate(_DELAYS):
        solved = [stretch.fits[at].solve() for stretch in stretches]
        found = [one[0] for one in solved if one is not None]
        if len(found) < len(solved) or not found:
            continue
        left = sum(stretch.fits[at].residual(one) for stretch, one in zip(stretches, found, strict=True))
        push = sum(w * one[0] for w, one in zip(weights, found, strict=True)) / sum(weights)
        damping = -sum(w * one[1] for w, one in zip(weights, found, strict=True)) / sum(weights)
        if left < least and push > 0.0 and damping > 0.0:
            least = left
            best = FittedYawModel(push / damping, 1.0 / damping, SAMPLE_S * delay, noise)
    return best
