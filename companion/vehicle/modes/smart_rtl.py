"""SMART_RTL: back along the sailed track, leg by leg, to where the boat was armed."""

from itertools import pairwise

from companion.core.intent import Intent, KeepStation
from companion.core.state import NavState
from companion.core.status_text import Severity, StatusText
from companion.guidance.leg import Leg
from companion.vehicle.leg_passage import LegPassage
from companion.vehicle.modes.controller import ModeController, ModeInputs
from companion.vehicle.surroundings import Surroundings
from companion.vehicle.track import SailedTrack


class SmartRtlMode(ModeController):
    """Removes the track's points as they are passed, so that the rest stays the way home."""

    def __init__(
        self, track: SailedTrack, surroundings: Surroundings, status_texts: list[StatusText]
    ) -> None:
        self._track = track
        self._fence = surroundings.fence
        self._legs = LegPassage(surroundings)
        self._status_texts = status_texts
        self._has_arrived = False
        self._leg: Leg | None = None

    def fault(self, inputs: ModeInputs) -> str:
        """The track must be complete, and inside the fence."""
        track = self._track
        if track.is_incomplete:
            return f"the track is longer than SRTL_POINTS {inputs.config.modes.trail_points}"
        if not track.points:
            return "no track, the boat was not armed"
        leaves = any(self._fence.crosses(one, other) for one, other in pairwise(track.points))
        return "the track leaves the fence" if leaves else ""

    def enter(self, inputs: ModeInputs | None) -> None:  # noqa: ARG002
        """Start from wherever the boat is."""
        self._has_arrived = False
        self._leg = None
        self._legs.restart()

    def way_left_m(self, nav: NavState) -> float | None:
        """To the end of the leg, round what is in the way."""
        return self._legs.left_m(nav.point)

    def intent(self, inputs: ModeInputs) -> Intent:
        """The leg to the track's latest point, round what was seen since; station at its first one."""
        nav, config, points = inputs.nav, inputs.config, self._track.points or [inputs.nav.point]
        start = nav.point
        while not self._has_arrived:
            leg = self._leg = self._leg or Leg(start, points[-1], points[-2] if len(points) > 1 else None)
            if not leg.has_ended(nav, config.guidance.waypoint_radius_m):
                wanted = leg.intent(config.mission.rtl_speed_m_s or inputs.speed_m_s)
                sailed = self._legs.update(wanted, nav, config, inputs.now_s)
                if not self._legs.is_shut or len(points) == 1:
                    return sailed
            if len(points) == 1:
                self._has_arrived = True
                self._status_texts.append(StatusText(Severity.INFO, "SMART_RTL: arrived"))
            else:
                start, self._leg = points.pop(), None
        return KeepStation(points[0])
