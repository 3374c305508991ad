"""The current that two healthy motors draw, learned under way: the equation of `motor_hypotheses`.

    I = A Σ d² − B Σ d n − C Σ d u + I0        over both motors

d: duty, n: speed of the shaft (the duty, with a lag), u: speed through the water, I0: the electronics. It is
linear in A, B, C and I0, which recursive least squares learns with a slow random walk (Y. Bar-Shalom, X. R.
Li, T. Kirubarajan, *Estimation with Applications to Tracking and Navigation*, 2001, section 3.4).
"""

from collections.abc import Sequence
from typing import Final

_FIRST_SIGMA: Final = (5.0, 3.0, 1.0, 2.0)  # of A, B, C and I0, in amperes, before anything is known
_WALK_S: Final = (1e-4, 1e-4, 1e-5, 1e-5)  # A²/s: a pack that empties, a hull that fouls
# One standard deviation of what the equation gets wrong: what happens between two commands a tenth of a
# second apart, and a share of the current, where propellers work in each other's water or the hull's.
_SIGMA_A: Final = 0.16
_SIGMA_SHARE: Final = 0.05
_SIGMA_SLIP_A: Final = 0.6  # for shafts that lag behind the command by all of it, where the lag is guessed
_SIGMA_ASTERN_A: Final = 0.4  # for propellers at full command against the water: not as ahead
_NOISE_S: Final = 30.0  # over which the noise is learned, where it is larger than this
_MOST_SQUARE: Final = 9.0  # a residual beyond three deviations does not widen the noise further
_ALIKE: Final = 4.0  # neighbouring samples, whose errors are alike, that count for one at first,
_SETTLED: Final = 15.0  # and later on, so that a fault of some seconds is not learned as usual
_LEARNED_S: Final = 12.0  # of driving: start, acceleration and a first turn tell A, B and C apart
_SIZE: Final = 4


class HealthyModel:
    """A measurement that is linear in four figures of healthy motors, which are learned while they work.

    residual: what is measured beyond the model, with its variance.
    """

    def __init__(self, first_sigma: Sequence[float], walk_s: Sequence[float]) -> None:
        """first_sigma: of each figure before anything is known; walk_s: their random walk, squared, per s."""
        self._theta = [0.0] * _SIZE
        self._walk_s = walk_s
        self._covariance = [
            [sigma * sigma if row == column else 0.0 for column in range(_SIZE)]
            for row, sigma in enumerate(first_sigma)
        ]
        self._regressors = [0.0] * _SIZE
        self._learned_s = 0.0
        self._noise = 1.0
        self._noise_share = 1.0  # of the expected variance that residuals have, at least 1
        self.residual, self.variance = 0.0, 1.0

    def expected(self, regressors: Sequence[float]) -> float:
        return sum([figure * one for figure, one in zip(self._theta, regressors, strict=True)])

    def hold(self, regressors: list[float], residual: float, noise: float) -> None:
        """Take what a measurement has beyond the model. noise: its variance, as far as it is known."""
        self._regressors, self.residual, x = regressors, residual, regressors
        unknown = sum([one * gain for one, gain in zip(x, _product(self._covariance, x), strict=True)])
        self._noise = noise * self._noise_share
        self.variance = self._noise + max(unknown, 0.0)

    @property
    def is_learned(self) -> bool:
        """Whether enough was driven to say what is usual."""
        return self._learned_s >= _LEARNED_S

    def learn(self, dt_s: float, *, is_driven: bool) -> None:
        """Take the last comparison for that of healthy motors."""
        if is_driven:
            self._learned_s += dt_s
        if self.is_learned:
            square = min(self.residual * self.residual / self.variance, _MOST_SQUARE)
            share = self._noise_share * (1.0 + min(dt_s / _NOISE_S, 1.0) * (square - 1.0))
            self._noise_share = max(share, 1.0)
        alike = _SETTLED if self.is_learned else _ALIKE
        x, covariance = self._regressors, self._covariance
        for at in range(_SIZE):
            covariance[at][at] += self._walk_s[at] * dt_s
        gains = _product(covariance, x)
        share = 1.0 / (sum([gain * one for gain, one in zip(gains, x, strict=True)]) + alike * self._noise)
        for at, gain in enumerate(gains):
            self._theta[at] += gain * share * self.residual
            weight = share * gain
            covariance[at] = [p - weight * other for p, other in zip(covariance[at], gains, strict=True)]


class MotorCurrent(HealthyModel):
    """drawn: what each motor draws by the model, left and right, in amperes. stall_a, water_a: A and C."""

    def __init__(self) -> None:
        super().__init__(_FIRST_SIGMA, _WALK_S)
        self.drawn = [0.0, 0.0]
        self.stall_a = self.water_a = 0.0  # never negative

    def compare(
        self, duties: tuple[float, float], shafts: list[float], water_m_s: float, current_a: float
    ) -> None:
        """Hold a measured current against the model."""
        a, b, c, idle = self._theta
        self.stall_a, self.water_a = max(a, 0.0), max(c, 0.0)
        squares = flows = speeds = slip = astern = 0.0
        for side, (duty, shaft) in enumerate(zip(duties, shafts, strict=True)):
            squares += duty * duty
            speeds += duty * shaft
            slip += abs(duty - shaft)
            if duty * water_m_s < 0.0:
                astern += abs(duty)
            flows += duty * water_m_s
            self.drawn[side] = max(a * duty * duty - b * duty * shaft - c * duty * water_m_s, 0.0)
        total = self.drawn[0] + self.drawn[1]
        noise = _SIGMA_A * _SIGMA_A + (_SIGMA_SHARE * total) ** 2 + (_SIGMA_SLIP_A * slip) ** 2
        noise += (_SIGMA_ASTERN_A * astern) ** 2
        self.hold([squares, -speeds, -flows, 1.0], current_a - total - idle, noise)


def _product(matrix: list[list[float]], x: list[float]) -> list[float]:
    a, b, c, d = x
    return [a * p + b * q + c * r + d * s for p, q, r, s in matrix]
