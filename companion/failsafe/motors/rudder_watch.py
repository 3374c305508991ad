"""Whether rudder and motor do what they are given, on a boat that a rudder steers."""

import math
from typing import Final

from companion.config.boat_config import BoatConfig
from companion.control.allocation import rudder_effect
from companion.core.state import NavState

# Of what rudder and flow can give, at most full steering: with less the helm may hold a course against wind
_HARD: Final = 0.8
# The emulator's rudder boat follows half of full steering with 0.2 rad/s or more within two seconds, and a
# rudder hard over at its slowest speed, a tenth of full steering, with 0.1 rad/s
_STEERED: Final = 0.05  # of full steering: with more, the boat turns,
_TURNS_RAD_S: Final = 0.05  # like this at least
_SMOOTH_S: Final = 1.0
# Half of full steering in vain for 5 s, or less for as much longer: more than servo, hull and a gust take
_HELPLESS_S: Final = 2.5
_AHEAD: Final = 0.3  # throttle that takes way off a boat going astern within two seconds
_ASTERN_M_S: Final = 0.15  # more than twice the receiver's noise
_REVERSED_S: Final = 5.0


class RudderWatch:
    """fault: what is wrong, in words; empty while rudder and motor steer the boat.

    A rudder that is stuck, lost or fouled makes the heading loop steer hard, and the boat does not turn, or
    turns the other way. So does one without wash. A boat with one motor that goes astern under throttle ahead
    has a reversed motor.
    """

    def __init__(self) -> None:
        self.fault = ""
        self.pause()

    def pause(self) -> None:
        """The motion says nothing for now. A fault stands."""
        self._steered = self._most = self._turn_rad_s = self._helpless_s = self._astern_s = 0.0

    def rearm(self) -> None:
        """Judge anew, without a fault."""
        self.fault = ""
        self.pause()

    def update(
        self, throttle: float, rudder: float, nav: NavState | None, config: BoatConfig, dt_s: float
    ) -> None:
        """Take the commands of the last dt_s and what has come of them."""
        if nav is None or not config.drive.has_rudder:
            self.rearm()
            return
        water_m_s = nav.water_speed_m_s
        effect = rudder_effect(throttle, water_m_s, config.drive, config.speed)
        blend = min(dt_s / _SMOOTH_S, 1.0)
        self._most += blend * (min(abs(effect), 1.0) - self._most)
        self._steered += blend * (min(max(rudder * effect, -1.0), 1.0) - self._steered)
        self._turn_rad_s += blend * (nav.measured_yaw_rate_rad_s - self._turn_rad_s)
        is_steered = abs(self._steered) > max(_HARD * self._most, _STEERED)
        is_turning = self._turn_rad_s * math.copysign(1.0, self._steered) >= _TURNS_RAD_S
        is_astern = not config.drive.has_pair and throttle > _AHEAD and nav.surge_m_s < -_ASTERN_M_S
        self._astern_s = self._astern_s + dt_s if is_astern else 0.0
        if self._astern_s >= _REVERSED_S:
            self.fault = "Steering lost: motor reversed"
        elif is_steered and is_turning and not is_astern:
            self.fault, self._helpless_s = "", 0.0
        elif is_astern:  # a rudder works the other way
            self._helpless_s = 0.0
        elif is_steered:
            self._helpless_s += abs(self._steered) * dt_s
            if self._helpless_s >= _HELPLESS_S:
                self.fault = "Steering lost: rudder or motor has no effect"
