"""Shore segments in uniform square bins: distances, and whether a leg is clear.

Source of the kernel `_segments` and its twin: Cython compiles this file as it is, with the C types of
`_segments.pxd`; Python runs it where there is no compiler. Both do the same floating-point operations in the
same order. x is east, y is north, in metres.
"""

import math
from array import array
from math import inf

CELLS_PER_SEGMENT = 8  # more cells cost memory, fewer cost tests


def _integers(count: int) -> "array[int]":
    return array("q", bytes(8 * count))


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


def segment_distance2(
    ax: float, ay: float, bx: float, by: float, px: float, py: float, qx: float, qy: float
) -> float:
    """Squared distance of the segments ab and pq; 0 where they meet."""
    p = (bx - ax) * (py - ay) - (by - ay) * (px - ax)
    q = (bx - ax) * (qy - ay) - (by - ay) * (qx - ax)
    if (p > 0.0 and q < 0.0) or (p < 0.0 and q > 0.0):
        a = (qx - px) * (ay - py) - (qy - py) * (ax - px)
        b = (qx - px) * (by - py) - (qy - py) * (bx - px)
        if (a > 0.0 and b < 0.0) or (a < 0.0 and b > 0.0):
            return 0.0
    best = point_distance2(ax, ay, px, py, qx, qy)
    other = point_distance2(bx, by, px, py, qx, qy)
    best = min(best, other)
    other = point_distance2(px, py, ax, ay, bx, by)
    best = min(best, other)
    other = point_distance2(qx, qy, ax, ay, bx, by)
    return min(best, other)


