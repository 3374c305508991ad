"""The tangent graph of shores: arcs about convex corners of the land, and the tangents that join them.

A shortest path that keeps its clearance from every shore consists of straight legs and of arcs of that radius
about convex corners of the land (Liu and Arimoto, *Path Planning Using a Tangent Graph for Mobile Robots
Among Polygonal and Curved Obstacles*, 1992). Source of the kernel `_tangents` and its twin, as segments.py.
"""

import math

from companion.planning import arcs as corners
from companion.planning import view as sight
from companion.planning.arcs import doubles, integers, more_doubles, more_integers

GRAZE_M, SIEVE_M, UNKNOWN = corners.GRAZE_M, sight.SIEVE_M, corners.UNKNOWN
WIDE_RAD = 0.8  # half of a fan that is collected by quarters
BESIDE = 0.02  # by which the view of a narrow fan is wider, tangent
MOST_TANGENTS = 1 << 20  # kept from one search to the next: 76 MB


class Tangents:
    """The tangents, built as searches need them."""

    def __init__(self, arcs: corners.Arcs, view: sight.View) -> None:
        self.arcs, self.view = arcs, view
        # Of a tangent: positions of departure and arrival, length, ends, node of arrival, what its test said
        self.departure, self.length, self.arrival = doubles(64), doubles(64), doubles(64)
        self.begin_x, self.begin_y = doubles(64), doubles(64)
        self.end_x, self.end_y = doubles(64), doubles(64)
        self.target, self.state = integers(64), integers(64)
        nodes = 2 * self.arcs.count
        self.fan_first, self.fan_end = integers(nodes + 1), integers(nodes + 1)
        self.count = self.forgotten = 0
        self.forget()

    def forget(self) -> None:
        """Forget all tangents."""
        self.count = 0
        self.forgotten += 1
        for node in range(2 * self.arcs.count):
            self.fan_first[node] = -1

    def fan(self, node: int) -> int:
        """The first of a node's tangents; they end before `fan_end`."""
        if self.fan_first[node] < 0:
            self.fan_first[node] = self.fan_of(node, 0.0, 0.0)
            self.fan_end[node] = self.count
        return self.fan_first[node]

    def fan_of(self, node: int, x: float, y: float) -> int:
        """Add the tangents of a node, or of a point where the node is −1: untested, but for those that shores
        surely bar. Returns the first; they are the last of all.
        """
        first = self.count
        half = 0.0
        if node >= 0:
            a, i = self.arcs, node >> 1
            x, y = a.x[i], a.y[i]
            half = 0.5 * a.width[i]
            m_x = a.a_x[i] * math.cos(half) - a.a_y[i] * math.sin(half)
            m_y = a.a_x[i] * math.sin(half) + a.a_y[i] * math.cos(half)
            side = -1.0 if node & 1 else 1.0
            if half < WIDE_RAD:
                self.view.look(x, y, -side * m_y, side * m_x, math.tan(half), BESIDE)
                self._collect(node)
        if node < 0 or half >= WIDE_RAD:
            for quarter in range(4):
                u_x = (1.0 - quarter) * (1 - quarter % 2)
                u_y = (2.0 - quarter) * (quarter % 2)
                self.view.look(x, y, u_x, u_y, 1.0, 0.0)
                self._collect(node)
        return first

    def _collect(self, node: int) -> None:
        """Add the tangents to what is seen."""
        a, view = self.arcs, self.view
        for n in range(view.seen_count):
            block = view.seen[n]
            if view.is_hidden(block):
                continue
            for j in range(view.block_first[block], view.block_first[block + 1]):
                dx = a.x[j] - view.eye_x
                dy = a.y[j] - view.eye_y
                if not view.shows(dx, dy) or not self._may_meet(node, j, dx, dy):
                    continue
                d2 = dx * dx + dy * dy
                if d2 > 0.0:
                    if self.count + 2 > len(self.target):
                        self._grow()
                    self._join(node, dx, dy, d2, 2 * j)
                    self._join(node, dx, dy, d2, 2 * j + 1)

    def _may_meet(self, node: int, j: int, dx: float, dy: float) -> bool:
        """Whether a tangent to an arc's centre, dx, dy away, may leave and reach both arcs.

        A tangent's normal at an arc, times the line to the other centre, lies between the difference of the
        radii and their sum. Where it is outside for both ends of a cone it is for all of the cone.
        """
        arcs = self.arcs
        reach = arcs.reach + SIEVE_M
        radius = arcs.radius[node >> 1] if node >= 0 else 0.0
        a = -arcs.a_x[j] * dx - arcs.a_y[j] * dy
        b = -arcs.b_x[j] * dx - arcs.b_y[j] * dy
        if (a > radius + reach and b > radius + reach) or (a < -reach and b < -reach):
            return False
        if node < 0:
            return True
        i = node >> 1
        a = arcs.a_x[i] * dx + arcs.a_y[i] * dy
        b = arcs.b_x[i] * dx + arcs.b_y[i] * dy
        return not ((a > radius + reach and b > radius + reach) or (a < -reach and b < -reach))

    def _join(self, node: int, dx: float, dy: float, d2: float, other: int) -> None:
        """Add the tangent of two nodes, centres dx, dy apart, if it leaves and reaches their arcs."""
        arcs = self.arcs
        side, radius = 0.0, 0.0
        if node >= 0:
            side = -1.0 if node & 1 else 1.0
            radius = arcs.radius[node >> 1]
        j = other >> 1
        j_side = -1.0 if other & 1 else 1.0
        rho = j_side * arcs.radius[j] - side * radius
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
        arrival = arcs.position(other, j_side * u_y, -j_side * u_x)
        if arrival < 0.0:
            return
        departure = 0.0
        if node >= 0:
            departure = arcs.position(node, side * u_y, -side * u_x)
            if departure < 0.0:
                return
        n = self.count
        self.count += 1
        self.departure[n], self.length[n], self.arrival[n] = departure, length, arrival
        self.begin_x[n] = self.view.eye_x + radius * side * u_y
        self.begin_y[n] = self.view.eye_y - radius * side * u_x
        self.end_x[n] = arcs.x[j] + arcs.radius[j] * j_side * u_y
        self.end_y[n] = arcs.y[j] - arcs.radius[j] * j_side * u_x
        self.target[n], self.state[n] = other, UNKNOWN

    def _grow(self) -> None:
        self.departure, self.length = more_doubles(self.departure), more_doubles(self.length)
        self.arrival = more_doubles(self.arrival)
        self.begin_x, self.begin_y = more_doubles(self.begin_x), more_doubles(self.begin_y)
        self.end_x, self.end_y = more_doubles(self.end_x), more_doubles(self.end_y)
        self.target, self.state = more_integers(self.target), more_integers(self.state)
