"""Straightens close waypoints: the shortest line that passes near each of them in turn.

Each waypoint has a portal, a short line across the path through it. The result is the shortest line through
all portals in order, by the funnel algorithm (D. T. Lee and F. P. Preparata, "Euclidean shortest paths in
the presence of rectilinear barriers", *Networks* 14, 1984). Zigzags along the cells of a grid become
straight. The line is nowhere further from the plan than half a portal's width.
"""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

from companion.core.geo import Line, Point, bearing_rad, distance_m
from companion.core.units import wrap_pi

SHIFT_SHARE = 0.45  # of a waypoint's radius: half the width of its portal, unless portals would meet
SHORT_RADII = 3.0  # waypoint radii: legs up to this length are short
SHARP_RAD = math.radians(100.0)  # a waypoint with a sharper turn is passed exactly
GENTLE_RAD = math.radians(30.0)  # so is one with a smaller turn in a steady bend
STRAIGHT_RAD = math.radians(3.0)
BACK_SHARE = 0.5  # of a waypoint's radius: one that is reached and left again this near to another, or this
END_SHARE = 0.95  # near to the first place, is passed there; as is the last but one, this near to the last
_LEVEL_M2 = 1e-12


class Portal(NamedTuple):
    """Port and starboard end; equal where the line must pass the waypoint exactly."""

    port: Point
    starboard: Point


def straighten(places: Sequence[Point], radii_m: Sequence[float]) -> list[tuple[Point, int]]:
    """Corners of the line from the first place to the last, each with the place whose portal it is on.

    radii_m: how near to pass the places. A place is passed exactly where either leg is not short, the way
    turns sharply, or it bends gently; and is left out where the way only turns back there, near another.
    """
    kept = _kept(places, radii_m)
    legs = [Line(places[one], places[other]) for one, other in pairwise(kept)]
    turns = [wrap_pi(leg.course_rad - before.course_rad) for before, leg in pairwise(legs)]
    portals = []
    for n, turn in enumerate(turns):
        around = (turns[n - 1] if n else 0.0, turns[n + 1] if n + 1 < len(turns) else 0.0)
        portals.append(_portal(legs[n], legs[n + 1], turn, around, radii_m[kept[n + 1]]))
    last = places[kept[-1]]
    corners = _pull(places[0], [*portals, Portal(last, last)])
    return [(places[0], 0), *((point, kept[1 + portal]) for point, portal in corners)]


def is_short(leg_m: float, radius_m: float) -> bool:
    """Whether a leg is too short for a corner at its end."""
    return leg_m <= SHORT_RADII * radius_m


def _kept(places: Sequence[Point], radii_m: Sequence[float]) -> list[int]:
    """The places that the line must pass."""
    kept, last = [0], len(places) - 1
    for n in range(1, last):
        before, at, after = places[kept[-1]], places[n], places[n + 1]
        turn = abs(wrap_pi(bearing_rad(at, after) - bearing_rad(before, at)))
        near_m = (BACK_SHARE if kept[-1] else END_SHARE) * radii_m[n]
        if before != at and (turn <= SHARP_RAD or distance_m(before, at) > near_m):
            kept.append(n)
    if kept[-1] == last - 1 > 0 and distance_m(places[-2], places[-1]) <= END_SHARE * radii_m[-2]:
        kept.pop()
    return [*kept, last]


def _portal(leg: Line, next_leg: Line, turn: float, around: tuple[float, float], radius_m: float) -> Portal:
    """The portal between two legs. turn: there; around: turns at the waypoints before and after it."""
    at, size = leg.end, abs(turn)
    goes_on = turn * around[0] > -STRAIGHT_RAD * size and turn * around[1] > -STRAIGHT_RAD * size
    is_bend = STRAIGHT_RAD < size < GENTLE_RAD and goes_on
    if is_bend or size > SHARP_RAD or not is_short(max(leg.length_m, next_leg.length_m), radius_m):
        return Portal(at, at)
    half_m = min(SHIFT_SHARE * radius_m, 0.5 * min(leg.length_m, next_leg.length_m))
    across = leg.course_rad + 0.5 * turn + 0.5 * math.pi
    north, east = half_m * math.cos(across), half_m * math.sin(across)
    return Portal(Point(at.north_m - north, at.east_m - east), Point(at.north_m + north, at.east_m + east))


def _pull(start: Point, portals: Sequence[Portal]) -> list[tuple[Point, int]]:
    """The corners of the shortest line through the portals, each with its portal."""
    corners: list[tuple[Point, int]] = []
    apex = port = starboard = start
    port_at = starboard_at = at = 0
    while at < len(portals):
        portal = portals[at]
        corner = -1
        if _side_m2(apex, starboard, portal.starboard) <= _LEVEL_M2:
            if starboard == apex or _side_m2(apex, port, portal.starboard) > 0.0:
                starboard, starboard_at = portal.starboard, at
            else:
                apex, corner = port, port_at
        if corner < 0 and _side_m2(apex, port, portal.port) >= -_LEVEL_M2:
            if port == apex or _side_m2(apex, starboard, portal.port) < 0.0:
                port, port_at = portal.port, at
            else:
                apex, corner = starboard, starboard_at
        if corner >= 0:
            corners.append((apex, corner))
            port = starboard = apex
            port_at = starboard_at = corner
            at = corner
        at += 1
    end = portals[-1].port
    if not corners or corners[-1][0] != end:
        corners.append((end, len(portals) - 1))
    return corners


def _side_m2(start: Point, end: Point, at: Point) -> float:
    """Twice the triangle's area, positive if `at` lies to starboard of the line from start to end."""
    north, east = end.north_m - start.north_m, end.east_m - start.east_m
    return north * (at.east_m - start.east_m) - east * (at.north_m - start.north_m)
