"""Steering and sailing with one motor of two.

Thrust on one side turns the boat, and thrust astern that holds the heading pushes back as hard as thrust
ahead has pushed. But a skeg damps the turn of a boat under way far more than the turn of a boat at rest or
going astern. So the motor runs full ahead until the bow has swung past the heading, then full astern until it
has swung back past the other side, and the boat makes way. The lake boat makes 0.35 m/s of its 3 that way, at
any swing near a radian.
"""

import math
from typing import Final

from companion.core.state import Demand, MotorState, MotorStates, NavState
from companion.core.units import wrap_pi

SINGLE_THRUSTER_SPEED: Final = 0.12  # of top speed, made good with one motor
_SWING_RAD: Final = 0.8
_IDLE_M_S: Final = 0.05  # through the water: below this, the motor rests


class SingleThrusterController:
    """Keeps which way the bow is swinging."""

    def __init__(self) -> None:
        self._is_ahead = True

    def update(
        self, demand: Demand, nav: NavState, motors: MotorStates, max_throttle: float
    ) -> tuple[float, float]:
        """Surge and yaw effort that the working motor can give, for `allocate`. max_throttle: 0..1."""
        through_m_s = demand.speed_m_s - nav.current_along_m_s(demand.heading_rad)
        if abs(through_m_s) < _IDLE_M_S:
            return 0.0, 0.0
        is_left = motors.right is MotorState.FAILED
        wanted = demand.heading_rad if through_m_s > 0.0 else demand.heading_rad + math.pi
        past = wrap_pi(nav.heading_rad - wanted)
        if not is_left:
            past = -past  # the right motor ahead swings the bow to port
        if self._is_ahead and past > _SWING_RAD:
            self._is_ahead = False
        elif not self._is_ahead and past < -_SWING_RAD:
            self._is_ahead = True
        surge = 0.5 * (max_throttle if self._is_ahead else -max_throttle)
        return surge, surge if is_left else -surge
