"""A* over the tangent graph: the shortest route as arcs in order.

Tangents are tested against the shores when they are taken from the open list, and what the test says is kept.
Of the arrivals on an arc in one direction only the one of the lowest cost less position matters: after it
the others cost more, and a tangent that leaves before it crosses its way. Source of the kernel
`_tangent_search` and its twin, as segments.py.
"""

import math
from array import array
from math import inf

from companion.planning import tangents as graph

POSITION_TOLERANCE = 1e-9  # of arrivals and departures on an arc, radians
GRAZE_M = graph.GRAZE_M
FAN_FIELDS = graph.FAN_FIELDS
UNKNOWN, CLEAR, BLOCKED = 0, 1, 2


def _doubles(count: int) -> "array[float]":
    return array("d", bytes(8 * count))


def _integers(count: int) -> "array[int]":
    return array("q", bytes(8 * count))


def _more_doubles(before: "array[float]") -> "array[float]":
    grown = _doubles(2 * len(before))
    for i in range(len(before)):
        grown[i] = before[i]
    return grown


def _more_integers(before: "array[int]") -> "array[int]":
    grown = _integers(2 * len(before))
    for i in range(len(before)):
        grown[i] = before[i]
    return grown


class TangentSearch:
    """The open list and the arrivals of one search after another over the same graph."""

    def __init__(self, tangents: graph.Tangents) -> None:
        self.tangents = tangents
        count = 2 * tangents.count + 1
        self.best = _doubles(count)  # of a node: cost of its best arrival, less its position
        self.best_at = _doubles(count)
        self.node, self.at, self.cost = _integers(64), _doubles(64), _doubles(64)  # of each arrival
        self.parent, self.left_at = _integers(64), _doubles(64)  # whence, and where on that arc
        self.arrivals = 0
        self.entry_from, self.entry_edge = _integers(256), _integers(256)
        self.entries = 0
        self.heap_f, self.heap = _doubles(256), _integers(256)
        self.heap_size = 0
        self.goal_x = self.goal_y = 0.0
        self.bound = inf
        self.bound_from = 0
        self.bound_at = 0.0
        self.expanded = 0
        self.start = self.tangents.fan_of(-1, 0.0, 0.0)

    def begin(self, start_x: float, start_y: float, goal_x: float, goal_y: float) -> None:
        for node in range(2 * self.tangents.count):
            self.best[node] = inf
        self.arrivals = self.entries = self.heap_size = 0
        self.goal_x, self.goal_y = goal_x, goal_y
        self.bound = inf
        self.bound_from = 0
        self.expanded = 0
        if self.start.x != start_x or self.start.y != start_y:
            self.start = self.tangents.fan_of(-1, start_x, start_y)
        self._add_arrival(-1, 0.0, 0.0, -1, 0.0)

    def is_done(self, tangents: int) -> bool:
        """Follow so many more tangents, fewer at the end of the search. Whether it has ended."""
        last = self.expanded + tangents
        while self.heap_size > 0 and self.heap_f[0] < self.bound:
            if self.expanded >= last:
                return False
            self._arrive(self._pop())
        return True

    def arcs(self) -> list[tuple[int, float, float]]:
        """The shortest way as its arcs in order: node, position of arrival, position of departure.

        Its length is `bound`: infinite where there is no way. A straight way has no arcs.
        """
        found = []
        label, left_at = self.bound_from, self.bound_at
        while label > 0:
            found.append((self.node[label], self.at[label], left_at))
            left_at = self.left_at[label]
            label = self.parent[label]
        return found[::-1]

    def _add_arrival(self, node: int, at: float, cost: float, parent: int, left_at: float) -> None:
        """Settle an arrival, and put the tangents that leave its arc behind it in the open list."""
        t = self.tangents
        label = self.arrivals
        if label == len(self.node):
            self.node, self.parent = _more_integers(self.node), _more_integers(self.parent)
            self.at, self.cost = _more_doubles(self.at), _more_doubles(self.cost)
            self.left_at = _more_doubles(self.left_at)
        self.arrivals += 1
        self.node[label], self.at[label], self.cost[label] = node, at, cost
        self.parent[label], self.left_at[label] = parent, left_at
        radius = 0.0
        fan = self.start
        if node >= 0:
            radius = t.radius[node >> 1]
            fan = t.fan(node)
        self._try_goal(label)
        for k in range(fan.count):
            if fan.state[k] == BLOCKED:
                continue
            walk = fan.data[FAN_FIELDS * k] - at
            if walk < -POSITION_TOLERANCE:
                continue
            walk = max(walk, 0.0)
            g = cost + radius * walk + fan.data[FAN_FIELDS * k + 1]
            other = fan.target[k]
            if self.best[other] <= g - t.radius[other >> 1] * fan.data[FAN_FIELDS * k + 2] and (
                fan.data[FAN_FIELDS * k + 2] <= self.best_at[other]
            ):
                continue
            dx = self.goal_x - fan.data[FAN_FIELDS * k + 3]
            dy = self.goal_y - fan.data[FAN_FIELDS * k + 4]
            f = g + math.sqrt(dx * dx + dy * dy)
            if f < self.bound:
                self._push(f, label, k)

    def _try_goal(self, label: int) -> None:
        """Lower the bound where the tangent from an arrival's arc to the goal is clear."""
        t = self.tangents
        node = self.node[label]
        if node < 0:
            if t.segments.is_clear(self.start.x, self.start.y, self.goal_x, self.goal_y, t.limit2, t.reach):
                dx = self.goal_x - self.start.x
                dy = self.goal_y - self.start.y
                self.bound = math.sqrt(dx * dx + dy * dy)
            return
        i = node >> 1
        side = -1.0 if node & 1 else 1.0
        radius = t.radius[i]
        dx = self.goal_x - t.x[i]
        dy = self.goal_y - t.y[i]
        d2 = dx * dx + dy * dy
        square = d2 - radius * radius
        scale = d2
        if square < 0.0:
            slack = radius - 3.0 * GRAZE_M
            if d2 <= 0.0 or (slack > 0.0 and d2 < slack * slack):
                return
            square = 0.0
            scale = math.sqrt(d2) * radius
        length = math.sqrt(square)
        u_x = (dx * length - dy * side * radius) / scale
        u_y = (dy * length + dx * side * radius) / scale
        departure = t.position(node, side * u_y, -side * u_x)
        walk = departure - self.at[label]
        if departure < 0.0 or walk < -POSITION_TOLERANCE:
            return
        walk = max(walk, 0.0)
        total = self.cost[label] + radius * walk + length
        if (
            total < self.bound
            and t.segments.is_clear(
                t.x[i] + radius * side * u_y,
                t.y[i] - radius * side * u_x,
                self.goal_x,
                self.goal_y,
                t.limit2,
                t.reach,
            )
            and t.may_walk(node, self.at[label], departure)
        ):
            self.bound, self.bound_from, self.bound_at = total, label, departure

    def _arrive(self, entry: int) -> None:
        """Test the tangent of an entry of the open list, unless its arc was reached as well before."""
        t = self.tangents
        label, k = self.entry_from[entry], self.entry_edge[entry]
        node, radius = self.node[label], 0.0
        fan = self.start
        if node >= 0:
            fan = t.fan(node)
            radius = t.radius[node >> 1]
        if fan.state[k] == BLOCKED:
            return
        departure, at = fan.data[FAN_FIELDS * k], fan.data[FAN_FIELDS * k + 2]
        walk = departure - self.at[label]
        walk = max(walk, 0.0)
        other = fan.target[k]
        g = self.cost[label] + radius * walk + fan.data[FAN_FIELDS * k + 1]
        potential = g - t.radius[other >> 1] * at
        if self.best[other] <= potential + 1e-12 and (
            at <= self.best_at[other] or t.may_walk(other, self.best_at[other], at)
        ):
            return
        if fan.state[k] == UNKNOWN:
            x, y = fan.x, fan.y
            if node >= 0:
                x, y = t.point_x(node, departure, radius), t.point_y(node, departure, radius)
            is_clear = t.segments.is_clear(
                fan.data[FAN_FIELDS * k + 3], fan.data[FAN_FIELDS * k + 4], x, y, t.limit2, t.reach
            )
            fan.state[k] = CLEAR if is_clear else BLOCKED
            if not is_clear:
                return
        if node >= 0 and not t.may_walk(node, self.at[label], departure):
            return
        self.expanded += 1
        if potential < self.best[other]:
            self.best[other] = potential
            self.best_at[other] = at
        self._add_arrival(other, at, g, label, departure)

    def _push(self, f: float, label: int, k: int) -> None:
        entry = self.entries
        if entry == len(self.entry_from):
            self.entry_from, self.entry_edge = (
                _more_integers(self.entry_from),
                _more_integers(self.entry_edge),
            )
            self.heap_f, self.heap = _more_doubles(self.heap_f), _more_integers(self.heap)
        self.entries += 1
        self.entry_from[entry], self.entry_edge[entry] = label, k
        i = self.heap_size
        self.heap_size += 1
        while i > 0:
            up = (i - 1) >> 1
            if self.heap_f[up] <= f:
                break
            self.heap_f[i], self.heap[i] = self.heap_f[up], self.heap[up]
            i = up
        self.heap_f[i], self.heap[i] = f, entry

    def _pop(self) -> int:
        """The entry of the lowest f; of equal ones the same in the kernel and in its twin."""
        top = self.heap[0]
        self.heap_size -= 1
        size = self.heap_size
        f, entry = self.heap_f[size], self.heap[size]
        i = 0
        while True:
            down = 2 * i + 1
            if down >= size:
                break
            if down + 1 < size and self.heap_f[down + 1] < self.heap_f[down]:
                down += 1
            if self.heap_f[down] >= f:
                break
            self.heap_f[i], self.heap[i] = self.heap_f[down], self.heap[down]
            i = down
        self.heap_f[i], self.heap[i] = f, entry
        return top
