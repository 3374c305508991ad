"""Steering and sailing with one motor of two.

Thrust on one side turns the boat, and thrust astern that holds the heading pushes back as hard as thrust
ahead has pushed. But a skeg damps the turn of a boat under way far more than the turn of a boat at rest or
going astern. So the motor runs full ahead until the bow has swung past the heading, then full astern until it
has swung back past the other side, and the boat makes way. The lake boat makes 0.35 m/s of its 3 that way, at
any swing near a radian.

The course over ground changes with every swing, and so does a demand that corrects it. Followed at once, it
delays the reversals until the boat turns in circles and makes no way. So the mean of the demand is held.
"""

import cmath
import math
from typing import Final

from companion.core.state import Demand, MotorState, MotorStates, NavState
from companion.core.units import wrap_pi

SINGLE_THRUSTER_SPEED: Final = 0.12  # of top speed, made good with one motor
_SWING_RAD: Final = 0.8
_IDLE_M_S: Final = 0.05  # through the water: below this, the motor rests
_MEAN_S: Final = 5.0  # a swing of the lake boat takes 16 s: what a demand follows of it is more than halved


class SingleThrusterController:
    """Keeps which way the bow is swinging, and the mean direction to go."""

    def __init__(self) -> None:
        self._is_ahead = True
        self._mean = 0j  # a vector, north + i east

    def update(
        self, demand: Demand, nav: NavState, motors: MotorStates, max_throttle: float, dt_s: float
    ) -> tuple[float, float]:
        """Surge and yaw effort that the working motor can give, for `allocate`. max_throttle: 0..1.

        dt_s: since the last call.
        """
        through_m_s = demand.speed_m_s - nav.current_along_m_s(demand.heading_rad)
        if abs(through_m_s) < _IDLE_M_S:
            self._mean = 0j
            return 0.0, 0.0
        is_left = motors.right is MotorState.FAILED
        wanted = cmath.rect(math.copysign(1.0, through_m_s), demand.heading_rad)
        self._mean += (1.0 - math.exp(-dt_s / _MEAN_S)) * (wanted - self._mean)
        past = wrap_pi(nav.heading_rad - cmath.phase(self._mean))
        if not is_left:
            past = -past  # the right motor ahead swings the bow to port
        if self._is_ahead and past > _SWING_RAD:
            self._is_ahead = False
        elif not self._is_ahead and past < -_SWING_RAD:
            self._is_ahead = True
        surge = 0.5 * (max_throttle if self._is_ahead else -max_throttle)
        return surge, surge if is_left else -surge
