"""Where the boat is in its mission: which item, which leg, what has been reached."""

import math

from companion.config import Guidance
from companion.geo import LocalFrame, Point
from companion.state import NavState
from companion.vehicle.intent import Intent, KeepStation
from companion.vehicle.leg import Leg
from companion.vehicle.mission_steps import Home, Jump, Mission, ReturnHome, SetSpeed, Wait, Waypoint


class MissionProgress:
    """Steps through a mission. Positions are turned into the local frame as each leg begins."""

    def __init__(self) -> None:
        self.mission: Mission = ()
        self.current_seq = 0
        self.finished = False
        self.has_started = False
        self.go_home = False  # the mission asked for RTL
        self.reached: list[int] = []  # sequences reached since the owner last took them
        self.speed_m_s: float | None = None  # None: cruise speed
        self._leg_start: Point | None = None
        self._hold_until_s = math.nan
        self._station: Point | None = None
        self._leg: Leg | None = None
        self._jumps: dict[int, int] = {}

    @property
    def is_empty(self) -> bool:
        """Whether there is nothing to sail."""
        return len(self.mission) <= 1

    @property
    def last_seq(self) -> int:
        """The sequence number of the last item, 0 without a mission."""
        return max(len(self.mission) - 1, 0)

    def replace(self, mission: Mission) -> None:
        """Take a new mission; it starts from the beginning."""
        self.mission = mission
        self.restart()

    def restart(self) -> None:
        """Go back to the first item."""
        self._jumps.clear()
        self.has_started = False
        self.speed_m_s = None
        self.set_current(1 if not self.is_empty else 0)

    def set_current(self, seq: int) -> bool:
        """Make an item current. False, and nothing changes, when there is no such item."""
        if not 0 <= seq < max(len(self.mission), 1):
            return False
        self.current_seq = seq
        self.finished = False
        self.go_home = False
        self._begin_item()
        return True

    def resume(self) -> None:
        """Go on with the current item, on a new leg from wherever the boat is."""
        self._begin_item()

    def take_reached(self) -> list[int]:
        """Sequences reached since the last call."""
        reached, self.reached = self.reached, []
        return reached

    def update(
        self, nav: NavState, frame: LocalFrame, setting: Guidance, cruise_m_s: float, now_s: float
    ) -> Intent:
        """Advance to now and say what to sail; after the last item, keeps station there."""
        self.has_started = True
        if self._leg_start is None:
            self._leg_start = nav.point
        # More steps than there are items is a loop with nothing to sail: the rest of it waits for other ticks
        for _ in range(len(self.mission) + 1):
            if self.finished:
                break
            intent = self._sail_current(nav, frame, setting, cruise_m_s, now_s)
            if intent is not None:
                return intent
        self._station = self._station or nav.point
        return KeepStation(self._station)

    def _sail_current(
        self, nav: NavState, frame: LocalFrame, setting: Guidance, cruise_m_s: float, now_s: float
    ) -> Intent | None:
        """The intent of the current item, or None when it is done and another is current."""
        match self.mission[self.current_seq] if self.mission else Home():
            case Waypoint() as waypoint:
                leg = self._leg or self._begin_leg(waypoint, nav, frame)
                if math.isnan(self._hold_until_s):
                    if not leg.has_ended(nav, setting.waypoint_radius_m):
                        return leg.intent(self.speed_m_s or cruise_m_s)
                    self.reached.append(self.current_seq)
                    self._station = leg.end
                    self._hold_until_s = now_s + waypoint.hold_s
                if now_s < self._hold_until_s:
                    return KeepStation(leg.end)
                self._advance(leg.end)
            case Wait(hold_s):
                if math.isnan(self._hold_until_s):
                    self._hold_until_s = now_s + hold_s
                self._station = self._station or nav.point
                if now_s < self._hold_until_s:
                    return KeepStation(self._station)
                self.reached.append(self.current_seq)
                self._advance(self._leg_start)
            case SetSpeed(speed_m_s):
                self.speed_m_s = speed_m_s or None
                self._advance(self._leg_start)
            case Jump(target, times):
                self._jump(target, times)
            case ReturnHome():
                self.go_home = True
                self.finished = True
            case Home():
                self._advance(self._leg_start)
        return None

    def _begin_leg(self, waypoint: Waypoint, nav: NavState, frame: LocalFrame) -> Leg:
        onward = self._next_waypoint() if waypoint.hold_s <= 0.0 else None
        next_end = frame.to_local(onward.position) if onward is not None else None
        start, end = self._leg_start or nav.point, frame.to_local(waypoint.position)
        self._leg = Leg(start, end, next_end, waypoint.radius_m)
        return self._leg

    def _next_waypoint(self) -> Waypoint | None:
        """The waypoint that follows without a stop between, None when the boat stops at this one."""
        for step in self.mission[self.current_seq + 1 :]:
            match step:
                case Waypoint():
                    return step
                case SetSpeed():
                    continue
                case _:
                    return None
        return None

    def _jump(self, target: int, times: int) -> None:
        done = self._jumps.get(self.current_seq, 0)
        if times < 0 or done < times:
            self._jumps[self.current_seq] = done + 1
            start = self._leg_start
            self.current_seq = target
            self._begin_item(start)
        else:
            self._advance(self._leg_start)

    def _advance(self, leg_start: Point | None) -> None:
        if self.current_seq >= self.last_seq:
            self.finished = True
            return
        self.current_seq += 1
        self._begin_item(leg_start)

    def _begin_item(self, leg_start: Point | None = None) -> None:
        self._leg_start = leg_start
        self._leg = None
        self._hold_until_s = math.nan
        if leg_start is None:
            self._station = None