class Segments:
    """Shore segments in uniform square bins: distances, and whether a leg is clear."""

    def __init__(
        self, ax: "array[float]", ay: "array[float]", bx: "array[float]", by: "array[float]"
    ) -> None:
        self.ax, self.ay, self.bx, self.by = ax, ay, bx, by
        self.count = len(ax)
        self.lo = self.hi = 0
        west, east, south, north = min(ax), max(ax), min(ay), max(ay)
        self.x0, self.y0 = west, south
        self.extent = math.sqrt((east - west) * (east - west) + (north - south) * (north - south)) + 1.0
        area = max((east - west) * (north - south), self.extent * self.extent * 1e-4)
        self.cell = math.sqrt(area / (CELLS_PER_SEGMENT * self.count + 64))
        self.columns = int((east - west) / self.cell) + 1
        self.rows = int((north - south) / self.cell) + 1
        self.first = _integers(self.rows * self.columns + 1)
        self.items = _integers(1)
        self._fill(False)
        self.items = _integers(self._add_up() + 1)
        self._fill(True)
        self._shift()

    def _fill(self, is_second: bool) -> None:
        """Count the segments of each bin, then put them in; `first` ends as the end of each bin."""
        pad = 1e-9 * self.extent
        for k in range(self.count):
            low = self.row_of(min(self.ay[k], self.by[k]) - pad)
            high = self.row_of(max(self.ay[k], self.by[k]) + pad)
            for row in range(low, high + 1):
                self.set_span(self.ax[k], self.ay[k], self.bx[k], self.by[k], pad, row)
                for i in range(row * self.columns + self.lo, row * self.columns + self.hi + 1):
                    if is_second:
                        self.items[self.first[i]] = k
                    self.first[i] += 1

    def _add_up(self) -> int:
        """Make the counts the beginning of each bin; return their sum."""
        total = 0
        for i in range(self.rows * self.columns + 1):
            count = self.first[i]
            self.first[i] = total
            total += count
        return total

    def _shift(self) -> None:
        """Make the end of each bin the beginning of the next."""
        for i in range(self.rows * self.columns, 0, -1):
            self.first[i] = self.first[i - 1]
        self.first[0] = 0

    def row_of(self, y: float) -> int:
        """The row of bins at a northing, the nearest where it is outside."""
        value = (y - self.y0) / self.cell
        if value <= 0.0:
            return 0
        return self.rows - 1 if value >= self.rows else int(value)

    def column_of(self, x: float) -> int:
        """The column of bins at an easting, the nearest where it is outside."""
        value = (x - self.x0) / self.cell
        if value <= 0.0:
            return 0
        return self.columns - 1 if value >= self.columns else int(value)

    def set_span(self, ax: float, ay: float, bx: float, by: float, reach: float, row: int) -> None:
        """Set lo and hi to the columns that what lies within reach of ab may touch in a row."""
        x_lo = ax
        x_hi = bx
        dy = by - ay
        if dy != 0.0:
            y = self.y0 + row * self.cell - reach
            t = (y - ay) / dy
            s = (y + self.cell + 2.0 * reach - ay) / dy
            if t > s:
                t, s = s, t
            t = 0.0 if t < 0.0 else (1.0 if t > 1.0 else t)
            s = 0.0 if s < 0.0 else (1.0 if s > 1.0 else s)
            x_lo = ax + t * (bx - ax)
            x_hi = ax + s * (bx - ax)
        if x_lo > x_hi:
            x_lo, x_hi = x_hi, x_lo
        self.lo = self.column_of(x_lo - reach)
        self.hi = self.column_of(x_hi + reach)

    def is_clear(
        self, ax: float, ay: float, bx: float, by: float, limit2: "array[float]", reach: float
    ) -> bool:
        """Whether the leg ab keeps the squared distance limit2 from each segment; reach²: the largest."""
        low = self.row_of(min(ay, by) - reach)
        high = self.row_of(max(ay, by) + reach)
        is_up = ay <= by
        for step in range(high - low + 1):
            row = low + step if is_up else high - step
            self.set_span(ax, ay, bx, by, reach, row)
            start = self.first[row * self.columns + self.lo]
            end = self.first[row * self.columns + self.hi + 1]
            for i in range(start, end):
                k = self.items[i]
                if (
                    segment_distance2(ax, ay, bx, by, self.ax[k], self.ay[k], self.bx[k], self.by[k])
                    < limit2[k]
                ):
                    return False
        return True

    def covers(
        self, px: float, py: float, qx: float, qy: float, limit: "array[float]", slack: float, reach: float
    ) -> bool:
        """Whether p and q lie within the limit, less a slack, of one and the same segment."""
        low = self.row_of(min(py, qy) - reach)
        high = self.row_of(max(py, qy) + reach)
        for row in range(low, high + 1):
            self.set_span(px, py, qx, qy, reach, row)
            start = self.first[row * self.columns + self.lo]
            end = self.first[row * self.columns + self.hi + 1]
            for i in range(start, end):
                k = self.items[i]
                within = limit[k] - slack
                if within <= 0.0:
                    continue
                if point_distance2(px, py, self.ax[k], self.ay[k], self.bx[k], self.by[k]) >= within * within:
                    continue
                if point_distance2(qx, qy, self.ax[k], self.ay[k], self.bx[k], self.by[k]) < within * within:
                    return True
        return False

    def is_alone(self, k: int, after: int, within: float, limit: "array[float]", reach: float) -> bool:
        """Whether only k and the segment after it are nearer to their corner than `within` and their limit.

        reach: within and the largest limit.
        """
        x, y = self.bx[k], self.by[k]
        for row in range(self.row_of(y - reach), self.row_of(y + reach) + 1):
            self.set_span(x, y, x, y, reach, row)
            start = self.first[row * self.columns + self.lo]
            end = self.first[row * self.columns + self.hi + 1]
            for i in range(start, end):
                n = self.items[i]
                least2 = (within + limit[n]) * (within + limit[n])
                is_own = n in (k, after)
                if not is_own and (
                    point_distance2(x, y, self.ax[n], self.ay[n], self.bx[n], self.by[n]) < least2
                ):
                    return False
        return True

    def distance2(self, ax: float, ay: float, bx: float, by: float) -> float:
        """Squared distance of the leg ab from the nearest segment."""
        farthest = 2.0 * self.extent + math.sqrt(
            (ax - self.x0) * (ax - self.x0) + (ay - self.y0) * (ay - self.y0)
        )
        reach = self.cell
        while True:
            best = inf
            low = self.row_of(min(ay, by) - reach)
            high = self.row_of(max(ay, by) + reach)
            for row in range(low, high + 1):
                self.set_span(ax, ay, bx, by, reach, row)
                start = self.first[row * self.columns + self.lo]
                end = self.first[row * self.columns + self.hi + 1]
                for i in range(start, end):
                    k = self.items[i]
                    near = segment_distance2(ax, ay, bx, by, self.ax[k], self.ay[k], self.bx[k], self.by[k])
                    best = min(best, near)
            if best <= reach * reach or reach > farthest:
                return best
            reach *= 3.0

    def is_inside(self, x: float, y: float) -> bool:
        """Whether a ray from the point crosses the segments an odd number of times."""
        row = self.row_of(y)
        column = self.column_of(x)
        is_odd = False
        for i in range(self.first[row * self.columns + column], self.first[(row + 1) * self.columns]):
            k = self.items[i]
            if (self.ay[k] > y) != (self.by[k] > y):
                at = self.ax[k] + (y - self.ay[k]) / (self.by[k] - self.ay[k]) * (self.bx[k] - self.ax[k])
                # A segment lies in several bins and counts in the one where it is crossed.
                bin_column = row * self.columns + self.column_of(at)
                if at > x and self.first[bin_column] <= i < self.first[bin_column + 1]:
                    is_odd = not is_odd
        return is_odd

    def near(self, x: float, y: float, reach: float) -> list[int]:
        """The segments that may lie within reach of a point."""
        found = set()
        for row in range(self.row_of(y - reach), self.row_of(y + reach) + 1):
            self.set_span(x, y, x, y, reach, row)
            start = self.first[row * self.columns + self.lo]
            end = self.first[row * self.columns + self.hi + 1]
            for i in range(start, end):
                found.add(self.items[i])
        return sorted(found)
