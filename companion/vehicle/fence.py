"""The fence: where the boat may be, and how far it is to the line.

The allowed water is inside every inclusion area and outside every exclusion area, as in ArduPilot; where the
setting asks for it, also inside a circle round home. The areas come as places on the globe and are laid into
the local frame once. Far from every line a question costs one distance: the margin found last, less the way
made since, is a bound.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from companion.geo import LatLon, LocalFrame, Point
from companion.settings.fence import AREAS_KIND, CIRCLE_KIND, FenceSetting
from companion.vehicle.fence_lines import Area, Disc, Ring


@dataclass(frozen=True, slots=True)
class FencePolygon:
    """A polygon as it was uploaded, three or more vertices."""

    vertices: tuple[LatLon, ...]
    is_inclusion: bool


@dataclass(frozen=True, slots=True)
class FenceCircle:
    """A circle as it was uploaded."""

    centre: LatLon
    radius_m: float
    is_inclusion: bool


FenceArea = FencePolygon | FenceCircle


class Fence:
    """is_active: whether there is any line that counts; without one, every question is answered at once.

    version grows whenever the lines change.
    """

    __slots__ = (
        "_anchor_e",
        "_anchor_m",
        "_anchor_n",
        "_frame",
        "_home",
        "_laid",
        "_setting",
        "_uploaded",
        "areas",
        "is_active",
        "version",
    )

    def __init__(self) -> None:
        self.areas: tuple[Area, ...] = ()
        self.is_active = False
        self.version = 0
        self._uploaded: tuple[FenceArea, ...] = ()
        self._laid: tuple[FenceArea, ...] | None = None
        self._frame: LocalFrame | None = None
        self._home: LatLon | None = None
        self._setting: FenceSetting | None = None
        self._anchor_n = self._anchor_e = math.nan
        self._anchor_m = math.nan  # the margin there

    @property
    def uploaded(self) -> tuple[FenceArea, ...]:
        """As the stations have it."""
        return self._uploaded

    def take(self, areas: Sequence[FenceArea]) -> None:
        """Replace the uploaded areas; they count from the next `lay` on."""
        self._uploaded = tuple(areas)

    def lay(self, frame: LocalFrame | None, home: LatLon | None, setting: FenceSetting) -> None:
        """Bring the lines up to date. Costs nothing unless something has changed."""
        if (
            self._laid is self._uploaded
            and self._frame is frame
            and self._setting is setting
            and (self._home is home or not setting.kinds & CIRCLE_KIND)
        ):
            return
        self._laid, self._frame, self._setting, self._home = self._uploaded, frame, setting, home
        areas: list[Area] = []
        if frame is not None and setting.enabled:
            if setting.kinds & AREAS_KIND:
                areas += [_laid(area, frame) for area in self._uploaded]
            if setting.kinds & CIRCLE_KIND and home is not None:
                areas.append(Disc(frame.to_local(home), setting.radius_m, is_inclusion=True))
        self.areas = tuple(areas)
        self.is_active = bool(areas)
        self.version += 1
        self._anchor_n = math.nan

    def margin_m(self, point: Point) -> float:
        """Signed distance to the nearest line, positive in the allowed water; infinite without a fence.

        Outside, it is how far the boat is beyond the line that it is furthest beyond.
        """
        north_m, east_m = point
        beyond, nearest = -1.0, math.inf
        for area in self.areas:
            if area.contains(north_m, east_m) is not area.is_inclusion:
                beyond = max(beyond, area.distance_m(north_m, east_m))
            elif beyond < 0.0 and _may_be_within(area, north_m, east_m, nearest):
                nearest = area.distance_m(north_m, east_m, nearest)
        margin_m = nearest if beyond < 0.0 else -beyond
        self._anchor_n, self._anchor_e, self._anchor_m = north_m, east_m, margin_m
        return margin_m

    def is_outside(self, point: Point) -> bool:
        """Whether the boat is beyond a line."""
        if not self.is_active:
            return False
        way_m = math.hypot(point.north_m - self._anchor_n, point.east_m - self._anchor_e)
        if way_m < abs(self._anchor_m):
            return self._anchor_m < 0.0
        return self.margin_m(point) < 0.0

    def is_within(self, point: Point, reach_m: float) -> bool:
        """Whether some line is nearer than reach_m; outside always."""
        if not self.is_active:
            return False
        way_m = math.hypot(point.north_m - self._anchor_n, point.east_m - self._anchor_e)
        if self._anchor_m - way_m >= reach_m:  # never so while the anchor is not a number
            return False
        return self.margin_m(point) < reach_m

    def room_m(self, point: Point, course_rad: float, reach_m: float) -> float:
        """How far one can go along a course before the line, at most reach_m.

        Outside there is no line to stop at any more: the room is reach_m whichever way.
        """
        if not self.is_within(point, reach_m) or self.is_outside(point):
            return reach_m
        ahead_n, ahead_e = math.cos(course_rad), math.sin(course_rad)
        room_m = reach_m
        for area in self.areas:
            if _may_be_within(area, point.north_m, point.east_m, room_m):
                room_m = area.crossing_m(point, ahead_n, ahead_e, room_m)
        return room_m

    def crosses(self, start: Point, end: Point) -> bool:
        """Whether the straight way between two points of the allowed water leaves it."""
        north, east = end.north_m - start.north_m, end.east_m - start.east_m
        length_m = math.hypot(north, east)
        if length_m == 0.0:
            return False
        ahead_n, ahead_e = north / length_m, east / length_m
        return any(area.crossing_m(start, ahead_n, ahead_e, length_m) < length_m for area in self.areas)


def _may_be_within(area: Area, north_m: float, east_m: float, reach_m: float) -> bool:
    """Whether an area's box is so near that its line may be."""
    return (
        area.south_m - reach_m < north_m < area.north_m + reach_m
        and area.west_m - reach_m < east_m < area.east_m + reach_m
    )


def _laid(area: FenceArea, frame: LocalFrame) -> Area:
    if isinstance(area, FenceCircle):
        return Disc(frame.to_local(area.centre), area.radius_m, area.is_inclusion)
    return Ring([frame.to_local(vertex) for vertex in area.vertices], area.is_inclusion)
