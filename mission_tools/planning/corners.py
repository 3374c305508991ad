"""Corners with room to round them.

A taut string touches every headland at just the clearance, and a boat does not turn on the spot: it rounds a
corner on the inside, where the headland is. So each corner is moved outwards by what the turn cuts off.
"""

import math
from collections.abc import Sequence

from companion.core.geo import Point, bearing_rad, path_length_m
from companion.core.units import wrap_pi
from mission_tools.planning.smooth import IsClear

CORNER_CLEARANCES = 0.5
"""Assumed start of a turn before a waypoint: with 4 m of clearance, 2 m."""
_SHARES = (1.0, 0.5, 0.25)  # of the way outwards, tried in turn where there is little room


def corner_cut_m(turn_rad: float, radius_m: float) -> float:
    """How far inside a corner the arc passes that leaves one leg, and joins the next, radius_m from it.

    The arc has the radius r = radius_m / tan(|turn|/2) and passes the corner at r (1/cos(|turn|/2) − 1),
    which is radius_m · tan(|turn|/4).
    """
    return radius_m * math.tan(0.25 * min(abs(turn_rad), math.pi))


def widen_corners(
    path: Sequence[Point], is_clear: IsClear, radius_m: float, max_length_m: float
) -> tuple[Point, ...]:
    """Move each corner outwards by what a turn of this radius cuts off, as far as there is room.

    radius_m: how near to a waypoint the vehicle begins its turn. Both legs of a moved corner are clear, the
    ends stay, and the path never becomes longer than max_length_m.
    """
    points = list(path)
    for i in range(1, len(points) - 1):
        before, here, after = points[i - 1 : i + 2]
        turn_rad = wrap_pi(bearing_rad(here, after) - bearing_rad(before, here))
        # Outwards is away from the side that the path turns to, square to the corner's middle direction.
        side = -math.copysign(0.5 * math.pi, turn_rad)
        outwards_rad = bearing_rad(before, here) + 0.5 * turn_rad + side
        for share in _SHARES:
            cut_m = share * corner_cut_m(turn_rad, radius_m)
            moved = Point(
                here.north_m + cut_m * math.cos(outwards_rad), here.east_m + cut_m * math.sin(outwards_rad)
            )
            wider = [*points[:i], moved, *points[i + 1 :]]
            if is_clear(before, moved) and is_clear(moved, after) and path_length_m(wider) <= max_length_m:
                points = wider
                break
    return tuple(points)
