"""Whether the rudder steers the boat."""

import math
from typing import Final

from companion.config.boat_config import BoatConfig
from companion.control.allocation import rudder_effect
from companion.core.state import NavState

# The rudder boat of the emulator follows half of full steering with 0.2 rad/s or more within two seconds.
_STEERED: Final = 0.5  # of full steering: with more, the boat turns,
_TURNS_RAD_S: Final = 0.05  # like this at least
_SMOOTH_S: Final = 1.0
_HELPLESS_S: Final = 5.0  # hard over in vain: longer than the servo, the hull and a gust take


class RudderWatch:
    """fault: what is wrong with the rudder, in words; empty while it steers the boat.

    A rudder that is stuck, lost or fouled makes the heading loop steer hard, and the boat does not turn, or
    turns the other way. Slow boats are not judged: there the rudder has too little moment.
    """

    __slots__ = ("_helpless_s", "_steered", "_turn_rad_s", "fault")

    def __init__(self) -> None:
        self.fault = ""
        self.pause()

    def pause(self) -> None:
        """The motion says nothing of the rudder for now. A fault stands."""
        self._steered = self._turn_rad_s = self._helpless_s = 0.0

    def rearm(self) -> None:
        """The boat is disarmed."""
        self.fault = ""
        self.pause()

    def update(
        self,
        throttle: float,
        rudder: float,
        nav: NavState | None,
        config: BoatConfig,
        dt_s: float,
    ) -> None:
        """Take the commands of the last dt_s and what has come of them."""
        if nav is None or not config.drive.has_rudder:
            self.rearm()
            return
        water_m_s = nav.surge_m_s - nav.current_along_m_s(nav.heading_rad)
        moment = min(max(rudder * rudder_effect(throttle, water_m_s, config.drive, config.speed), -1.0), 1.0)
        blend = min(dt_s / _SMOOTH_S, 1.0)
        self._steered += blend * (moment - self._steered)
        self._turn_rad_s += blend * (nav.yaw_rate_rad_s - self._turn_rad_s)
        is_steered = abs(self._steered) > _STEERED
        is_turning = self._turn_rad_s * math.copysign(1.0, self._steered) >= _TURNS_RAD_S
        if is_steered and is_turning:
            self.fault = ""
        self._helpless_s = self._helpless_s + dt_s if is_steered and not is_turning else 0.0
        if self._helpless_s >= _HELPLESS_S:
            self.fault = "Steering lost: rudder has no effect"
