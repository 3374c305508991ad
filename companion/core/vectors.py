"""Vectors of three floats in right-handed axes. Body axes: x ahead, y to starboard, z down."""

import math
from typing import Final

Vector = tuple[float, float, float]
Matrix = tuple[Vector, Vector, Vector]
"""Rows."""

ZERO: Final[Vector] = (0.0, 0.0, 0.0)
UNIT: Final[Matrix] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def dot(a: Vector, b: Vector) -> float:
    """Inner product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    """Outer product."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def plus(a: Vector, b: Vector, factor: float = 1.0) -> Vector:
    """a + factor × b."""
    return (a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2])


def length(a: Vector) -> float:
    """Euclidean norm."""
    return math.sqrt(dot(a, a))


def unit(a: Vector) -> Vector | None:
    """The direction of a vector, None for one without length."""
    norm = length(a)
    return (a[0] / norm, a[1] / norm, a[2] / norm) if 0.0 < norm < math.inf else None


def times(matrix: Matrix, a: Vector) -> Vector:
    """Matrix × vector."""
    return (dot(matrix[0], a), dot(matrix[1], a), dot(matrix[2], a))


def product(a: Matrix, b: Matrix) -> Matrix:
    """Matrix × matrix."""
    columns = list(zip(*b, strict=True))
    rows = [tuple(dot(row, (c[0], c[1], c[2])) for c in columns) for row in a]
    (r, s, t) = rows
    return ((r[0], r[1], r[2]), (s[0], s[1], s[2]), (t[0], t[1], t[2]))


def quarter_turns(roll: int, pitch: int, yaw: int) -> Matrix:
    """Rotation by quarter turns about x, then y, then z; its elements are exact."""
    cos, sin = (1.0, 0.0, -1.0, 0.0), (0.0, 1.0, 0.0, -1.0)
    cr, sr, cp, sp, cy, sy = (table[turns % 4] for turns in (roll, pitch, yaw) for table in (cos, sin))
    about_x: Matrix = ((1.0, 0.0, 0.0), (0.0, cr, -sr), (0.0, sr, cr))
    about_y: Matrix = ((cp, 0.0, sp), (0.0, 1.0, 0.0), (-sp, 0.0, cp))
    about_z: Matrix = ((cy, -sy, 0.0), (sy, cy, 0.0), (0.0, 0.0, 1.0))
    return product(about_z, product(about_y, about_x))
