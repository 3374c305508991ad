"""Steering and sailing with one motor of two.

Thrust on one side turns the boat, and what holds the heading by thrust astern pushes back as hard as it has
pushed ahead. But a skeg damps the turn of a boat under way far more than the turn of one that stands or makes
sternway: so by turns full ahead until the bow has swung past the heading, and full astern until it has swung
back past the other side, leaves something over. The lake boat makes 0.35 m/s of its 3 that way, and a little
more or less than a radian of swing changes nothing.
"""

import math
from typing import Final

from companion.core.state import Demand, NavState, Thrust
from companion.core.units import wrap_pi

LAME_SHARE: Final = 0.12  # of top speed is what one motor makes good
_SWING_RAD: Final = 0.8
_IDLE_M_S: Final = 0.05  # through the water: who asks for less wants to rest
_NO_THRUST = Thrust(0.0, 0.0)


class LameHelm:
    """Remembers only which way the bow is swinging."""

    __slots__ = ("_is_ahead",)

    def __init__(self) -> None:
        self._is_ahead = True

    def update(self, demand: Demand, nav: NavState, *, is_left: bool, most: float) -> Thrust:
        """Thrust for this tick. is_left: which motor is left. most: of its command, 0..1."""
        through_m_s = demand.speed_m_s - nav.current_along_m_s(demand.heading_rad)
        if abs(through_m_s) < _IDLE_M_S:
            return _NO_THRUST
        wanted = demand.heading_rad if through_m_s > 0.0 else demand.heading_rad + math.pi
        past = wrap_pi(nav.heading_rad - wanted)
        if not is_left:
            past = -past  # the right motor ahead swings the bow to port
        if self._is_ahead and past > _SWING_RAD:
            self._is_ahead = False
        elif not self._is_ahead and past < -_SWING_RAD:
            self._is_ahead = True
        thrust = most if self._is_ahead else -most
        return Thrust(thrust, 0.0) if is_left else Thrust(0.0, thrust)
