"""Arcs about the convex corners of the land, at the clearance: where a route turns.

A node is an arc in one of its two directions: 2i for counter-clockwise, 2i + 1 for clockwise. Source of the
kernel `_arcs` and its twin, as segments.py.
"""

import math
from array import array
from math import pi

from companion.planning import segments as shore

GRAZE_M = 1e-6
"""Arcs lie this much outside the clearance, so that a tangent passes the exact test despite rounding."""
ROUNDING_M = 1e-9  # what a leg at just the clearance may lack, as it is computed
CONE_TOLERANCE = 1e-11  # of unit vectors, ten thousand roundings; over a leg of 10 km less than GRAZE_M
ARC_STEP_RAD = pi / 90.0
"""An arc is sailed as circumscribed legs that turn by at most this: step²/12, 0.01 % longer than the arc."""
BURIED_STEP_RAD = pi / 12.0
UNKNOWN, CLEAR, BLOCKED = 0, 1, 2


def doubles(count: int) -> "array[float]":
    return array("d", bytes(8 * count))


def integers(count: int) -> "array[int]":
    return array("q", bytes(8 * count))


def more_doubles(before: "array[float]") -> "array[float]":
    grown = doubles(2 * len(before))
    memoryview(grown)[: len(before)] = before
    return grown


def more_integers(before: "array[int]") -> "array[int]":
    grown = integers(2 * len(before))
    memoryview(grown)[: len(before)] = before
    return grown


