"""Covariance of the error state: sparse transitions, and measurements one scalar at a time.

The transition of a step differs from the identity in a few rows, so F P Fᵀ is built row by row: a row
becomes a sum of shares of rows, then its column the same (G. J. Bierman, *Factorization Methods for Discrete
Sequential Estimation*, 1977, chapter VII). Measurements of one moment are collected: each is made orthogonal
to those before it, in the metric of its variance (Gram and Schmidt), and all are subtracted from P in one
pass, without a matrix inversion.
"""

from collections.abc import Sequence
from typing import Final

STATE_NAMES: Final = (
    "north_m", "east_m", "heading_rad", "surge_m_s", "sway_m_s", "current_north_m_s", "current_east_m_s",
    "bias_rad_s", "offset_rad", "gain", "gnss_north_m", "gnss_east_m", "delay_s",
)  # fmt: skip
STATES: Final = len(STATE_NAMES)
(
    NORTH, EAST, HEADING, SURGE, SWAY, CURRENT_NORTH, CURRENT_EAST,
    RATE_BIAS, COMPASS_OFFSET, THRUST_GAIN, GNSS_NORTH, GNSS_EAST, GNSS_DELAY,
) = range(STATES)  # fmt: skip

MOST: Final = 5  # measurements of one moment: compass, velocity and position
_LEAST: Final = 1e-12  # variance that rounding may leave; keeps the matrix positive

Shares = tuple[tuple[int, float], ...]  # of states, five at most
_NONE: Final = ((0, 0.0),) * 5


class Covariance:
    """The symmetric matrix P, and the measurements that it does not contain yet."""

    def __init__(self, deviations: Sequence[float]) -> None:
        """Start uncorrelated. deviations: initial standard deviations, in the order above."""
        self._rows = [[0.0] * STATES for _ in deviations]
        for state, deviation in enumerate(deviations):
            self._rows[state][state] = deviation * deviation
        # P Hᵀ of each pending measurement given those before it, 1/S, and its innovation
        self._pending: list[tuple[list[float], float, float]] = []

    @property
    def rows(self) -> list[list[float]]:
        """A copy of P."""
        return [list(row) for row in self._rows]

    def variance(self, state: int) -> float:
        """Variance of a state."""
        return self._rows[state][state]

    def add(self, state: int, variance: float) -> None:
        """Add process noise to a state."""
        self._rows[state][state] += variance

    def raise_to(self, state: int, variance: float) -> None:
        """Raise the variance of a state to at least this."""
        row = self._rows[state]
        row[state] = max(row[state], variance)

    def reset(self, state: int, variance: float) -> None:
        """Forget a state: no correlations, and this variance."""
        self.mix(state, ())
        self._rows[state][state] = variance

    def mix(self, state: int, shares: Shares) -> None:
        """The state becomes the sum of these shares of states."""
        row = self._sum(shares)
        row[state] = sum([share * row[other] for other, share in shares])
        rows = self._rows
        rows[state] = row
        for other, value in zip(rows, row, strict=True):
            other[state] = value

    def _sum(self, shares: Shares) -> list[float]:
        rows = self._rows
        if len(shares) == 1:
            ((one, share),) = shares
            return [share * p for p in rows[one]]
        (i, a), (j, b), (k, c), (m, d), (n, e) = (*shares, *_NONE[len(shares) :])
        if len(shares) == 2:
            return [a * p + b * q for p, q in zip(rows[i], rows[j], strict=True)]
        return [
            a * p + b * q + c * r + d * s + e * t
            for p, q, r, s, t in zip(rows[i], rows[j], rows[k], rows[m], rows[n], strict=True)
        ]

    def measure(self, shares: Shares, innovation: float, white: float) -> tuple[float, float]:
        """Measure the sum of these shares of states, with white noise of this variance.

        Returns innovation and variance S, given the measurements that are pending; this one joins them.
        """
        cross = self._sum(shares)
        for earlier, precision, its_innovation in self._pending:
            weight = precision * sum([share * earlier[state] for state, share in shares])
            innovation -= weight * its_innovation
            cross = [a - weight * b for a, b in zip(cross, earlier, strict=True)]
        variance = white + sum([share * cross[state] for state, share in shares])
        self._pending.append((cross, 1.0 / variance, innovation))
        return innovation, variance

    def withdraw(self, count: int) -> None:
        """Forget the latest pending measurements."""
        del self._pending[-count:]

    def commit(self) -> list[float]:
        """Subtract Σ p pᵀ / S of all pending measurements from P; returns the correction of the state."""
        pending = self._pending
        step = [0.0] * STATES
        for cross, precision, innovation in pending:
            weight = precision * innovation
            step = [x + weight * a for x, a in zip(step, cross, strict=True)]
        if len(pending) == 1:  # the compass, four times a second
            ((a, s, _),) = pending
            for state, row in enumerate(self._rows):
                i = s * a[state]
                self._rows[state] = less = [x - i * p for x, p in zip(row, a, strict=True)]
                less[state] = max(less[state], _LEAST)
            pending.clear()
            return step
        none = [0.0] * STATES
        a, b, c, d, e = [cross for cross, _, _ in pending] + (MOST - len(pending)) * [none]
        s, t, u, v, w = [precision for _, precision, _ in pending] + (MOST - len(pending)) * [0.0]
        for state, row in enumerate(self._rows):
            i, j, k, m, n = s * a[state], t * b[state], u * c[state], v * d[state], w * e[state]
            less = [
                x - i * p - j * q - k * r - m * y - n * z
                for x, p, q, r, y, z in zip(row, a, b, c, d, e, strict=True)
            ]
            less[state] = max(less[state], _LEAST)
            self._rows[state] = less
        pending.clear()
        return step
