"""How fast the boat may come to a corner where more corners follow closely."""

from collections.abc import Sequence

from companion.config import BoatConfig
from companion.geo import Line, Point
from companion.guidance.corner import SHARPEST_RAD, corner_between
from companion.guidance.speed_profile import corner_speed_m_s, leg_speed_m_s
from companion.units import wrap_pi


def onward_speed_m_s(
    line: Line, onward: Sequence[Point], radius_m: float, speed_m_s: float, config: BoatConfig
) -> float:
    """Speed over ground allowed at the beginning of a line, for what comes behind it.

    onward: the line's end and the corners after it. At each the boat must be down to the speed of its arc,
    and at the last, and where the way turns back, be able to stop.
    """
    allowed, way_m = speed_m_s, line.length_m
    for corner in onward[1:]:
        next_line = Line(line.end, corner)
        if abs(wrap_pi(next_line.course_rad - line.course_rad)) >= SHARPEST_RAD:
            break
        arc = corner_between(line, next_line, radius_m, config)
        if arc is not None:
            slow = corner_speed_m_s(arc.radius_m, config)
            allowed = min(allowed, leg_speed_m_s(speed_m_s, way_m - arc.entry_m, slow, config))
        way_m += next_line.length_m
        line = next_line
    return min(allowed, leg_speed_m_s(speed_m_s, way_m, 0.0, config))
