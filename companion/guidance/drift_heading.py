"""Where to let a boat drift that the water carries off faster than it sails.

It cannot stay, but it can choose its way: of all velocities over ground that it can have, set plus its own
speed one way or another, the one with the longest time before the fence.
"""

import math
from typing import Final

from companion.core.geo import Point
from companion.core.state import Demand, NavState
from companion.obstacles.planning.free_space import Bounds

_COURSES: Final = 24
_REACH_S: Final = 120.0  # what lies further off is no worry yet


def drift_demand(nav: NavState, bounds: Bounds, speed_m_s: float) -> Demand:
    """The heading, at speed_m_s through the water, that leads clear of lines for longest.

    The first of equals counts, beginning with the bow into the set.
    """
    current_n, current_e = nav.current_north_m_s, nav.current_east_m_s
    upstream = math.atan2(-current_e, -current_n)
    best, longest_s = upstream, -1.0
    here = Point(nav.north_m, nav.east_m)
    for number in range(_COURSES):
        heading = upstream + math.tau * ((number + 1) // 2) / _COURSES * (1.0 if number % 2 else -1.0)
        north_m_s = current_n + speed_m_s * math.cos(heading)
        east_m_s = current_e + speed_m_s * math.sin(heading)
        ground_m_s = math.hypot(north_m_s, east_m_s)
        reach_m = ground_m_s * _REACH_S
        room_s = (
            _REACH_S
            if ground_m_s < 1e-3
            else bounds.room_m(here, math.atan2(east_m_s, north_m_s), reach_m) / ground_m_s
        )
        if room_s > longest_s + 0.5:
            best, longest_s = heading, room_s
    along_m_s = current_n * math.cos(best) + current_e * math.sin(best)
    return Demand(math.remainder(best, math.tau), speed_m_s + along_m_s)
