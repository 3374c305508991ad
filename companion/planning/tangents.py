"""The tangent graph of shores: arcs about convex corners of the land, and the tangents that join them.

A shortest path that keeps its clearance from every shore consists of straight legs and of arcs of that radius
about convex corners of the land (Liu and Arimoto, *Path Planning Using a Tangent Graph for Mobile Robots
Among Polygonal and Curved Obstacles*, 1992). A node is an arc in one of its two directions: 2i for
counter-clockwise, 2i + 1 for clockwise. Source of the kernel `_tangents` and its twin, as segments.py.
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
SIEVE_M = 1e-5  # by which a tangent is surely none; more than GRAZE_M
BURIED_STEP_RAD = pi / 12.0
BLOCK = 16  # successive arcs that are sieved together
FAN_FIELDS = 5  # position of departure, length, position of arrival, point of arrival


def _doubles(count: int) -> "array[float]":
    return array("d", bytes(8 * count))


def _integers(count: int) -> "array[int]":
    return array("q", bytes(8 * count))


class Fan:
    """The tangents that leave one arc in one direction, or a point."""

    def __init__(self, x: float, y: float, count: int) -> None:
        self.x, self.y = x, y  # where a point's tangents begin
        self.count = count
        self.data = _doubles(FAN_FIELDS * count + 1)  # FAN_FIELDS for each
        self.target = _integers(count + 1)
        self.state = _integers(count + 1)

    def fill(self, data: "array[float]", target: "array[int]") -> None:
        """Copy what was collected for `count` tangents."""
        for n in range(FAN_FIELDS * self.count):
            self.data[n] = data[n]
        for n in range(self.count):
            self.target[n] = target[n]


class Tangents:
    """The lazily built tangent graph of one clearance.

    following[k]: the segment after segment k on its ring. left: 1 where the water is on the left of a
    segment, −1 on its right, 0 on both sides. limit: the clearance of each segment.
    """

    def __init__(
        self, segments: shore.Segments, following: "array[int]", left: "array[int]", limit: "array[float]"
    ) -> None:
        self.segments = segments
        self.limit = limit
        self.limit2 = array("d", [(value - ROUNDING_M) * (value - ROUNDING_M) for value in limit])
        self.reach = max(limit)
        count = 2 * len(limit)
        self.x, self.y, self.radius = _doubles(count), _doubles(count), _doubles(count)
        # An arc's points lie in the directions from a to b, counter-clockwise by `width`.
        self.a_x, self.a_y, self.b_x, self.b_y = (_doubles(count) for _ in range(4))
        self.width = _doubles(count)
        self.count = 0
        for k in range(len(limit)):
            if left[k] >= 0:
                self._add_arc(k, following[k], 1.0)
            if left[k] <= 0:
                self._add_arc(k, following[k], -1.0)
        self.scratch_data = _doubles(2 * FAN_FIELDS * self.count + 1)
        self.scratch_target = _integers(2 * self.count + 1)
        self.joined = 0  # tangents collected there
        blocks = self.count // BLOCK + 1
        self.mid_x, self.mid_y = _doubles(blocks), _doubles(blocks)  # of the centres of a block of arcs
        self.spread = _doubles(blocks)  # the farthest centre of a block from its middle
        self._set_blocks()
        self.fans: list[Fan | None] = [None] * (2 * self.count)

    def _set_blocks(self) -> None:
        """Set the middle and the spread of each block of arcs."""
        for i in range(self.count):
            block = i // BLOCK
            middle = min(block * BLOCK + BLOCK // 2, self.count - 1)
            self.mid_x[block], self.mid_y[block] = self.x[middle], self.y[middle]
            dx = self.x[i] - self.x[middle]
            dy = self.y[i] - self.y[middle]
            away = math.sqrt(dx * dx + dy * dy)
            self.spread[block] = max(self.spread[block], away)

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
        self.x[i], self.y[i] = s.bx[k], s.by[k]
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

    def fan(self, node: int) -> Fan:
        known = self.fans[node]
        if known is None:
            known = self.fan_of(node, 0.0, 0.0)
            self.fans[node] = known
        return known

    def fan_of(self, node: int, x: float, y: float) -> Fan:
        """The tangents of a node, or of a point where the node is −1, untested."""
        self.joined = 0
        radius = 0.0
        if node >= 0:
            i = node >> 1
            x, y, radius = self.x[i], self.y[i], self.radius[i]
        # A tangent's normal at an arc, times the line to the other centre, lies between the difference of the
        # radii and their sum. Where it is outside for both ends of a cone it is for all of the cone.
        most = radius + self.reach + SIEVE_M
        least = -self.reach - SIEVE_M
        a_x = a_y = b_x = b_y = 0.0
        if node >= 0:
            a_x, a_y, b_x, b_y = self.a_x[i], self.a_y[i], self.b_x[i], self.b_y[i]
        for block in range(self.count // BLOCK + 1):
            if node >= 0:
                dx = self.mid_x[block] - x
                dy = self.mid_y[block] - y
                a = a_x * dx + a_y * dy
                b = b_x * dx + b_y * dy
                high = most + self.spread[block]
                low = least - self.spread[block]
                if (a > high and b > high) or (a < low and b < low):
                    continue
            for j in range(block * BLOCK, min(block * BLOCK + BLOCK, self.count)):
                dx = self.x[j] - x
                dy = self.y[j] - y
                a = -self.a_x[j] * dx - self.a_y[j] * dy
                b = -self.b_x[j] * dx - self.b_y[j] * dy
                if (a > most and b > most) or (a < least and b < least):
                    continue
                if node >= 0:
                    a = a_x * dx + a_y * dy
                    b = b_x * dx + b_y * dy
                    if (a > most and b > most) or (a < least and b < least):
                        continue
                d2 = dx * dx + dy * dy
                if d2 > 0.0:
                    self._join(node, dx, dy, d2, 2 * j)
                    self._join(node, dx, dy, d2, 2 * j + 1)
        found = Fan(x, y, self.joined)
        found.fill(self.scratch_data, self.scratch_target)
        return found

    def _join(self, node: int, dx: float, dy: float, d2: float, other: int) -> None:
        """Collect the tangent of two nodes with centres dx, dy apart, if it leaves and reaches their arcs."""
        side, radius = 0.0, 0.0
        if node >= 0:
            side = -1.0 if node & 1 else 1.0
            radius = self.radius[node >> 1]
        j = other >> 1
        j_side = -1.0 if other & 1 else 1.0
        rho = j_side * self.radius[j] - side * radius
        square = d2 - rho * rho
        scale = d2
        if square < 0.0:
            slack = math.fabs(rho) - 3.0 * GRAZE_M
            if slack > 0.0 and d2 < slack * slack:
                return
            square = 0.0
            scale = math.sqrt(d2) * math.fabs(rho)
        length = math.sqrt(square)
        u_x = (dx * length + dy * rho) / scale
        u_y = (dy * length - dx * rho) / scale
        arrival = self.position(other, j_side * u_y, -j_side * u_x)
        if arrival < 0.0:
            return
        departure = 0.0
        if node >= 0:
            departure = self.position(node, side * u_y, -side * u_x)
            if departure < 0.0:
                return
        n = self.joined
        self.joined += 1
        self.scratch_data[FAN_FIELDS * n] = departure
        self.scratch_data[FAN_FIELDS * n + 1] = length
        self.scratch_data[FAN_FIELDS * n + 2] = arrival
        self.scratch_data[FAN_FIELDS * n + 3] = self.x[j] + self.radius[j] * j_side * u_y
        self.scratch_data[FAN_FIELDS * n + 4] = self.y[j] - self.radius[j] * j_side * u_x
        self.scratch_target[n] = other

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
        if high - low < CONE_TOLERANCE:
            return True
        return self.is_walk_clear(node, low, high, int((high - low) / ARC_STEP_RAD) + 1)
