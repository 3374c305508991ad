"""Get off a shore that the current presses the boat against.

A hull that lies beam on is held by more than its motors can pull straight away, but it slides: thrust along
the shore works against friction alone, and past the next point the shore ends. By turns: ahead along the
shore, straight off, astern along the shore, and the bow turned off. A try goes on while it makes way. Between
tries the motors rest, and after a round of tries for longer: the next wave may lift the hull, and a motor
held at full thrust overheats. Once off, the boat stands off into open water.
"""

import math

from companion.config.actuators import DriveSetting
from companion.config.boat_config import BoatConfig
from companion.core.geo import Point, bearing_rad, distance_m
from companion.core.intent import Drive, HoldCourse, Intent, Stop
from companion.core.state import NavState, lacks_heading, lacks_position
from companion.core.units import wrap_pi
from companion.failsafe.actions import State, Trigger
from companion.geofence.fence import Fence

_STOP = Stop()
_TRY_S = 4.0  # friction overcome, the boat gathers way within two seconds: as long again to measure it
_LONGEST_S = 20.0  # of a try that makes way
_PAUSE_S = 1.5  # both shafts stop, and a motor held at full thrust cools
_REST_S = (15.0, 30.0, 60.0)  # after the first, the second and every later round
_TRIES = 4  # ahead, off, astern, turn
_SLIDES_M = 0.6  # within _TRY_S: less is no way made
_ALONG, _HELM = 0.8, 0.2  # throttle along the shore, and steering off it
_OFF_M = 1.0  # from the line: the hull is afloat
_CLEAR_MARGINS = 1.5  # of the fence's margin: far enough off to end
_STANDS_OFF_S = 20.0  # at most
_SEEN_M = 3.0  # beyond the fence's margin: the point that gives the bearing of open water


class Ungrounding:
    """The tries and their timing. rounds: of tries that did not help."""

    def __init__(self) -> None:
        self.begin(0.0)

    def begin(self, now_s: float) -> None:
        """Start anew, at rest."""
        self.rounds = 0
        self._try = 0  # of the round
        self._rest_s = now_s + _PAUSE_S  # until then the motors rest
        self._began_s = self._looked_s = now_s  # of the present try, and of its last measured position
        self._looked_at = Point(0.0, 0.0)
        self._off_s = 0.0  # when it began to stand off

    def update(
        self,
        state: State,
        nav: NavState | None,
        fence: Fence,
        seen: Point | None,
        config: BoatConfig,
        now_s: float,
    ) -> tuple[Intent, Trigger | None]:
        """What the motors do now, and the trigger that follows from the motion, if any. seen: the nearest
        place of a shore that the rangers saw, if one is near.
        """
        timeout_s = config.motors.estimate_timeout_s
        is_lost = nav is None or lacks_position(nav, timeout_s) or lacks_heading(nav, timeout_s)
        if nav is None or is_lost or not (fence.is_active or seen):
            return _STOP, Trigger.DONE
        margin_m = config.fence.margin_m
        fence_m = fence.margin_m(nav.point)
        room_m = fence_m if seen is None else min(fence_m, distance_m(nav.point, seen))
        is_past = state is State.STANDING_OFF and now_s - self._off_s > _STANDS_OFF_S
        if room_m >= max(_CLEAR_MARGINS * margin_m, _OFF_M) or is_past:
            return _STOP, Trigger.DONE
        if seen is not None and room_m < fence_m:
            away_rad = bearing_rad(seen, nav.point)
        else:
            away_rad = bearing_rad(nav.point, fence.inside(nav.point, margin_m + _SEEN_M))
        is_off = state is State.STANDING_OFF
        if room_m >= _OFF_M:
            if not is_off:
                self._off_s = now_s
            return HoldCourse(away_rad, config.speed.cruise_m_s), None if is_off else Trigger.FREED
        if is_off:
            self._rest_s = now_s + _PAUSE_S
        if now_s < self._rest_s:
            self._began_s = self._looked_s = now_s
            self._looked_at = nav.point
            return _STOP, Trigger.CARRIED_BACK if is_off else None
        trigger = Trigger.RESTED if state is State.RESTING else None
        if now_s - self._looked_s >= _TRY_S:
            if now_s - self._began_s > _LONGEST_S or distance_m(self._looked_at, nav.point) < _SLIDES_M:
                self._next(now_s)
                return _STOP, Trigger.HELD
            self._looked_s, self._looked_at = now_s, nav.point
        return self._drive(wrap_pi(away_rad - nav.heading_rad), config.drive), trigger

    def _next(self, now_s: float) -> None:
        self._try += 1
        rest_s = _PAUSE_S
        if self._try == _TRIES:
            rest_s = _REST_S[min(self.rounds, len(_REST_S) - 1)]
            self._try, self.rounds = 0, self.rounds + 1
        self._rest_s = now_s + rest_s

    def _drive(self, away_rad: float, drive: DriveSetting) -> Drive:
        """away_rad: bearing of open water, clockwise from the bow."""
        side = math.copysign(1.0, away_rad)
        throttle, steering = _ALONG, side * _HELM
        if self._try == 1:
            throttle = math.copysign(_ALONG, math.cos(away_rad))
        elif self._try == 2:
            throttle = -_ALONG
        elif self._try == 3:
            # Without a second motor the bow is turned off by the wash over the rudder, hard over
            throttle, steering = 0.0 if drive.can_pivot else _ALONG, side
        if throttle < 0.0 and not drive.has_pair:
            steering = -steering  # the sticks set the rudder's angle, and astern it turns the other way
        return Drive(throttle, steering)
