"""Covariance of the error state: propagation through a sparse transition, and scalar updates.

The transition of a step differs from the identity in a few rows, so F P Fᵀ is built row by row: a row
becomes a combination of rows, then its column the same (G. J. Bierman, *Factorization Methods for Discrete
Sequential Estimation*, 1977, chapter VII: sparse transitions). Uncorrelated measurements are processed one
scalar at a time, without a matrix inversion (Y. Bar-Shalom, X. R. Li, T. Kirubarajan, *Estimation with
Applications to Tracking and Navigation*, 2001, section 7.2). Those of one moment are collected: each is
made orthogonal to the others, in the metric of its variance (Gram and Schmidt), and all are subtracted from
P in one pass.

`_covariance.pyx` is the same in C; both return the same results.
"""

from collections.abc import Sequence
from typing import Final

# Components of the error state
NORTH: Final = 0
EAST: Final = 1
HEADING: Final = 2
SURGE: Final = 3
SWAY: Final = 4
CURRENT_NORTH: Final = 5
CURRENT_EAST: Final = 6
RATE_BIAS: Final = 7
COMPASS_OFFSET: Final = 8
THRUST_GAIN: Final = 9
GNSS_NORTH: Final = 10
GNSS_EAST: Final = 11
GNSS_DELAY: Final = 12
STATES: Final = 13

MOST: Final = 5  # measurements of one moment: compass, velocity and position
_LEAST: Final = 1e-12  # variance that rounding may leave; keeps the matrix positive
_ZEROS: Final = [0.0] * STATES


