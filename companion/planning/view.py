"""What can be seen from a point among shores: the arcs that no shore hides.

Arcs are looked at in blocks, successive arcs of one ring, and blocks in groups that lie near to each other. A
view has beams, and for each the distance beyond which the shore hides every arc. What it leaves out is hidden
for sure; what it shows may be. Source of the kernel `_view` and its twin, as segments.py.
"""

import math

from companion.planning import arcs as corners
from companion.planning.arcs import doubles, integers

SIEVE_M = 1e-5  # by which a tangent is surely none; more than GRAZE_M
BLOCK, GROUP = 16, 16  # arcs of a block, blocks of a group
BEAMS = 64
CHAIN_OVERLAP, MOST_CHAIN = 8, 48  # corners of the shore from a block of arcs to beyond the next
FAR = 1e30  # more than any distance or its square
FIRST_STEPS = 256.0  # the groups within this part of the water are looked at first


class View:
    """The blocks of arcs, and what is seen of them."""

    def __init__(self, arcs: corners.Arcs) -> None:
        self.arcs = arcs
        self.blocks, count = 0, self.arcs.count
        # chain: the shore from a block to beyond the next, as its first segment and how many
        self.block_first, self.chain, self.chain_count = (integers(count + 1) for _ in range(3))
        self._divide()
        self.mid_x, self.mid_y = doubles(self.blocks + 1), doubles(self.blocks + 1)
        self.spread = doubles(self.blocks + 1)  # the farthest centre of a block from its middle
        self._set_blocks()
        self.groups = (self.blocks + GROUP - 1) // GROUP
        self.order = integers(self.blocks + 1)
        self.group_x, self.group_y = doubles(self.groups + 1), doubles(self.groups + 1)
        self.group_spread = doubles(self.groups + 1)
        self._set_groups()
        self.eye_x = self.eye_y = self.u_x = self.u_y = self.wide = 0.0
        self.most = self.per_t = self.beside = self.sure_m = 0.0
        self.is_quarter = False
        self.hidden = doubles(BEAMS)  # squared
        self.seen = integers(self.blocks + 1)  # blocks
        self.seen_count = 0
        self.ahead, self.away = integers(self.groups + 1), doubles(self.groups + 1)  # groups, least distance

    def _divide(self) -> None:
        """Divide the arcs of each ring into blocks."""
        arcs = self.arcs
        ring = first = 0  # a ring's first segment and arc
        for k in range(len(arcs.limit)):
            if arcs.following[k] <= k:
                end = first
                while end < arcs.count and arcs.corner[end] <= k:
                    end += 1
                if first < end:
                    self._add_blocks(first, end, k + 1 - ring)
                ring, first = k + 1, end

    def _add_blocks(self, first: int, end: int, size: int) -> None:
        """Divide the arcs of a ring of so many segments into blocks."""
        begin = self.arcs.corner[first]
        while first < end:
            last = min(first + BLOCK, end)
            here = self.arcs.corner[first]
            after = self.arcs.corner[last] if last < end else begin + size
            self.chain[self.blocks] = here
            self.chain_count[self.blocks] = min(after - here + 1 + CHAIN_OVERLAP, size + 1, MOST_CHAIN)
            self.blocks += 1
            self.block_first[self.blocks] = first = last

    def _set_blocks(self) -> None:
        """Set the middle and the spread of each block of arcs."""
        for block in range(self.blocks):
            first, end = self.block_first[block], self.block_first[block + 1]
            middle = (first + end) // 2
            self.mid_x[block], self.mid_y[block] = self.arcs.x[middle], self.arcs.y[middle]
            for i in range(first, end):
                dx = self.arcs.x[i] - self.arcs.x[middle]
                dy = self.arcs.y[i] - self.arcs.y[middle]
                away = math.sqrt(dx * dx + dy * dy)
                self.spread[block] = max(self.spread[block], away)

    def _set_groups(self) -> None:
        """Order the blocks by strips, to and fro, and set the middle and the spread of each group."""
        strip = max(self.arcs.segments.extent / math.sqrt(self.groups + 1.0), 1.0)
        keys = []
        for block in range(self.blocks):
            row = int((self.mid_y[block] - self.arcs.segments.y0) / strip)
            keys.append((row, -self.mid_x[block] if row % 2 else self.mid_x[block], block))
        keys.sort()
        for n in range(self.blocks):
            self.order[n] = keys[n][2]
        for group in range(self.groups):
            end = min((group + 1) * GROUP, self.blocks)
            middle = self.order[(group * GROUP + end) // 2]
            self.group_x[group], self.group_y[group] = self.mid_x[middle], self.mid_y[middle]
            for n in range(group * GROUP, end):
                block = self.order[n]
                dx = self.mid_x[block] - self.mid_x[middle]
                dy = self.mid_y[block] - self.mid_y[middle]
                away = math.sqrt(dx * dx + dy * dy) + self.spread[block]
                self.group_spread[group] = max(self.group_spread[group], away)

    def look(self, x: float, y: float, u_x: float, u_y: float, wide: float, more: float) -> None:
        """Look from a point in a direction u. wide: tangent of the angle from it.

        more: by which the beams are wider, for arcs just beside. 0: of all directions this is a quarter.
        """
        self.eye_x, self.eye_y, self.u_x, self.u_y, self.wide = x, y, u_x, u_y, wide
        self.most = wide + more
        self.per_t = 0.5 * BEAMS / self.most
        self.is_quarter = more == 0.0
        self.beside = self.sure_m = 0.0
        if more > 0.0:
            self.beside = 2.0 * (self.arcs.reach + SIEVE_M) * math.sqrt(1.0 + wide * wide)
            self.sure_m = self.beside / more  # from here on the beams are wider than what is looked at
        for beam in range(BEAMS):
            self.hidden[beam] = FAR
        self.seen_count = 0
        self._see()

    def shows(self, dx: float, dy: float) -> bool:
        """Whether an arc dx, dy away may be seen."""
        along = dx * self.u_x + dy * self.u_y
        across = dy * self.u_x - dx * self.u_y
        if math.fabs(across) > self.wide * along + self.beside or (self.is_quarter and across == -along):
            return False
        if math.fabs(across) >= self.most * along:
            return True
        return dx * dx + dy * dy <= self.hidden[self._beam(across / along)]

    def _beam(self, t: float) -> int:
        """The beam in a direction, given as its tangent."""
        return int((t + self.most) * self.per_t)

    def _is_in_view(self, dx: float, dy: float, spread: float) -> bool:
        """Whether something of this spread, dx, dy away, may be in view."""
        along = dx * self.u_x + dy * self.u_y
        slack = (1.0 + self.wide) * spread + self.beside
        return math.fabs(dy * self.u_x - dx * self.u_y) <= self.wide * along + slack

    def _see(self) -> None:
        """Let the shores hide arcs, the near ones first, and note the blocks that no nearer one hides."""
        left = 0
        for group in range(self.groups):
            dx = self.group_x[group] - self.eye_x
            dy = self.group_y[group] - self.eye_y
            if self._is_in_view(dx, dy, self.group_spread[group]):
                self.ahead[left] = group
                self.away[left] = math.sqrt(dx * dx + dy * dy) - self.group_spread[group]
                left += 1
        within = self.arcs.segments.extent / FIRST_STEPS
        while left > 0:
            farthest = self._farthest()
            kept = 0
            for n in range(left):
                if self.away[n] <= within and self.away[n] <= farthest:
                    group = self.ahead[n]
                    dx = self.group_x[group] - self.eye_x
                    dy = self.group_y[group] - self.eye_y
                    if not self._is_behind(dx, dy, self.group_spread[group]):
                        self._see_group(group)
                elif self.away[n] <= farthest:
                    self.ahead[kept], self.away[kept] = self.ahead[n], self.away[n]
                    kept += 1
            left = kept
            within *= 2.0

    def _see_group(self, group: int) -> None:
        for n in range(group * GROUP, min((group + 1) * GROUP, self.blocks)):
            block = self.order[n]
            dx = self.mid_x[block] - self.eye_x
            dy = self.mid_y[block] - self.eye_y
            if self._is_in_view(dx, dy, self.spread[block]) and not self._is_behind(
                dx, dy, self.spread[block]
            ):
                if self.spread[block] * self.per_t > 0.5 * math.sqrt(dx * dx + dy * dy):  # it may fill a beam
                    self._hide(block)
                self.seen[self.seen_count] = block
                self.seen_count += 1

    def _farthest(self) -> float:
        """Beyond this distance everything in view is hidden."""
        farthest2 = 0.0
        for beam in range(BEAMS):
            farthest2 = max(farthest2, self.hidden[beam])
        return max(math.sqrt(farthest2), 2.0 * self.sure_m)

    def _hide(self, block: int) -> None:
        """Set the squared distance beyond which the shore of a block hides every arc, by direction.

        A tangent lies within `reach` of the line of centres. A stretch of shore that crosses this strip from
        side to side, farther than `reach` and nearer than the other centre less `reach`, bars it.
        """
        s = self.arcs.segments
        reach = self.arcs.reach + SIEVE_M
        shrink = reach * math.sqrt(1.0 + self.most * self.most)
        k = self.chain[block]
        low, high, far2 = FAR, -FAR, 0.0
        for _ in range(self.chain_count[block]):
            dx = s.bx[k] - self.eye_x
            dy = s.by[k] - self.eye_y
            along = dx * self.u_x + dy * self.u_y
            if along < 2.0 * reach:  # behind, or beside
                if low < high:
                    self._lower(low, high, far2)
                low, high, far2 = FAR, -FAR, 0.0
            else:
                t = (dy * self.u_x - dx * self.u_y) / along
                narrower = shrink / along
                low = min(low, t + narrower)
                high = max(high, t - narrower)
                far2 = max(far2, dx * dx + dy * dy)
            k = self.arcs.following[k]
        if low < high:
            self._lower(low, high, far2)

    def _lower(self, low: float, high: float, far2: float) -> None:
        """Note that shores within a squared distance hide what lies between two directions."""
        low, high = max(low, -self.most), min(high, self.most)
        if low >= high:
            return
        far = math.sqrt(far2) + self.arcs.reach + SIEVE_M
        first = 0
        if low > -self.most:
            first = self._beam(low) + 1
        end = self._beam(high)
        for beam in range(first, min(end, BEAMS)):
            self.hidden[beam] = min(self.hidden[beam], far * far)

    def is_hidden(self, block: int) -> bool:
        """Whether shores hide all arcs of a block that are in view."""
        dx = self.mid_x[block] - self.eye_x
        dy = self.mid_y[block] - self.eye_y
        return self._is_behind(dx, dy, self.spread[block])

    def _is_behind(self, dx: float, dy: float, spread: float) -> bool:
        """Whether shores hide all of what is in view of something of this spread, dx, dy away."""
        near = dx * self.u_x + dy * self.u_y - spread
        if near <= 0.0 or near < self.sure_m:
            return False
        across = dy * self.u_x - dx * self.u_y
        low, high = (across - spread) / near, (across + spread) / near
        if low > 0.0:
            low *= near / (near + 2.0 * spread)
        if high < 0.0:
            high *= near / (near + 2.0 * spread)
        low, high = max(low, -self.most), min(high, self.most)
        nearest = math.sqrt(dx * dx + dy * dy) - spread
        if nearest <= 0.0 or low > high:
            return False
        first = self._beam(low)
        end = min(self._beam(high) + 1, BEAMS)
        while first < end and nearest * nearest > self.hidden[first]:
            first += 1
        return first == end
