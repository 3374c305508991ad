"""Line-of-sight guidance along a straight leg.

The proportional law of T. I. Fossen, *Handbook of Marine Craft Hydrodynamics and Motion Control*, 2nd ed.
2021, (12.78) and (12.79), gives the course over ground; a crab angle as in (12.106), computed from the
set that the estimator knows (`course_to_steer.py`), turns it into a heading.

Why the crab angle and not an integral of the cross-track error (12.108): the drift shows in satellite
velocity and compass within seconds and stays true through a corner, while an integral must learn it anew on
every leg and overshoots while it does. The compass's own offset looks like a drift that turns with the
boat, so it leaves no steady cross-track error either.
"""

import math

from companion.config.boat_config import Guidance
from companion.core.units import clamp

RESPONSE_S = 0.7  # hull and heading loop answer about this late
LOOKAHEAD_SPAN = (0.5, 1.5)  # of the configured lookahead, over speed


def lookahead_m(speed_m_s: float, cruise_m_s: float, setting: Guidance) -> float:
    """Lookahead distance: the configured one at cruise speed, in proportion to speed within LOOKAHEAD_SPAN.

    The time to close half of an offset, about 0.7 · lookahead / speed, then stays as far from the heading
    loop's own time at every speed.
    """
    low, high = LOOKAHEAD_SPAN
    return setting.lookahead_m * clamp(speed_m_s / cruise_m_s, low, high)


def desired_course_rad(
    leg_rad: float,
    cross_track_m: float,
    cross_speed_m_s: float,
    ahead_m: float,
    response_s: float = RESPONSE_S,
) -> float:
    """Course over ground that closes on the leg: (12.78) with Kp = 1/lookahead (12.79). Not wrapped.

    Both cross-track error and its rate are positive to starboard of the leg. The error is the one that the
    boat will have response_s from now: that damps the approach, and makes no difference once the boat lies
    on the leg.
    """
    return leg_rad - math.atan((cross_track_m + response_s * cross_speed_m_s) / ahead_m)
