"""Areas of a fence: rings (polygons) and discs in the local frame.

Both answer three queries: is a point inside, how near is the line, and at what distance does a course cross
it. A ring sorts its sides into bands of northing, so a query only visits the near ones. Inside follows the
even-odd rule (J. D. Foley et al., *Computer Graphics*, 2nd ed. 1990, section 3.6).
"""

import math
from collections.abc import Sequence

from companion.core.geo import Point

_SIDES_PER_BAND = 4  # on average, in a convex ring
_MAX_BANDS = 128
_ROUNDING_M = 1e-6

Side = tuple[float, float, float, float, float, float, float]
"""North and east of its start, of its end, north and east to its end, 1 / squared length (0 for a point)."""


class Ring:
    """A closed polygon. A point on the line may count as either side.

    Raises:
        ValueError: fewer than three vertices.
    """

    def __init__(self, vertices: Sequence[Point], is_inclusion: bool) -> None:
        if len(vertices) < 3:
            raise ValueError(f"a ring of {len(vertices)} vertices: expected three or more")
        self.vertices = tuple(vertices)
        self.is_inclusion = is_inclusion
        self.south_m = min(vertex.north_m for vertex in vertices)
        self.north_m = max(vertex.north_m for vertex in vertices)
        self.west_m = min(vertex.east_m for vertex in vertices)
        self.east_m = max(vertex.east_m for vertex in vertices)
        count = min(max(len(vertices) // _SIDES_PER_BAND, 1), _MAX_BANDS)
        self._band_m = max((self.north_m - self.south_m) / count, 1e-9)
        self._bands: list[list[Side]] = [[] for _ in range(count)]
        before = vertices[-1]
        for vertex in vertices:
            side = _side(before, vertex)
            low, high = sorted((self._band(before.north_m), self._band(vertex.north_m)))
            for band in self._bands[low : high + 1]:
                band.append(side)
            before = vertex

    def contains(self, north_m: float, east_m: float) -> bool:
        """Whether a ray from the point crosses the line an odd number of times."""
        if not (self.south_m <= north_m <= self.north_m and self.west_m <= east_m <= self.east_m):
            return False
        inside = False
        for start_n, start_e, end_n, _, along_n, along_e, _ in self._bands[self._band(north_m)]:
            if (start_n <= north_m) != (end_n <= north_m):
                inside ^= start_e + (north_m - start_n) * along_e / along_n > east_m
        return inside

    def distance_m(self, north_m: float, east_m: float, within_m: float = math.inf) -> float:
        """Distance to the line, at most within_m."""
        best = within_m * within_m
        bands, height, middle = self._bands, self._band_m, self._band(north_m)
        last = len(bands) - 1
        below_m = north_m - (self.south_m + middle * height)  # to the lower edge of the last band visited
        above_m = height - below_m
        low, high = middle, middle + 1
        while low >= 0 or high <= last:
            if low >= 0:
                best = _nearest_squared(bands[low], north_m, east_m, best)
                low -= 1
                if below_m > 0.0 and below_m * below_m >= best:
                    low = -1
                below_m += height
            if high <= last:
                if above_m > 0.0 and above_m * above_m >= best:
                    high = last + 1
                    continue
                best = _nearest_squared(bands[high], north_m, east_m, best)
                high += 1
                above_m += height
        return math.sqrt(best)

    def crossing_m(self, at: Point, ahead_n: float, ahead_e: float, reach_m: float) -> float:
        """Distance to the first crossing along a unit vector; reach_m without one."""
        north_m, east_m = at
        low, high = sorted((self._band(north_m), self._band(north_m + reach_m * ahead_n)))
        nearest = reach_m
        for band in self._bands[low : high + 1]:
            for start_n, start_e, end_n, end_e, along_n, along_e, _ in band:
                off_n, off_e = start_n - north_m, start_e - east_m
                # Each end is tested as in the neighbouring side, so no course passes between two sides
                is_left = ahead_n * off_e < ahead_e * off_n
                if is_left != (ahead_n * (end_e - east_m) < ahead_e * (end_n - north_m)):
                    turn = ahead_n * along_e - ahead_e * along_n
                    ahead_m = (off_n * along_e - off_e * along_n) / turn if turn else 0.0
                    if 0.0 <= ahead_m < nearest:
                        nearest = ahead_m
        return nearest

    def is_near_way(self, start: Point, end: Point, within_m: float) -> bool:
        """Whether the line comes this near to a straight segment."""
        way = _side(start, end)
        south_m, north_m = (
            min(start.north_m, end.north_m) - within_m,
            max(start.north_m, end.north_m) + within_m,
        )
        west_m, east_m = min(start.east_m, end.east_m) - within_m, max(start.east_m, end.east_m) + within_m
        if self.south_m > north_m or self.north_m < south_m or self.west_m > east_m or self.east_m < west_m:
            return False
        limit = within_m * within_m
        for band in self._bands[self._band(south_m) : self._band(north_m) + 1]:
            for side in band:
                start_n, start_e, end_n, end_e, _, _, _ = side
                if (start_e < west_m and end_e < west_m) or (start_e > east_m and end_e > east_m):
                    continue
                if (start_n < south_m and end_n < south_m) or (start_n > north_m and end_n > north_m):
                    continue
                if (
                    _cross(side, way)
                    or _nearest_squared((way,), start_n, start_e, limit) < limit
                    or _nearest_squared((way,), end_n, end_e, limit) < limit
                    or _nearest_squared((side,), start.north_m, start.east_m, limit) < limit
                    or _nearest_squared((side,), end.north_m, end.east_m, limit) < limit
                ):
                    return True
        return False

    def nearest(self, north_m: float, east_m: float) -> Point:
        """The nearest point of the line."""
        best, found = math.inf, self.vertices[0]
        reach_m = self.distance_m(north_m, east_m) + _ROUNDING_M
        for band in self._bands[self._band(north_m - reach_m) : self._band(north_m + reach_m) + 1]:
            for start_n, start_e, _, _, along_n, along_e, inverse in band:
                share = ((north_m - start_n) * along_n + (east_m - start_e) * along_e) * inverse
                share = 0.0 if share < 0.0 else 1.0 if share > 1.0 else share
                n, e = start_n + share * along_n, start_e + share * along_e
                squared = (n - north_m) ** 2 + (e - east_m) ** 2
                if squared < best:
                    best, found = squared, Point(n, e)
        return found

    def _band(self, north_m: float) -> int:
        number = int((north_m - self.south_m) / self._band_m)
        return 0 if number < 0 else min(number, len(self._bands) - 1)


def _side(start: Point, end: Point) -> Side:
    north, east = end.north_m - start.north_m, end.east_m - start.east_m
    squared = north * north + east * east
    return *start, *end, north, east, 1.0 / squared if squared else 0.0


def _nearest_squared(sides: Sequence[Side], north_m: float, east_m: float, best: float) -> float:
    for start_n, start_e, _, _, along_n, along_e, inverse in sides:
        off_n, off_e = north_m - start_n, east_m - start_e
        share = (off_n * along_n + off_e * along_e) * inverse
        if share > 1.0:
            off_n, off_e = off_n - along_n, off_e - along_e
        elif share > 0.0:
            off_n, off_e = off_n - share * along_n, off_e - share * along_e
        squared = off_n * off_n + off_e * off_e
        if squared < best:  # noqa: PLR1730  min() takes three times as long, and this is asked a million times
            best = squared
    return best


def _cross(one: Side, other: Side) -> bool:
    """Whether two sides cross between their ends."""
    off_n, off_e = other[0] - one[0], other[1] - one[1]
    turn = one[4] * other[5] - one[5] * other[4]
    if turn == 0.0:
        return False
    along_one = (off_n * other[5] - off_e * other[4]) / turn
    along_other = (off_n * one[5] - off_e * one[4]) / turn
    return 0.0 <= along_one <= 1.0 and 0.0 <= along_other <= 1.0


class Disc:
    """A circle.

    Raises:
        ValueError: a radius that is not positive and finite.
    """

    def __init__(self, centre: Point, radius_m: float, is_inclusion: bool) -> None:
        if not 0.0 < radius_m < math.inf:
            raise ValueError(f"a disc of radius {radius_m:g} m: expected a positive number")
        self.centre = centre
        self.radius_m = radius_m
        self.is_inclusion = is_inclusion
        self.south_m, self.north_m = centre.north_m - radius_m, centre.north_m + radius_m
        self.west_m, self.east_m = centre.east_m - radius_m, centre.east_m + radius_m

    def contains(self, north_m: float, east_m: float) -> bool:
        """Whether a point is inside."""
        return math.hypot(north_m - self.centre.north_m, east_m - self.centre.east_m) < self.radius_m

    def distance_m(self, north_m: float, east_m: float, within_m: float = math.inf) -> float:
        """Distance to the line, at most within_m."""
        away_m = math.hypot(north_m - self.centre.north_m, east_m - self.centre.east_m)
        return min(within_m, abs(away_m - self.radius_m))

    def crossing_m(self, at: Point, ahead_n: float, ahead_e: float, reach_m: float) -> float:
        """Distance to the first crossing along a unit vector; reach_m without one."""
        off_n, off_e = self.centre.north_m - at.north_m, self.centre.east_m - at.east_m
        abeam_m = ahead_n * off_e - ahead_e * off_n  # where the way ahead passes the centre
        if abs(abeam_m) >= self.radius_m:
            return reach_m
        middle_m = ahead_n * off_n + ahead_e * off_e
        half_m = math.sqrt((self.radius_m - abeam_m) * (self.radius_m + abeam_m))
        entry_m, exit_m = middle_m - half_m, middle_m + half_m
        if entry_m >= 0.0:
            return min(entry_m, reach_m)
        return min(exit_m, reach_m) if exit_m >= 0.0 else reach_m

    def is_near_way(self, start: Point, end: Point, within_m: float) -> bool:
        """Whether the line comes this near to a straight segment."""
        way = _side(start, end)
        centre = self.centre
        nearest_m = math.sqrt(_nearest_squared((way,), centre.north_m, centre.east_m, math.inf))
        farthest_m = max(math.dist(centre, start), math.dist(centre, end))
        return nearest_m < self.radius_m + within_m and farthest_m > self.radius_m - within_m

    def nearest(self, north_m: float, east_m: float) -> Point:
        """The nearest point of the line; due north of the centre for the centre itself."""
        bearing = math.atan2(east_m - self.centre.east_m, north_m - self.centre.north_m)
        return self.centre.moved(bearing, self.radius_m)


Area = Ring | Disc
