"""Getting off a shore that the water presses the boat against.

A hull that lies on stones beam on is held by more than its motors can pull straight away, but it slides:
thrust along the shore works against friction alone, and past the next point the shore ends. By turns: ahead
along the shore, straight off, astern along the shore, and the bow turned off. A try goes on while it makes
way. Between tries the motors rest, and after a round of them for longer: what does not give way now may with
the next wave, and a motor that is held at full thrust burns. Once off, the boat stands off into open water.
"""

import math

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point, bearing_rad, distance_m
from companion.core.health import lacks_heading, lacks_position
from companion.core.intent import Drive, HoldCourse, Intent, Stop
from companion.core.state import NavState
from companion.core.units import wrap_pi
from companion.geofence.fence import Fence

_STOP = Stop()
_TRY_S = 4.0
_LONGEST_S = 20.0  # a try that makes way
_PAUSE_S = 1.5
_REST_S = (15.0, 30.0, 60.0)  # after each round; the last one ever after
_TRIES = 4
_SLIDES_M = 0.6  # in a _TRY_S: it makes way
_ALONG, _HELM = 0.8, 0.2  # throttle along the shore, and steering off it
_OFF_M = 1.0  # from the line: the hull touches nothing any more
_CLEAR_MARGINS = 1.5  # of the fence's margin: there it is well off
_STANDS_OFF_S = 20.0  # longest time under way there
_SEEN_M = 3.0  # beyond the fence's margin: where it looks for the water


class Ungrounding:
    """It steers in place of the mode for as long as it `is_running`. rounds: of tries that did not help."""

    __slots__ = (
        "_began_s", "_looked_at", "_looked_s", "_off_s", "_rest_s", "_try", "is_running", "rounds",
    )  # fmt: skip

    def __init__(self) -> None:
        self.is_running = False
        self.rounds = 0
        self._try = 0  # of the round
        self._began_s = 0.0  # the present try
        self._rest_s = 0.0  # until then the motors rest
        self._looked_s, self._looked_at = 0.0, Point(0.0, 0.0)  # when its way was measured last
        self._off_s = math.nan  # since then it stands off

    def begin(self, now_s: float) -> None:
        """Start, unless it is under way."""
        if not self.is_running:
            self.is_running, self.rounds, self._try, self._off_s = True, 0, 0, math.nan
            self._rest_s = now_s + _PAUSE_S

    def stop(self) -> None:
        """Break off."""
        self.is_running = False

    def intent(self, nav: NavState | None, fence: Fence, config: BoatConfig, now_s: float) -> Intent:
        """What the motors are to do now; ends by itself once the boat is well off, or nobody knows where."""
        timeout_s = config.motors.estimate_timeout_s
        is_lost = nav is None or lacks_position(nav, timeout_s) or lacks_heading(nav, timeout_s)
        if nav is None or is_lost or not fence.is_active:
            self.stop()
            return _STOP
        margin_m = config.fence.margin_m
        room_m = fence.margin_m(nav.point)
        is_past = now_s - self._off_s > _STANDS_OFF_S  # never so while it is not a number
        if room_m >= max(_CLEAR_MARGINS * margin_m, _OFF_M) or is_past:
            self.stop()
            return _STOP
        away_rad = bearing_rad(nav.point, fence.inside(nav.point, margin_m + _SEEN_M))
        if room_m >= _OFF_M:
            if math.isnan(self._off_s):
                self._off_s = now_s
            return HoldCourse(away_rad, config.speed.cruise_m_s)
        if not math.isnan(self._off_s):  # it has been carried back
            self._off_s, self._rest_s = math.nan, now_s + _PAUSE_S
        if now_s < self._rest_s:
            self._began_s = self._looked_s = now_s
            self._looked_at = nav.point
            return _STOP
        if now_s - self._looked_s >= _TRY_S:
            if now_s - self._began_s > _LONGEST_S or distance_m(self._looked_at, nav.point) < _SLIDES_M:
                self._next(now_s)
                return _STOP
            self._looked_s, self._looked_at = now_s, nav.point
        return self._drive(wrap_pi(away_rad - nav.heading_rad))

    def _next(self, now_s: float) -> None:
        self._try += 1
        rest_s = _PAUSE_S
        if self._try == _TRIES:
            rest_s = _REST_S[min(self.rounds, len(_REST_S) - 1)]
            self._try, self.rounds = 0, self.rounds + 1
        self._rest_s = now_s + rest_s

    def _drive(self, away_rad: float) -> Drive:
        """away_rad: where the water is, to starboard of the bow."""
        side = math.copysign(1.0, away_rad)
        if self._try == 0:
            return Drive(_ALONG, side * _HELM)
        if self._try == 1:
            return Drive(math.copysign(_ALONG, math.cos(away_rad)), side * _HELM)
        if self._try == 2:
            return Drive(-_ALONG, side * _HELM)
        return Drive(0.0, side)
