"""The boat's progress in its mission: current item, leg, and items reached.

As in ArduPilot, the current item is one that is sailed. Commands between two such items are executed when the
second one begins. After a condition they wait, and are dropped if the leg ends first.
"""

import math

from companion.config.boat_config import BoatConfig
from companion.core.geo import LatLon, Line, LocalFrame, Point
from companion.core.intent import Intent, KeepStation
from companion.core.state import NavState
from companion.guidance.leg import Leg
from companion.payload.actions import PayloadAction
from companion.vehicle.mission import steps
from companion.vehicle.mission.conditions import ConditionalCommand
from companion.vehicle.mission.left_leg import LeftLeg
from companion.vehicle.mission.route import MissionRoute
from companion.vehicle.mission.stationary_items import StationaryItem, StationaryStep
from companion.vehicle.mission.steps import Mission, Step, locate
from companion.vehicle.orbit import Orbit

_STEPS_A_TICK = 100  # bounds a loop of items without a leg


class MissionProgress:
    """Advances through a mission. Places are converted to the local frame when a leg begins."""

    def __init__(self) -> None:
        self.mission: Mission = ()
        self.current_seq = 0
        self.finished = False
        self.has_started = False
        self.go_home = False  # the mission asked for RTL
        self.reached: list[int] = []  # sequences reached since the owner last took them
        self.speed_m_s: float | None = None  # None: cruise speed
        self.homes: list[LatLon | None] = []  # asked for since the owner last took them; None is here
        self.actions: list[PayloadAction] = []  # asked for since the owner last took them
        self.fence_switches: list[bool] = []  # asked for since the owner last took them: on or off
        self.jumps: dict[int, int] = {}  # how often each was made
        self._leg_start: Point | None = None
        self.left: LeftLeg | None = None  # until the mission goes on there
        self._begun_s = math.nan  # when the present item began to wait, turn or hand over
        self._station: Point | None = None
        self._under_way = MissionRoute()
        self._is_loose = False  # it began wherever the boat was
        self._orbit: Orbit | None = None
        self._deferred = ConditionalCommand()
        self._stationary = StationaryItem()

    @property
    def is_empty(self) -> bool:
        """Whether there is no item to sail."""
        return len(self.mission) <= 1

    @property
    def last_seq(self) -> int:
        """The sequence number of the last item, 0 without a mission."""
        return max(len(self.mission) - 1, 0)

    @property
    def is_handed_over(self) -> bool:
        """Whether the current item lets another program steer."""
        return (
            not self.finished and not math.isnan(self._begun_s) and isinstance(self._step(), steps.HandOver)
        )

    def replace(self, mission: Mission) -> bool:
        """Take a new mission. Whether the boat continues: all items up to the current one are the same.
        Otherwise the new mission starts from its first item.
        """
        done = self.current_seq + 1
        same = self.has_started and not self.finished and self.mission[1:done] == mission[1:done]
        goes_on = same and done <= len(mission)
        self.mission = mission
        if goes_on:
            self._under_way.forget_onward()
        else:
            self.restart()
        return goes_on

    def restart(self) -> None:
        """Return to the first item, and reset all jumps."""
        self.jumps.clear()
        self.has_started = False
        self.speed_m_s = None
        self._stationary.limit = steps.LimitHandOver(0.0, 0.0)
        self.set_current(1 if not self.is_empty else 0)

    def set_current(self, seq: int) -> bool:
        """Make an item current. False without effect if there is no such item."""
        if not 0 <= seq < max(len(self.mission), 1):
            return False
        self.current_seq = seq
        self.finished = False
        self.go_home = False
        self.left = None
        self._deferred.clear()
        self._begin_item()
        return True

    def resume(self) -> None:
        """Continue with the current item, on a new leg from the boat's position."""
        self._begin_item()

    def leave_leg(self, here: Point, frame: LocalFrame) -> None:
        """The charge calls the boat home: the mission goes on from here on its leg."""
        line = self.leg_line()
        if line is not None and not self._is_loose:
            self.left = LeftLeg.at(line, here, frame)

    def restore(self, seq: int, left: LeftLeg | None, speed_m_s: float | None, jumps: dict[int, int]) -> bool:
        """Restore an interrupted voyage: its item and leg. False if there is no such item."""
        if self.is_empty or not 0 < seq < len(self.mission):
            return False
        self.set_current(seq)
        self.has_started = True
        self.speed_m_s = speed_m_s
        self.jumps.clear()
        self.jumps.update(jumps)
        self.left = left
        return True

    def leg_line(self) -> Line | None:
        """The present leg; None without one."""
        leg, start = self._under_way.leg, self._leg_start
        return None if leg is None or start is None else Line(start, leg.end)

    @property
    def loose_leg(self) -> Leg | None:
        """The present leg, if it began at the boat's position and not at the end of an item."""
        return self._under_way.leg if self._is_loose else None

    def skip(self) -> None:
        """Leave the waypoint that is current unreached; the leg behind it begins there all the same."""
        leg = self._under_way.leg
        self._leave(None if leg is None else leg.end)

    def begin_leg_at(self, start: Point) -> None:
        """Restart the leg at a point from which it is clear."""
        self._leg_start, self._is_loose = start, False
        self._under_way.forget()

    def take_reached(self) -> list[int]:
        """Sequences reached since the last call."""
        reached, self.reached = self.reached, []
        return reached

    def take_homes(self) -> list[LatLon | None]:
        """Homes asked for since the last call."""
        homes, self.homes = self.homes, []
        return homes

    def take_actions(self) -> list[PayloadAction]:
        """Actions of the payload asked for since the last call."""
        actions, self.actions = self.actions, []
        return actions

    def take_fence_switches(self) -> list[bool]:
        """Whether the fence is to be on or off, as asked for since the last call."""
        switches, self.fence_switches = self.fence_switches, []
        return switches

    def update(self, nav: NavState, frame: LocalFrame, config: BoatConfig, now_s: float) -> Intent:
        """Advance, and return the intent. After the last item, keep station there."""
        self.has_started = True
        if self._leg_start is None:
            self._leg_start, self._is_loose = nav.point, True
            if self.left is not None and self.left.place is None:
                self._rejoin(self.left, frame)
        for _ in range(min(len(self.mission) + 1, _STEPS_A_TICK)):
            if self.finished:
                break
            intent = self._advance_from_current(nav, frame, config, now_s)
            if intent is not None:
                if not self._deferred.is_empty:
                    leg = self._under_way.leg
                    for step in self._deferred.take_due(nav.point, leg.end if leg else None, now_s):
                        self._do(step)
                return intent
        self._station = self._station or nav.point
        return KeepStation(self._station)

    # Items that are sailed: each returns its intent, or None once another item is current

    def _advance_from_current(
        self, nav: NavState, frame: LocalFrame, config: BoatConfig, now_s: float
    ) -> Intent | None:
        match self._step():
            case steps.Waypoint() as waypoint:
                return self._sail_to(waypoint, nav, frame, config, now_s)
            case steps.GoRound() as circle:
                return self._go_round(circle, nav, frame, config)
            case steps.Wait() | steps.Turn() | steps.HandOver() as halt:
                return self._stay(halt, nav, now_s)
            case steps.ReturnHome():
                self.go_home = self.finished = True
            case steps.Jump(target, times):
                self._jump(target, times)
            case steps.Home():
                self._advance(self._leg_start)
            case steps.AfterDelay() | steps.WithinDistance() as condition:
                self._deferred.wait_for(condition, now_s)
                self._advance(self._leg_start)
            case step:
                if not self._deferred.holds_back(step):
                    self._do(step)
                self._advance(self._leg_start)
        return None

    def _sail_to(
        self, waypoint: steps.Waypoint, nav: NavState, frame: LocalFrame, config: BoatConfig, now_s: float
    ) -> Intent | None:
        under_way, own_radius_m = self._under_way, config.guidance.waypoint_radius_m
        if self.left is not None and self.left.place is not None:
            back = under_way.lay(steps.Waypoint(self.left.place), self._leg_start or nav.point, frame)
            if not back.has_ended(nav, own_radius_m):
                return back.intent(self.speed_m_s or config.speed.cruise_m_s)
            self._rejoin(self.left, frame)
        leg = under_way.lay(waypoint, self._leg_start or nav.point, frame)
        under_way.look_ahead(self.mission, self.current_seq, self.jumps, frame, own_radius_m)
        under_way.note_approach(nav.point, own_radius_m)
        if math.isnan(self._begun_s):
            if not leg.has_ended(nav, own_radius_m):
                speed_m_s = self.speed_m_s or config.speed.cruise_m_s
                return under_way.intent(leg, self._leg_start, speed_m_s, nav.point)
            self.reached.append(self.current_seq)
            self._station = leg.end
            self._begun_s = now_s
        if now_s < self._begun_s + waypoint.hold_s:
            return KeepStation(leg.end)
        self._leave(leg.end)
        return None

    def _rejoin(self, left: LeftLeg, frame: LocalFrame) -> None:
        self.left = None
        self.begin_leg_at(frame.to_local(left.start))

    def _go_round(
        self, circle: steps.GoRound, nav: NavState, frame: LocalFrame, config: BoatConfig
    ) -> Intent | None:
        orbit = self._orbit
        if orbit is None:
            centre = locate(circle.position, frame, self._leg_start or nav.point)
            radius_m = circle.radius_m or config.modes.circle_radius_m
            orbit = self._orbit = Orbit(centre, radius_m, circle.clockwise)
        orbit.update(nav)
        if orbit.turns < circle.turns:
            return orbit.intent(self.speed_m_s or config.speed.cruise_m_s)
        self.reached.append(self.current_seq)
        self._leave(nav.point)
        self._is_loose = not self.finished
        return None

    def _stay(self, step: StationaryStep, nav: NavState, now_s: float) -> Intent | None:
        if math.isnan(self._begun_s):
            self._begun_s = now_s
            self._station = self._stationary.begin(step, nav, self._station, now_s)
        if (intent := self._stationary.intent(step, nav, now_s)) is not None:
            return intent
        self.reached.append(self.current_seq)
        if isinstance(step, steps.Wait):
            self._leave(self._leg_start)
        else:
            self._leave(None)
            self._leg_start, self._is_loose = nav.point, not self.finished
        return None

    # Commands

    def _do(self, step: steps.Done) -> None:
        match step:
            case steps.SetSpeed(speed_m_s):
                self.speed_m_s = speed_m_s or None
            case steps.MoveHome(position):
                self.homes.append(position)
            case steps.EnableFence(is_on):
                self.fence_switches.append(is_on)
            case steps.LimitHandOver():
                self._stationary.limit = step
            case steps.Act(action):
                self.actions.append(action)

    # Sequence

    def _step(self) -> Step:
        return self.mission[self.current_seq] if self.current_seq < len(self.mission) else steps.Home()

    def _jump(self, target: int, times: int) -> None:
        done = self.jumps.get(self.current_seq, 0)
        if times < 0 or done < times:
            self.jumps[self.current_seq] = done + 1
            self.current_seq = target
            self._begin_item(self._leg_start)
        else:
            self._advance(self._leg_start)

    def _leave(self, leg_start: Point | None) -> None:
        """End an item that was sailed, and drop the commands still waiting."""
        self.left = None
        self._deferred.clear()
        self._advance(leg_start)

    def _advance(self, leg_start: Point | None) -> None:
        if self.current_seq >= self.last_seq:
            self.finished = True
            self._deferred.clear()
            return
        self.current_seq += 1
        self._begin_item(leg_start)

    def _begin_item(self, leg_start: Point | None = None) -> None:
        # The leg of a command begins where the leg before it began
        self._is_loose = self._is_loose and leg_start is self._leg_start
        self._leg_start = leg_start
        self._orbit = None
        self._begun_s = math.nan
        self._under_way.pass_waypoint()
        if leg_start is None:
            self._is_loose = False
            self._under_way.forget()
            self._station = None
