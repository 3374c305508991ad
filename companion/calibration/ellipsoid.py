"""The ellipse or ellipsoid nearest to points, by linear least squares.

Points p on it satisfy (p − c)ᵀ S (p − c) = 1, or with c moved near the origin pᵀ A p + 2 bᵀ p = 1, which is
linear in A and b (D. A. Turner, I. J. Anderson, J. C. Mason, *An algorithm for fitting an ellipsoid to data*,
1999). Then c = −A⁻¹ b and S = A / (1 + cᵀ A c). Works in two or three dimensions.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

from companion.core.fitting import Fit

Point = tuple[float, ...]
Rows = list[list[float]]
_SWEEPS = 12  # Jacobi's method converges quadratically: six are enough for three rows


class Ellipsoid(NamedTuple):
    """centre; shape: symmetric positive matrix with |shape (p − centre)| = 1 on the surface."""

    centre: Point
    shape: Rows

    @property
    def radius(self) -> float:
        """The geometric mean of the semi-axes."""
        return math.prod(symmetric_eigen(self.shape)[0]) ** (-1.0 / len(self.centre))

    def distance(self, point: Sequence[float]) -> float:
        """0 at the centre, 1 on the surface."""
        away = [a - b for a, b in zip(point, self.centre, strict=True)]
        return math.hypot(*(sum(s * a for s, a in zip(row, away, strict=True)) for row in self.shape))


def fit_ellipsoid(points: Sequence[Point]) -> Ellipsoid | None:
    """None if no ellipsoid fits: too few points, on a line, or on an open surface."""
    if not points:
        return None
    size = len(points[0])
    low = [min(axis) for axis in zip(*points, strict=True)]
    high = [max(axis) for axis in zip(*points, strict=True)]
    middle = [(a + b) / 2.0 for a, b in zip(low, high, strict=True)]
    scale = max(b - a for a, b in zip(low, high, strict=True)) / 2.0
    if not 0.0 < scale < math.inf:
        return None
    pairs = [(i, j) for i in range(size) for j in range(i, size)]
    fit = Fit(len(pairs) + size)
    for point in points:
        p = [(a - m) / scale for a, m in zip(point, middle, strict=True)]
        fit.add([p[i] * p[j] * (1.0 if i == j else 2.0) for i, j in pairs] + [2.0 * a for a in p], 1.0)
    if (solved := fit.solve()) is None:
        return None
    found = solved[0]
    quadratic: Rows = [[0.0] * size for _ in range(size)]
    for (i, j), value in zip(pairs, found, strict=False):
        quadratic[i][j] = quadratic[j][i] = value
    linear = found[len(pairs) :]
    values, vectors = symmetric_eigen(quadratic)
    if min(values) <= 0.0:
        return None
    inverse = _compose([1.0 / value for value in values], vectors)
    centre = [-sum(a * b for a, b in zip(row, linear, strict=True)) for row in inverse]
    level = 1.0 - sum(a * b for a, b in zip(centre, linear, strict=True))  # 1 + cᵀ A c, as A c = −b
    if level <= 0.0:
        return None
    shape = _compose([math.sqrt(value / level) / scale for value in values], vectors)
    return Ellipsoid(tuple(m + scale * c for m, c in zip(middle, centre, strict=True)), shape)


def symmetric_eigen(matrix: Rows) -> tuple[list[float], Rows]:
    """Eigenvalues and eigenvectors (as columns) of a symmetric matrix, by Jacobi's method (G. H. Golub,
    C. F. Van Loan, *Matrix Computations*, 8.5).
    """
    size = len(matrix)
    a = [list(row) for row in matrix]
    v = [[float(i == j) for j in range(size)] for i in range(size)]
    for _ in range(_SWEEPS):
        for p in range(size - 1):
            for q in range(p + 1, size):
                if a[p][q] == 0.0:
                    continue
                tau = (a[q][q] - a[p][p]) / (2.0 * a[p][q])
                t = math.copysign(1.0, tau) / (abs(tau) + math.hypot(1.0, tau))
                cos = 1.0 / math.hypot(1.0, t)
                sin = t * cos
                for row in (*a, *v):  # from the right: columns p and q
                    row[p], row[q] = cos * row[p] - sin * row[q], sin * row[p] + cos * row[q]
                for k in range(size):  # from the left: rows p and q
                    a[p][k], a[q][k] = cos * a[p][k] - sin * a[q][k], sin * a[p][k] + cos * a[q][k]
    return [a[i][i] for i in range(size)], v


def _compose(values: Sequence[float], vectors: Rows) -> Rows:
    """The symmetric matrix with these eigenvalues and eigenvectors."""
    size = len(values)
    return [
        [sum(values[k] * vectors[i][k] * vectors[j][k] for k in range(size)) for j in range(size)]
        for i in range(size)
    ]
