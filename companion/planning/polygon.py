"""Plane geometry of shores: the source of both the compiled kernel `_polygon` and its twin.

Cython compiles this file as it is, with the C types of `_polygon.pxd`; Python runs it where there is no
compiler. Both do the same floating-point operations in the same order.
"""


def segment_distance2(
    ax: float, ay: float, bx: float, by: float, px: float, py: float, qx: float, qy: float
) -> float:
    """Squared distance of the segments ab and pq; 0 where they meet."""
    best = point_distance2(ax, ay, px, py, qx, qy)
    best = min(best, point_distance2(bx, by, px, py, qx, qy))
    best = min(best, point_distance2(px, py, ax, ay, bx, by))
    best = min(best, point_distance2(qx, qy, ax, ay, bx, by))
    if best > 0.0 and crosses(ax, ay, bx, by, px, py, qx, qy):
        return 0.0
    return best


def point_distance2(px: float, py: float, ax: float, ay: float, bx: float, by: float) -> float:
    """Squared distance of the point p from the segment ab."""
    dx = bx - ax
    dy = by - ay
    length2 = dx * dx + dy * dy
    ex = px - ax
    ey = py - ay
    along = ex * dx + ey * dy
    if length2 > 0.0 and along > 0.0:
        if along >= length2:
            ex = px - bx
            ey = py - by
        else:
            cross = ex * dy - ey * dx
            return cross * cross / length2
    return ex * ex + ey * ey


def crosses(ax: float, ay: float, bx: float, by: float, px: float, py: float, qx: float, qy: float) -> bool:
    """Whether p and q lie on opposite sides of ab, and a and b on opposite sides of pq."""
    p = (bx - ax) * (py - ay) - (by - ay) * (px - ax)
    q = (bx - ax) * (qy - ay) - (by - ay) * (qx - ax)
    if (p > 0.0 and q > 0.0) or (p < 0.0 and q < 0.0):
        return False
    a = (qx - px) * (ay - py) - (qy - py) * (ax - px)
    b = (qx - px) * (by - py) - (qy - py) * (bx - px)
    return not ((a > 0.0 and b > 0.0) or (a < 0.0 and b < 0.0))
