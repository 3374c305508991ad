"""A route as a mission that obeys speed limits: a waypoint and a speed where a zone begins or ends."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import shapely

from companion.core.geo import LocalFrame, Point
from mission_tools.costs.travel import SpeedZone
from mission_tools.errors import UsageError
from mission_tools.mission.mission import Mission, MissionItem, speed_item

_LEAST_M = 0.5  # a shorter piece of a leg, where a zone is only touched, is not worth a waypoint


def mission_in_zones(
    frame: LocalFrame, points: Sequence[Point], zones: Sequence[SpeedZone], speed_m_s: float | None
) -> Mission | None:
    """The mission along a route, start first; None if the route enters no zone that is slower. Raises
    UsageError: it does, and no speed says how fast the boat is elsewhere.
    """
    pieces = [piece for a, b in pairwise(points) for piece in _pieces(a, b, zones)]
    slow = [limit for _, limit in pieces if limit is not None and (speed_m_s is None or limit < speed_m_s)]
    if not slow:
        return None
    if speed_m_s is None:
        raise UsageError(
            f"the route enters a zone of at most {min(slow):g} m/s: add --speed, to go on with outside of it"
        )
    items: list[MissionItem] = []
    present: float | None = None
    for end, limit in pieces:
        speed = speed_m_s if limit is None else min(limit, speed_m_s)
        if speed != present:
            items.append(speed_item(speed))
            present = speed
        items.append(MissionItem.at(frame.to_global(end)))
    return Mission(tuple(items), home=frame.to_global(points[0]))


def _pieces(start: Point, end: Point, zones: Sequence[SpeedZone]) -> list[tuple[Point, float | None]]:
    """The ends of a leg's pieces, and the lowest limit on each; None outside of every zone."""
    leg = shapely.LineString([(start.east_m, start.north_m), (end.east_m, end.north_m)])
    length = leg.length
    cuts = {0.0, length}
    for zone in zones:
        met = shapely.get_coordinates(leg.intersection(zone.area.boundary))
        cuts |= {float(leg.project(shapely.Point(at))) for at in met}
    marks = [0.0]
    for cut in sorted(cuts):
        if cut - marks[-1] >= _LEAST_M and (length - cut >= _LEAST_M or cut == length):
            marks.append(cut)
    if marks[-1] != length:
        marks[-1:] = [length] if len(marks) > 1 else [0.0, length]
    pieces: list[tuple[Point, float | None]] = []
    for a, b in pairwise(marks):
        middle = leg.interpolate(0.5 * (a + b))
        limits = [zone.limit_m_s for zone in zones if zone.area.contains(middle)]
        limit = min(limits, default=None)
        at = np.array(leg.interpolate(b).coords[0])
        place = end if b == length else Point(float(at[1]), float(at[0]))
        if pieces and pieces[-1][1] == limit:
            pieces[-1] = (place, limit)
        else:
            pieces.append((place, limit))
    return pieces
