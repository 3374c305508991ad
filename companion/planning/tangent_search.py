"""A* over the tangent graph: the shortest route as arcs in order.

Tangents are tested against the shores when they are taken from the open list, and what the test says is kept.
Of the arrivals on an arc in one direction only the one of the lowest cost less position matters: after it
the others cost more, and a tangent that leaves before it crosses its way. Source of the kernel
`_tangent_search` and its twin, as segments.py.
"""

import math
from math import inf

from companion.planning import arcs as corners
from companion.planning import tangents as graph
from companion.planning.arcs import doubles, integers, more_doubles, more_integers

POSITION_TOLERANCE = 1e-9  # of arrivals and departures on an arc, radians
GRAZE_M = corners.GRAZE_M
INF = inf
TO_GOAL = -1  # in the place of a tangent
MOST_TANGENTS = graph.MOST_TANGENTS
UNKNOWN, CLEAR, BLOCKED = corners.UNKNOWN, corners.CLEAR, corners.BLOCKED


class TangentSearch:
    """The open list and the arrivals of one search after another over the same graph."""

    def __init__(self, tangents: graph.Tangents) -> None:
        self.tangents = tangents
        count = 2 * tangents.arcs.count + 1
        self.best = doubles(count)  # of a node: cost of its best arrival, less its position
        self.best_at = doubles(count)
        self.node, self.at, self.cost = (
            integers(64),
            doubles(64),
            doubles(64),
        )  # of each arrival
        self.parent, self.left_at = integers(64), doubles(64)  # whence, and where on that arc
        self.arrivals = 0
        self.entry_from, self.entry_edge = integers(256), integers(256)
        self.entries = 0
        self.heap_f, self.heap = doubles(256), integers(256)
        self.heap_size = 0
        self.goal_x = self.goal_y = 0.0
        self.aim_x = self.aim_y = self.aim_at = self.aim_cost = 0.0
        self.bound = INF
        self.bound_from = 0
        self.bound_at = 0.0
        self.expanded = 0
        self.start_x = self.start_y = 0.0
        self.start_first = self.start_end = self.forgotten = 0

    def begin(self, start_x: float, start_y: float, goal_x: float, goal_y: float) -> None:
        t = self.tangents
        if t.count > MOST_TANGENTS:
            t.forget()
        for node in range(2 * t.arcs.count):
            self.best[node] = INF
        self.arrivals = self.entries = self.heap_size = 0
        self.goal_x, self.goal_y = goal_x, goal_y
        self.bound = INF
        self.bound_from = 0
        self.expanded = 0
        if self.start_x != start_x or self.start_y != start_y or self.forgotten != t.forgotten:
            self.start_first = t.fan_of(-1, start_x, start_y)
            self.start_x, self.start_y, self.start_end = start_x, start_y, t.count
            self.forgotten = t.forgotten
        self._add_arrival(-1, 0.0, 0.0, -1, 0.0)

    def is_done(self, tangents: int) -> bool:
        """Follow so many more tangents, fewer at the end of the search. Whether it has ended."""
        last = self.expanded + tangents
        while self.heap_size > 0 and self.heap_f[0] < self.bound:
            if self.expanded >= last:
                return False
            entry = self._pop()
            if self.entry_edge[entry] == TO_GOAL:
                self._finish(self.entry_from[entry])
            else:
                self._arrive(entry)
        return True

    def turns(self) -> list[tuple[int, float, float]]:
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
            self.node, self.parent = more_integers(self.node), more_integers(self.parent)
            self.at, self.cost = more_doubles(self.at), more_doubles(self.cost)
            self.left_at = more_doubles(self.left_at)
        self.arrivals += 1
        self.node[label], self.at[label], self.cost[label] = node, at, cost
        self.parent[label], self.left_at[label] = parent, left_at
        radius = 0.0
        first, end = self.start_first, self.start_end
        if node >= 0:
            radius = t.arcs.radius[node >> 1]
            first = t.fan(node)
            end = t.fan_end[node]
        if self._aim(label) and self.aim_cost < self.bound:
            self._push(self.aim_cost, label, TO_GOAL)
        for k in range(first, end):
            if t.state[k] == BLOCKED:
                continue
            walk = t.departure[k] - at
            if walk < -POSITION_TOLERANCE:
                continue
            walk = max(walk, 0.0)
            g = cost + radius * walk + t.length[k]
            other = t.target[k]
            if self.best[other] <= g - t.arcs.radius[other >> 1] * t.arrival[k] and (
                t.arrival[k] <= self.best_at[other]
            ):
                continue
            dx = self.goal_x - t.end_x[k]
            dy = self.goal_y - t.end_y[k]
            f = g + math.sqrt(dx * dx + dy * dy)
            if f < self.bound:
                self._push(f, label, k)

    def _aim(self, label: int) -> bool:
        """Set the tangent from an arrival's arc to the goal, untested. Whether there is one."""
        t = self.tangents
        node = self.node[label]
        side = radius = at = 0.0
        x, y = self.start_x, self.start_y
        if node >= 0:
            i = node >> 1
            side = -1.0 if node & 1 else 1.0
            x, y, radius = t.arcs.x[i], t.arcs.y[i], t.arcs.radius[i]
        dx = self.goal_x - x
        dy = self.goal_y - y
        d2 = dx * dx + dy * dy
        square = d2 - radius * radius
        scale = d2
        if square < 0.0:
            slack = radius - 3.0 * GRAZE_M
            if d2 <= 0.0 or (slack > 0.0 and d2 < slack * slack):
                return False
            square = 0.0
            scale = math.sqrt(d2) * radius
        length = math.sqrt(square)
        u_x = (dx * length - dy * side * radius) / scale
        u_y = (dy * length + dx * side * radius) / scale
        if node >= 0:
            at = t.arcs.position(node, side * u_y, -side * u_x)
        walk = at - self.at[label]
        if at < 0.0 or walk < -POSITION_TOLERANCE:
            return False
        walk = max(walk, 0.0)
        self.aim_x = x + radius * side * u_y
        self.aim_y = y - radius * side * u_x
        self.aim_at = at
        self.aim_cost = self.cost[label] + radius * walk + length
        return True

    def _finish(self, label: int) -> None:
        """End the search if the tangent from an arrival's arc to the goal is clear."""
        a, node = self.tangents.arcs, self.node[label]
        if (
            self._aim(label)
            and a.segments.is_clear(self.aim_x, self.aim_y, self.goal_x, self.goal_y, a.limit2, a.reach)
            and (node < 0 or a.may_walk(node, self.at[label], self.aim_at))
        ):
            self.bound, self.bound_from, self.bound_at = self.aim_cost, label, self.aim_at

    def _arrive(self, entry: int) -> None:
        """Test the tangent of an entry of the open list, unless its arc was reached as well before."""
        t = self.tangents
        label, k = self.entry_from[entry], self.entry_edge[entry]
        node, radius = self.node[label], 0.0
        if node >= 0:
            radius = t.arcs.radius[node >> 1]
        if t.state[k] == BLOCKED:
            return
        departure, at = t.departure[k], t.arrival[k]
        walk = departure - self.at[label]
        walk = max(walk, 0.0)
        other = t.target[k]
        g = self.cost[label] + radius * walk + t.length[k]
        potential = g - t.arcs.radius[other >> 1] * at
        if self.best[other] <= potential + 1e-12 and (
            at <= self.best_at[other] or t.arcs.may_walk(other, self.best_at[other], at)
        ):
            return
        if t.state[k] == UNKNOWN:
            is_clear = t.arcs.segments.is_clear(
                t.end_x[k], t.end_y[k], t.begin_x[k], t.begin_y[k], t.arcs.limit2, t.arcs.reach
            )
            t.state[k] = CLEAR if is_clear else BLOCKED
            if not is_clear:
                return
        if node >= 0 and not t.arcs.may_walk(node, self.at[label], departure):
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
                more_integers(self.entry_from),
                more_integers(self.entry_edge),
            )
            self.heap_f, self.heap = more_doubles(self.heap_f), more_integers(self.heap)
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