class Covariance:
    """The symmetric matrix P, and the measurements that it does not contain yet."""

    def __init__(self, deviations: Sequence[float]) -> None:
        """Start uncorrelated. deviations: initial standard deviations, in the order above."""
        self._rows = [[0.0] * STATES for _ in range(STATES)]
        for state, deviation in enumerate(deviations):
            self._rows[state][state] = deviation * deviation
        self._told: list[list[float]] = []  # P Hᵀ of each pending measurement, given those before it,
        self._shares: list[float] = []  # 1/S,
        self._innovations: list[float] = []  # and its innovation
        self._count = 0  # how many of these are accepted

    @property
    def rows(self) -> list[list[float]]:
        """A copy of P."""
        return [list(row) for row in self._rows]

    def get(self, state: int, other: int) -> float:
        """An element of P."""
        return self._rows[state][other]

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
        for row in self._rows:
            row[state] = 0.0
        self._rows[state] = row = [0.0] * STATES
        row[state] = variance

    def scale(self, state: int, factor: float) -> None:
        """The state becomes factor times itself."""
        row = [factor * a for a in self._rows[state]]
        self._replace(state, row, factor * row[state])

    def combine(self, state: int, factor: float, other: int, share: float) -> None:
        """The state becomes factor times itself plus a share of another."""
        rows = self._rows
        row = [factor * a + share * b for a, b in zip(rows[state], rows[other], strict=True)]
        self._replace(state, row, factor * row[state] + share * row[other])

    def carry(self, state: int, turn: float, ahead: float, aside: float, current: int, dt_s: float) -> None:
        """A position becomes itself plus shares of heading, surge and sway, and dt_s of the current."""
        rows = self._rows
        row = [
            x + turn * a + ahead * b + aside * c + dt_s * d
            for x, a, b, c, d in zip(
                rows[state], rows[HEADING], rows[SURGE], rows[SWAY], rows[current], strict=True
            )
        ]
        variance = (
            row[state] + turn * row[HEADING] + ahead * row[SURGE] + aside * row[SWAY] + dt_s * row[current]
        )
        self._replace(state, row, variance)

    def _replace(self, state: int, row: list[float], variance: float) -> None:
        """Set the row of a state, its column and its variance."""
        row[state] = variance
        rows = self._rows
        rows[state] = row
        for other, value in zip(rows, row, strict=True):
            other[state] = value

    def tell_heading(self, innovation: float, white: float) -> tuple[float, float]:
        """Measure heading plus compass offset. See `_tell`."""
        rows = self._rows
        told = [a + b for a, b in zip(rows[HEADING], rows[COMPASS_OFFSET], strict=True)]
        return self._tell(self._count, ((HEADING, 1.0), (COMPASS_OFFSET, 1.0)), told, innovation, white)

    def tell_velocity(
        self,
        slot: int,
        turn: float,
        ahead: float,
        aside: float,
        current: int,
        innovation: float,
        white: float,
    ) -> tuple[float, float]:
        """Measure shares of heading, surge and sway, plus a current. See `_tell`."""
        row = ((HEADING, turn), (SURGE, ahead), (SWAY, aside), (current, 1.0))
        told = self._moved(turn, ahead, aside, current)
        return self._tell(self._count + slot, row, told, innovation, white)

    def tell_position(
        self,
        slot: int,
        back_s: float,
        way_m_s: float,
        turn: float,
        ahead: float,
        aside: float,
        current: int,
        innovation: float,
        white: float,
    ) -> tuple[float, float]:
        """Measure the position back_s later, of which the present velocity is as in `tell_velocity`, plus the
        receiver's error, less way_m_s times its delay. See `_tell`.
        """
        rows, here = self._rows, current - CURRENT_NORTH
        wander = here + GNSS_NORTH
        row = (
            (here, 1.0), (wander, 1.0), (GNSS_DELAY, -way_m_s), (HEADING, back_s * turn),
            (SURGE, back_s * ahead), (SWAY, back_s * aside), (current, back_s),
        )  # fmt: skip
        told = [
            a + b - way_m_s * c + back_s * d
            for a, b, c, d in zip(
                rows[here],
                rows[wander],
                rows[GNSS_DELAY],
                self._moved(turn, ahead, aside, current),
                strict=True,
            )
        ]
        return self._tell(self._count + slot, row, told, innovation, white)

    def _moved(self, turn: float, ahead: float, aside: float, current: int) -> list[float]:
        rows = self._rows
        return [
            turn * a + ahead * b + aside * c + d
            for a, b, c, d in zip(rows[HEADING], rows[SURGE], rows[SWAY], rows[current], strict=True)
        ]

    def _tell(
        self,
        slot: int,
        row: tuple[tuple[int, float], ...],
        told: list[float],
        innovation: float,
        white: float,
    ) -> tuple[float, float]:
        """Prepare a measurement: its innovation and variance S, given those before it in the list.

        slot: counted from the accepted ones on. white: variance of its own noise.
        """
        for before, share, earlier in zip(self._told[:slot], self._shares, self._innovations, strict=False):
            alike = 0.0
            for state, part in row:
                alike += part * before[state]
            alike *= share
            innovation -= alike * earlier
            told = [a - alike * b for a, b in zip(told, before, strict=True)]
        variance = white
        for state, part in row:
            variance += part * told[state]
        self._told[slot:] = [told]
        self._shares[slot:] = [1.0 / variance]
        self._innovations[slot:] = [innovation]
        return innovation, variance

    def accept(self, count: int) -> None:
        """Accept this many of the measurements that were prepared last."""
        self._count += count

    def commit(self) -> list[float]:
        """Subtract Σ p pᵀ / S of all accepted measurements from P; returns the correction of the state."""
        count, rows, shares = self._count, self._rows, self._shares
        step = [0.0] * STATES
        for told, share, innovation in zip(self._told[:count], shares, self._innovations, strict=False):
            weight = share * innovation
            step = [x + weight * a for x, a in zip(step, told, strict=True)]
        if count == 1:
            p, s = self._told[0], shares[0]
            self._rows = rows = [
                [x - s * k * a for x, a in zip(row, p, strict=True)] for row, k in zip(rows, p, strict=True)
            ]
        elif count:
            a, b, c, d, e = self._told[:count] + (MOST - count) * [_ZEROS]
            s, t, u, v, w = shares[:count] + (MOST - count) * [0.0]
            self._rows = rows = [
                [
                    x - i * aa - j * bb - k * cc - m * dd - n * ee
                    for x, aa, bb, cc, dd, ee in zip(row, a, b, c, d, e, strict=True)
                ]
                for row, i, j, k, m, n in [
                    (row, s * i, t * j, u * k, v * m, w * n)
                    for row, i, j, k, m, n in zip(rows, a, b, c, d, e, strict=True)
                ]
            ]
        for state, row in enumerate(rows):
            row[state] = max(row[state], _LEAST)
        self._count = 0
        self._told.clear()
        self._shares.clear()
        self._innovations.clear()
        return step
