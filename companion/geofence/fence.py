"""The fence: where the boat may be, and the distance to its lines.

Allowed water is inside every inclusion area and outside every exclusion area, as in ArduPilot, and optionally
inside a circle around home. The areas are projected into the local frame once. Far from every line a query
costs one distance: the last margin less the distance moved since is a bound.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from companion.config.tuning import AREAS_KIND, CIRCLE_KIND, FenceSetting, MotorLimits
from companion.core.geo import LatLon, LocalFrame, Point, distance_m
from companion.core.state import NavState, lacks_position
from companion.planning.areas import Area, Disc, Ring

_PROJECTIONS = 20
_SLACK_M = 1e-3
_ON_LINE_M = 1e-6
_ANCHORED_M = 1.0  # within this distance the last margin is not computed again
_REACH_M = 20_000.0  # as far as the local frame is accurate
_STEP_M = 0.5  # ahead, to test whether a course leads back


@dataclass(frozen=True, slots=True)
class FencePolygon:
    """An uploaded polygon with three or more vertices."""

    vertices: tuple[LatLon, ...]
    is_inclusion: bool


@dataclass(frozen=True, slots=True)
class FenceCircle:
    """An uploaded circle."""

    centre: LatLon
    radius_m: float
    is_inclusion: bool


FenceArea = FencePolygon | FenceCircle


class Fence:
    """is_active: whether there is any line. version changes with the lines. uploaded: the uploaded areas."""

    def __init__(self) -> None:
        self.areas: tuple[Area, ...] = ()
        self.is_active = False
        self.version = 0
        self._is_chart = False  # some uploaded area is an inclusion
        self.uploaded: tuple[FenceArea, ...] = ()
        self._placed: tuple[FenceArea, ...] | None = None
        self._frame: LocalFrame | None = None
        self._home: LatLon | None = None
        self._setting: FenceSetting | None = None
        self._anchor_n = self._anchor_e = self._anchor_m = math.nan  # a place, and the margin there

    def set_areas(self, areas: Sequence[FenceArea]) -> None:
        """Replace the uploaded areas; effective at the next `update`."""
        self.uploaded = tuple(areas)

    def update(self, frame: LocalFrame | None, home: LatLon | None, setting: FenceSetting) -> None:
        """Project the lines into the local frame if anything has changed."""
        if (
            self._placed is self.uploaded
            and self._frame is frame
            and self._setting is setting
            and (self._home is home or not setting.kinds & CIRCLE_KIND)
        ):
            return
        self._placed, self._frame, self._setting, self._home = self.uploaded, frame, setting, home
        areas: list[Area] = []
        self._is_chart = False
        if frame is not None and setting.enabled:
            if setting.kinds & AREAS_KIND:
                areas += [_to_lines(area, frame) for area in self.uploaded]
                self._is_chart = any(area.is_inclusion for area in areas)
            if setting.kinds & CIRCLE_KIND and home is not None:
                areas.append(Disc(frame.to_local(home), setting.radius_m, is_inclusion=True))
        self.areas = tuple(areas)
        self.is_active = bool(areas)
        self.version += 1
        self._anchor_n = math.nan

    def margin_m(self, point: Point) -> float:
        """Signed distance to the nearest line, positive in the allowed water; infinite without a fence.

        Outside, the distance beyond the line that was exceeded most.
        """
        return self._anchor(point, math.inf)

    def _anchor(self, point: Point, limit_m: float) -> float:
        """The margin, remembered with its place."""
        margin_m = self.margin_within_m(*point, limit_m)
        self._anchor_n, self._anchor_e, self._anchor_m = point.north_m, point.east_m, margin_m
        return margin_m

    def allows(self, point: Point) -> bool:
        """Whether a place is in the allowed water."""
        north_m, east_m = point
        return all(area.contains(north_m, east_m) is area.is_inclusion for area in self.areas)

    def inside(self, point: Point, margin_m: float) -> Point:
        """The nearest place with this margin, or with the largest margin found; the point itself if it has
        it, or if the fence is out of reach.

        Project away from the tightest line, then from the next (the method of successive projection, L. M.
        Bregman, Soviet Mathematics 6, 1965). The result is the nearest place for a single line, and close to
        it in a corner.
        """
        best, most = point, self.margin_within_m(point.north_m, point.east_m)
        at = point
        for _ in range(_PROJECTIONS if self.is_active else 0):
            if most >= margin_m:
                break
            at = _moved_inside(self._tightest(at), at, margin_m + _SLACK_M)
            if (found := self.margin_within_m(at.north_m, at.east_m)) > most:
                best, most = at, found
        return best if distance_m(point, best) <= _REACH_M else point

    def _tightest(self, point: Point) -> Area:
        """The area with the least margin."""
        tightest, least = self.areas[0], math.inf
        for area in self.areas:
            distance_m = area.distance_m(point.north_m, point.east_m)
            inside = area.contains(point.north_m, point.east_m) is area.is_inclusion
            if (signed := distance_m if inside else -distance_m) < least:
                tightest, least = area, signed
        return tightest

    def margin_within_m(self, north_m: float, east_m: float, limit_m: float = math.inf) -> float:
        """As `margin_m`, limited to ±limit_m; nothing is remembered."""
        beyond, nearest = -1.0, limit_m
        for area in self.areas:
            if not area.is_inclusion and not _may_be_within(area, north_m, east_m, nearest):
                continue
            if area.contains(north_m, east_m) is not area.is_inclusion:
                beyond = max(beyond, area.distance_m(north_m, east_m, limit_m))
            elif beyond < 0.0 and _may_be_within(area, north_m, east_m, nearest):
                nearest = area.distance_m(north_m, east_m, nearest)
        return nearest if beyond < 0.0 else -beyond

    def is_outside(self, point: Point) -> bool:
        """Whether the boat is outside."""
        if not self.is_active:
            return False
        way_m = math.hypot(point.north_m - self._anchor_n, point.east_m - self._anchor_e)
        if way_m < abs(self._anchor_m):
            return self._anchor_m < 0.0
        return not self.allows(point)

    def is_charted(self, point: Point) -> bool:
        """Whether a place is inside an uploaded inclusion area, whose owner knows the water."""
        return self._is_chart and not self.is_outside(point)

    def is_near(self, point: Point, reach_m: float) -> bool:
        """Whether a line may be within reach_m. Never a false negative, seldom a false positive."""
        if not self.is_active:
            return False
        way_m = math.hypot(point.north_m - self._anchor_n, point.east_m - self._anchor_e)
        if self._anchor_m - way_m >= reach_m:  # never true while the anchor is NaN
            return False
        if way_m < _ANCHORED_M:
            return True
        return self._anchor(point, 2.0 * reach_m + _ANCHORED_M) < reach_m

    def room_m(self, point: Point, course_rad: float, reach_m: float) -> float:
        """Distance along a course to the line, at most reach_m.

        Outside: reach_m on a course that leads towards the allowed water, else 0.
        """
        if not self.is_near(point, reach_m):
            return reach_m
        ahead_n, ahead_e = math.cos(course_rad), math.sin(course_rad)
        if self.is_outside(point):
            ahead_m = self.margin_within_m(
                point.north_m + _STEP_M * ahead_n, point.east_m + _STEP_M * ahead_e
            )
            return reach_m if ahead_m > self.margin_m(point) else 0.0
        room_m = reach_m
        for area in self.areas:
            if _may_be_within(area, point.north_m, point.east_m, room_m):
                room_m = area.crossing_m(point, ahead_n, ahead_e, room_m)
        return room_m

    def is_clear(self, start: Point, end: Point, margin_m: float) -> bool:
        """Whether a straight segment keeps this margin from every line, from either side."""
        return not any(area.is_near_way(start, end, margin_m) for area in self.areas)

    def crosses(self, start: Point, end: Point) -> bool:
        """Whether a straight segment between two points of the allowed water leaves it."""
        north, east = end.north_m - start.north_m, end.east_m - start.east_m
        length_m = math.hypot(north, east)
        if length_m == 0.0:
            return False
        ahead_n, ahead_e = north / length_m, east / length_m
        return any(area.crossing_m(start, ahead_n, ahead_e, length_m) < length_m for area in self.areas)


def _moved_inside(area: Area, at: Point, margin_m: float) -> Point:
    """Move straight from the nearest point of the line into the allowed water."""
    line = area.nearest(at.north_m, at.east_m)
    north, east = at.north_m - line.north_m, at.east_m - line.east_m
    away_m = math.hypot(north, east)
    if away_m < _ON_LINE_M:  # the direction to the inside is undefined
        bearings = [math.pi * eighth / 4.0 for eighth in range(8)]
        around = [at.moved(bearing, _SLACK_M) for bearing in bearings]
        insides = [near for near in around if area.contains(near.north_m, near.east_m) is area.is_inclusion]
        return max(insides, key=lambda near: area.distance_m(near.north_m, near.east_m), default=at)
    side = margin_m if area.contains(at.north_m, at.east_m) is area.is_inclusion else -margin_m
    return Point(line.north_m + side * north / away_m, line.east_m + side * east / away_m)


def _may_be_within(area: Area, north_m: float, east_m: float, reach_m: float) -> bool:
    """Whether the bounding box of an area is within reach."""
    return (
        area.south_m - reach_m < north_m < area.north_m + reach_m
        and area.west_m - reach_m < east_m < area.east_m + reach_m
    )


def _to_lines(area: FenceArea, frame: LocalFrame) -> Area:
    if isinstance(area, FenceCircle):
        return Disc(frame.to_local(area.centre), area.radius_m, area.is_inclusion)
    return Ring([frame.to_local(vertex) for vertex in area.vertices], area.is_inclusion)


class FenceMonitor:
    """beyond_m: distance outside, 0 inside. breaches: number since boot, the last at breached_s.

    Without a position the last state is kept.
    """

    def __init__(self) -> None:
        self.is_active = False
        self.beyond_m = 0.0
        self.breaches = 0
        self.breached_s = 0.0

    @property
    def is_outside(self) -> bool:
        """Whether the boat is outside."""
        return self.beyond_m > 0.0

    def update(self, fence: Fence, nav: NavState | None, setting: MotorLimits, now_s: float) -> None:
        """Evaluate one tick."""
        self.is_active = fence.is_active
        if not fence.is_active:
            self.beyond_m = 0.0
        elif nav is not None and not lacks_position(nav, setting.estimate_timeout_s):
            was_outside = self.beyond_m > 0.0
            self.beyond_m = max(-fence.margin_m(nav.point), 0.0) if fence.is_outside(nav.point) else 0.0
            if self.beyond_m > 0.0 and not was_outside:
                self.breaches += 1
                self.breached_s = now_s
