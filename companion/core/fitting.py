"""Recursive least squares for a few unknowns."""

import math
from collections.abc import Sequence


class Fit:
    """value = Σ coefficient × regressor. Keeps only the normal equations. square: sum of squared values."""

    def __init__(self, unknowns: int) -> None:
        self.count = 0
        self._rows = [[0.0] * (unknowns + 1) for _ in range(unknowns)]
        self.square = 0.0

    def add(self, regressors: Sequence[float], value: float, weight: float = 1.0) -> None:
        self.count += 1
        self.square += weight * value * value
        for row, one in zip(self._rows, regressors, strict=True):
            for column, other in enumerate(regressors):
                row[column] += weight * one * other
            row[-1] += weight * one * value

    def solve(self) -> tuple[list[float], float] | None:
        """The coefficients, and the standard deviation of the first; None if the equations are singular.

        Gauss-Jordan with the diagonal for pivots, which is stable for symmetric equations.
        """
        size = len(self._rows)
        rows = [[*row, float(at == 0)] for at, row in enumerate(self._rows)]  # and a column of the inverse
        for pivot in range(size):
            if not rows[pivot][pivot] > 1e-9 * self._rows[pivot][pivot]:
                return None
            for row in range(size):
                if row != pivot:
                    share = rows[row][pivot] / rows[pivot][pivot]
                    rows[row] = [a - share * b for a, b in zip(rows[row], rows[pivot], strict=True)]
        found = [rows[at][size] / rows[at][at] for at in range(size)]
        variance = self.residual(found) / max(self.count - size, 1)
        return found, math.sqrt(max(variance * rows[0][size + 1] / rows[0][0], 0.0))

    def residual(self, found: Sequence[float]) -> float:
        """The residual sum of squares of a solution."""
        return max(self.square - sum(a * row[-1] for a, row in zip(found, self._rows, strict=True)), 0.0)
