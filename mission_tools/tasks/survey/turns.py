"""Turns between tracks for a boat that cannot turn on the spot.

The shortest path between two poses with a bounded turn radius is one of six words of turns to port (L), turns
to starboard (R) and a straight (S) (L. E. Dubins, "On curves of minimal length with a constraint on average
curvature", *American Journal of Mathematics* 79, 1957). Each is found from the circles that touch the poses.
"""

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from companion.core.geo import Point, bearing_rad, distance_m
from companion.core.units import wrap_pi
from mission_tools.tasks.task_route import TaskLeg

Array = NDArray[np.float64]
CHORD_RAD = math.radians(20.0)  # from waypoint to waypoint of a turn: 1.5 % of the radius inside the arc
_BACK_RAD = math.pi - 1e-3  # a sharper corner leads straight back


class Pose(NamedTuple):
    """A place and the course there."""

    place: Point
    course_rad: float


class Part(NamedTuple):
    """Of a turn: side +1 to starboard, -1 to port, 0 straight; its extent in radii, for an arc the angle."""

    side: int
    extent: float


def turn_length_m(across_m: Array, along_m: Array, radius_m: float) -> Array:
    """Of the turn from the end of a track into another that is sailed back, so far to the side and ahead.

    Closer than two radii, the boat first turns away (three arcs); farther off, it is two arcs and a straight.
    """
    if radius_m == 0.0:
        return np.asarray(np.hypot(across_m, along_m))
    away = np.arccos(np.clip((2.0 * radius_m + across_m) / (4.0 * radius_m), 0.0, 1.0))
    close_m = radius_m * (math.pi + 4.0 * away)
    wide_m = math.pi * radius_m + across_m - 2.0 * radius_m
    return np.asarray(np.where(across_m < 2.0 * radius_m, close_m, wide_m) + np.abs(along_m))


def with_turns(legs: Sequence[TaskLeg], water: BaseGeometry, radius_m: float) -> tuple[list[TaskLeg], int]:
    """The legs with every transit as a turn of this radius, and the number of those that are tighter.

    A transit whose corners the boat can round stays; another is replaced by the shortest turn that lies in
    the water. Where there is none, it stays and counts as tighter.
    """
    shapely.prepare(water)
    done, tighter = list(legs), 0
    for number in range(1, len(done) - 1):
        before, transit, after = done[number - 1 : number + 2]
        if transit.kind != "transit" or len(before.points) < 2 or len(after.points) < 2:
            continue
        if _can_round((before.points[-2], *transit.points, after.points[1]), radius_m):
            continue
        out = Pose(before.points[-1], bearing_rad(*before.points[-2:]))
        into = Pose(after.points[0], bearing_rad(*after.points[:2]))
        lines = (_drawn(out, parts, radius_m) for parts in turns(out, into, radius_m))
        turn = next((line for line in lines if water.covers(_line(line))), None)
        if turn is None:
            tighter += 1
        else:
            done[number] = TaskLeg("transit", (before.points[-1], *turn[1:-1], after.points[0]))
    return done, tighter


def turns(start: Pose, goal: Pose, radius_m: float) -> Iterator[tuple[Part, Part, Part]]:
    """The paths from one pose to another with turns of this radius, shortest first."""
    paths = []
    for first in (1, -1):
        for last in (1, -1):
            paths += list(_paths(start, goal, first, last, radius_m))
    yield from sorted(paths, key=lambda parts: sum(part.extent for part in parts))


def _paths(
    start: Pose, goal: Pose, first: int, last: int, radius_m: float
) -> Iterator[tuple[Part, Part, Part]]:
    """The paths that begin and end with turns to these sides."""
    one, other = _centre(start, first, radius_m), _centre(goal, last, radius_m)
    gap, axis_rad = distance_m(one, other) / radius_m, bearing_rad(one, other)
    if first == last:
        yield _path(start, goal, first, last, Part(0, gap), (axis_rad, axis_rad))
        if 0.0 < gap < 4.0:  # three arcs; the middle circle lies to either side of the axis
            for side in (1, -1):
                apex_rad = side * math.acos(0.25 * gap)
                leave = axis_rad + apex_rad + 0.5 * first * math.pi
                enter = axis_rad + math.pi - apex_rad + 0.5 * first * math.pi
                middle = Part(-first, (-first * (enter - leave)) % math.tau)
                yield _path(start, goal, first, last, middle, (leave, enter))
    elif gap >= 2.0:
        course = axis_rad + first * math.asin(2.0 / gap)
        yield _path(start, goal, first, last, Part(0, math.sqrt(gap * gap - 4.0)), (course, course))


def _path(
    start: Pose, goal: Pose, first: int, last: int, middle: Part, courses_rad: tuple[float, float]
) -> tuple[Part, Part, Part]:
    """Turns onto the middle part and off it, which begins and ends with these courses."""
    onto = (first * (courses_rad[0] - start.course_rad)) % math.tau
    off = (last * (goal.course_rad - courses_rad[1])) % math.tau
    return Part(first, _without_rounding(onto)), middle, Part(last, _without_rounding(off))


def _without_rounding(angle: float) -> float:
    """No turn rather than a whole one."""
    return 0.0 if angle > math.tau - 1e-9 else angle


def _centre(pose: Pose, side: int, radius_m: float) -> Point:
    """Of the circle that a boat at the pose turns on."""
    return pose.place.moved(pose.course_rad + 0.5 * side * math.pi, radius_m)


def _drawn(start: Pose, parts: Sequence[Part], radius_m: float) -> tuple[Point, ...]:
    """Points along a path, on its arcs CHORD_RAD apart at most."""
    points, pose = [start.place], start
    for side, extent in parts:
        if side == 0:
            pose = Pose(pose.place.moved(pose.course_rad, extent * radius_m), pose.course_rad)
            points.append(pose.place)
            continue
        steps = math.ceil(extent / CHORD_RAD)
        centre = _centre(pose, side, radius_m)
        for step in range(1, steps + 1):
            course = pose.course_rad + side * extent * step / steps
            points.append(_centre(Pose(centre, course), -side, radius_m))
        pose = Pose(points[-1], pose.course_rad + side * extent)
    return tuple(points)


def _can_round(points: Sequence[Point], radius_m: float) -> bool:
    """Whether an arc of the radius fits every corner; two corners share the leg between them."""
    for at in range(1, len(points) - 1):
        before, here, after = points[at - 1 : at + 2]
        turn = abs(wrap_pi(bearing_rad(here, after) - bearing_rad(before, here)))
        if turn > _BACK_RAD:
            return False
        before_m = distance_m(before, here) * (1.0 if at == 1 else 0.5)
        after_m = distance_m(here, after) * (1.0 if at == len(points) - 2 else 0.5)
        if radius_m * math.tan(0.5 * turn) > min(before_m, after_m) * (1.0 + 1e-9):
            return False
    return True


def _line(points: Sequence[Point]) -> shapely.LineString:
    return shapely.LineString([(point.east_m, point.north_m) for point in points])