class Arcs:
    """All arcs of one clearance.

    following[k]: the segment after segment k on its ring. left: 1 where the water is on the left of a
    segment, −1 on its right, 0 on both sides. limit: the clearance of each segment.
    """

    def __init__(
        self, segments: shore.Segments, following: "array[int]", left: "array[int]", limit: "array[float]"
    ) -> None:
        self.segments = segments
        self.following = following
        self.limit = limit
        self.limit2 = array("d", [(value - ROUNDING_M) * (value - ROUNDING_M) for value in limit])
        self.reach = max(limit)
        count = 2 * len(limit)
        self.x, self.y, self.radius = doubles(count), doubles(count), doubles(count)
        # An arc's points lie in the directions from a to b, counter-clockwise by `width`.
        self.a_x, self.a_y, self.b_x, self.b_y = (doubles(count) for _ in range(4))
        self.width = doubles(count)
        self.corner = integers(count)  # the segment that ends where an arc is
        self.alone = integers(count)  # what `_is_alone` found
        self.count = 0
        for k in range(len(limit)):
            if left[k] >= 0:
                self._add_arc(k, following[k], 1.0)
            if left[k] <= 0:
                self._add_arc(k, following[k], -1.0)

    def _add_arc(self, k: int, after: int, side: float) -> None:
        """Add the arc about the corner between two segments, if land is convex there and it is not buried."""
        s = self.segments
        d_x = s.bx[k] - s.ax[k]
        d_y = s.by[k] - s.ay[k]
        e_x = s.bx[after] - s.ax[after]
        e_y = s.by[after] - s.ay[after]
        d = math.sqrt(d_x * d_x + d_y * d_y)
        e = math.sqrt(e_x * e_x + e_y * e_y)
        turn = math.atan2(d_x * e_y - d_y * e_x, d_x * e_x + d_y * e_y) * side
        if pi - turn < 1e-9:
            turn = -pi  # a wall's end: there and back
        if turn > -CONE_TOLERANCE:
            return
        i = self.count
        self.x[i], self.y[i], self.corner[i] = s.bx[k], s.by[k], k
        self.radius[i] = self.limit[k] + GRAZE_M
        width = -turn
        if side > 0.0:  # water on the left: the arc begins where the next segment's left normal points
            self.a_x[i], self.a_y[i] = -e_y / e, e_x / e
            self.b_x[i], self.b_y[i] = -d_y / d, d_x / d
        else:
            self.a_x[i], self.a_y[i] = d_y / d, -d_x / d
            self.b_x[i], self.b_y[i] = e_y / e, -e_x / e
        pieces = int(width / BURIED_STEP_RAD) + 1
        first = 0
        while first < pieces and self._is_buried(i, width * first / pieces, width * (first + 1) / pieces):
            first += 1
        if first == pieces:
            return
        last = pieces
        while self._is_buried(i, width * (last - 1) / pieces, width * last / pieces):
            last -= 1
        a_x, a_y = self.a_x[i], self.a_y[i]
        if first > 0:
            angle = width * first / pieces
            self.a_x[i] = a_x * math.cos(angle) - a_y * math.sin(angle)
            self.a_y[i] = a_x * math.sin(angle) + a_y * math.cos(angle)
        if last < pieces:
            angle = width * last / pieces
            self.b_x[i] = a_x * math.cos(angle) - a_y * math.sin(angle)
            self.b_y[i] = a_x * math.sin(angle) + a_y * math.cos(angle)
        self.width[i] = width * (last - first) / pieces
        self.count += 1

    def _is_buried(self, i: int, low: float, high: float) -> bool:
        """Whether a piece of an arc lies within the clearance of one segment."""
        s = self.segments
        sagitta = self.radius[i] * (1.0 - math.cos(0.5 * (high - low)))
        px = self.x[i] + self.radius[i] * (self.a_x[i] * math.cos(low) - self.a_y[i] * math.sin(low))
        py = self.y[i] + self.radius[i] * (self.a_x[i] * math.sin(low) + self.a_y[i] * math.cos(low))
        qx = self.x[i] + self.radius[i] * (self.a_x[i] * math.cos(high) - self.a_y[i] * math.sin(high))
        qy = self.y[i] + self.radius[i] * (self.a_x[i] * math.sin(high) + self.a_y[i] * math.cos(high))
        return s.covers(px, py, qx, qy, self.limit, sagitta + GRAZE_M, self.reach)

    def position(self, node: int, m_x: float, m_y: float) -> float:
        """How far along its arc a node's direction m lies, in radians; −1 beside the arc."""
        i = node >> 1
        a = self.a_x[i] * m_y - self.a_y[i] * m_x
        b = m_x * self.b_y[i] - m_y * self.b_x[i]
        if a < -CONE_TOLERANCE or b < -CONE_TOLERANCE:
            return -1.0
        a_dot = self.a_x[i] * m_x + self.a_y[i] * m_y
        b_dot = self.b_x[i] * m_x + self.b_y[i] * m_y
        if a_dot + b_dot < 0.0 and self.width[i] < 3.0:
            return -1.0
        at = math.atan2(b, b_dot) if node & 1 else math.atan2(a, a_dot)
        if at < 0.0:
            return 0.0 if at > -1.0 else self.width[i]
        return at

    def point_x(self, node: int, at: float, radius: float) -> float:
        """East of the point of a node's arc at a position."""
        i = node >> 1
        if node & 1:
            return self.x[i] + radius * (self.b_x[i] * math.cos(at) + self.b_y[i] * math.sin(at))
        return self.x[i] + radius * (self.a_x[i] * math.cos(at) - self.a_y[i] * math.sin(at))

    def point_y(self, node: int, at: float, radius: float) -> float:
        """North of the point of a node's arc at a position."""
        i = node >> 1
        if node & 1:
            return self.y[i] + radius * (self.b_y[i] * math.cos(at) - self.b_x[i] * math.sin(at))
        return self.y[i] + radius * (self.a_x[i] * math.sin(at) + self.a_y[i] * math.cos(at))

    def is_walk_clear(self, node: int, low: float, high: float, legs: int) -> bool:
        """Whether the circumscribed legs from one position of an arc to another are clear."""
        i = node >> 1
        step = (high - low) / legs
        radius = self.radius[i] / math.cos(0.5 * step)
        x = self.point_x(node, low, self.radius[i])
        y = self.point_y(node, low, self.radius[i])
        for n in range(legs + 1):
            if n < legs:
                next_x = self.point_x(node, low + (n + 0.5) * step, radius)
                next_y = self.point_y(node, low + (n + 0.5) * step, radius)
            else:
                next_x = self.point_x(node, high, self.radius[i])
                next_y = self.point_y(node, high, self.radius[i])
            if not self.segments.is_clear(x, y, next_x, next_y, self.limit2, self.reach):
                return False
            x, y = next_x, next_y
        return True

    def may_walk(self, node: int, low: float, high: float) -> bool:
        """The same in steps of ARC_STEP_RAD."""
        if high - low < CONE_TOLERANCE or self._is_alone(node >> 1):
            return True
        return self.is_walk_clear(node, low, high, int((high - low) / ARC_STEP_RAD) + 1)

    def _is_alone(self, i: int) -> bool:
        """Whether an arc may be sailed as it likes: what is near is the shore on both sides of its corner."""
        if self.alone[i] == UNKNOWN:
            within = self.radius[i] / math.cos(0.5 * ARC_STEP_RAD)
            k = self.corner[i]
            is_alone = self.segments.is_alone(k, self.following[k], within, self.limit, within + self.reach)
            self.alone[i] = CLEAR if is_alone else BLOCKED
        return self.alone[i] == CLEAR
