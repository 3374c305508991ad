"""Checks the mission against the fence, a few items a tick."""

from companion.core.geo import LatLon, LocalFrame, Point
from companion.core.status_text import Severity, StatusText
from companion.geofence.fence import Fence
from companion.vehicle.mission.steps import GoRound, Mission, Waypoint

_ITEMS_A_TICK = 10


class MissionCheck:
    """fault: the first fault found so far, for the operator; empty without one.

    Places relative to the start of a leg cannot be checked beforehand, nor can the first leg: see
    `route_to_mission.py`.
    """

    def __init__(self, status_texts: list[StatusText]) -> None:
        self.fault = ""
        self._status_texts = status_texts
        self._mission: Mission = ()
        self._frame: LocalFrame | None = None
        self._version = 0  # of the fence
        self._seq = 0  # the next item to check
        self._before: Point | None = None

    def advance(self, mission: Mission, fence: Fence, frame: LocalFrame) -> None:
        """Check the next items; from the first one again if mission or fence have changed."""
        if self._mission is not mission or self._version != fence.version or self._frame is not frame:
            self._mission, self._version, self._frame = mission, fence.version, frame
            self._seq, self._before, self.fault = 0, None, ""
        if not fence.is_active:
            return
        for seq in range(self._seq, min(self._seq + _ITEMS_A_TICK, len(mission))):
            self._seq = seq + 1
            fault = self._look(seq, fence, frame)
            if fault:
                self.fault = fault
                self._seq = len(mission)
                self._status_texts.append(StatusText(Severity.WARNING, f"Mission: {fault}"))
                return

    def _look(self, seq: int, fence: Fence, frame: LocalFrame) -> str:
        step = self._mission[seq]
        if not isinstance(step, Waypoint | GoRound):
            return ""
        before, self._before = self._before, None
        place = frame.to_local(step.position) if isinstance(step.position, LatLon) else step.position
        if not isinstance(place, Point):
            return ""
        if not fence.allows(place):
            return f"item {seq} is outside the fence"
        if before is not None and fence.crosses(before, place):
            return f"the way to item {seq} leaves the fence"
        if isinstance(step, Waypoint):
            self._before = place
        return ""
