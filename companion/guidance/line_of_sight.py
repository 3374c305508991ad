"""Line-of-sight guidance along a straight leg.

The proportional law of T. I. Fossen, *Handbook of Marine Craft Hydrodynamics and Motion Control*, 2nd ed.
2021, (12.78) and (12.79), gives the course over ground; `course_to_steer.py` turns it into a heading with the
estimated current, and says why there is no integral of the cross-track error.
"""

import math

from companion.config.tuning import Guidance
from companion.core.units import clamp

LOOKAHEAD_SPAN = (0.5, 1.5)  # of the configured lookahead, over speed
RESTRAINED = 4.0  # times as far ahead: waves carry the boat off the line and back, by their height and more


def lookahead_m(speed_m_s: float, cruise_m_s: float, setting: Guidance, restraint: float = 0.0) -> float:
    """Lookahead distance: the configured one at cruise speed, proportional to speed within LOOKAHEAD_SPAN.

    The time to halve an offset, about 0.7 · lookahead / speed, then keeps its ratio to the heading loop's
    time constant at every speed. restraint: of RESTRAINED.
    """
    low, high = LOOKAHEAD_SPAN
    ahead_m = setting.lookahead_m * clamp(speed_m_s / cruise_m_s, low, high)
    return ahead_m * (1.0 + (RESTRAINED - 1.0) * restraint)


def desired_course_rad(
    leg_rad: float, cross_track_m: float, cross_speed_m_s: float, ahead_m: float, response_s: float
) -> float:
    """Course over ground that closes on the leg: (12.78) with Kp = 1/lookahead (12.79). Not wrapped.

    Cross-track error and its rate are positive to starboard. The error is predicted by response_s, which
    damps the approach and has no effect on the leg.
    """
    return leg_rad - math.atan((cross_track_m + response_s * cross_speed_m_s) / ahead_m)
