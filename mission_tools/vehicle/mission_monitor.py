"""Monitors a running mission from outside: its progress, and whether it completed or failed.

It has no link and no clock: the state of the vehicle and the time are arguments.
"""

import math
from dataclasses import dataclass
from typing import Self

from companion.core.geo import LatLon, LocalFrame, Point, path_length_m
from mission_tools.errors import VehicleError
from mission_tools.mission.mission import Mission
from mission_tools.vehicle.state import AUTO, MISSION_ACTIVE, MISSION_COMPLETE, VehicleState

STALL_S = 60.0
REASON_S = 1.0  # a heartbeat tells the new mode before the text that says why
LEAST_PROGRESS_M = 0.02  # less than this is a boat that wobbles
STEADY_AFTER_S = 2.0  # before this the mean speed says nothing


@dataclass(frozen=True, slots=True)
class Progress:
    """The state of the mission. `waypoint` is the target, counted from 1; eta_s is NaN while unknown."""

    waypoint: int
    waypoints: int
    left_m: float
    total_m: float
    speed_m_s: float
    eta_s: float
    finished: bool = False


@dataclass(frozen=True, slots=True)
class TrackPoint:
    """Where the boat was, and when by its own clock; an emulator's may run faster than ours."""

    time_s: float
    place: LatLon
    speed_m_s: float


class MissionMonitor:
    """Follows one mission. `first_seq`: sequence number of the mission's first item, 1 where 0 is home."""

    def __init__(self, mission: Mission, now_s: float, *, first_seq: int = 1) -> None:
        self.track: list[TrackPoint] = []
        self._began_s = now_s
        places = [(seq, item) for seq, item in enumerate(mission.items, start=first_seq) if item.place]
        self._frame = LocalFrame(mission.places[0]) if places else LocalFrame(LatLon(0.0, 0.0))
        self._points = [self._frame.to_local(place) for place in mission.places]
        self._sequences = [seq for seq, _ in places]
        self._holds_s = [item.hold_s for _, item in places]
        self._was_active = False
        self._first_left_m = math.nan
        self._best_left_m = math.inf
        self._advanced_s = now_s
        self._ended_s = math.inf  # since when it has not been sailing the mission
        self._waypoint = 0

    @classmethod
    def of(cls, state: VehicleState, mission: Mission, now_s: float) -> Self:
        """A monitor that counts items as the vehicle of this state does."""
        return cls(mission, now_s, first_seq=state.first_seq)

    def replaced(self, mission: Mission, now_s: float, *, first_seq: int = 1) -> "MissionMonitor":
        """A monitor of the mission that took this one's place; the track goes on."""
        monitor = MissionMonitor(mission, now_s, first_seq=first_seq)
        monitor.track = self.track
        return monitor

    @property
    def duration_s(self) -> float:
        """How long the boat has been under way, by its own clock."""
        return self.track[-1].time_s - self.track[0].time_s if self.track else 0.0

    @property
    def track_length_m(self) -> float:
        """How far the boat has come."""
        points = [self._frame.to_local(point.place) for point in self.track]
        return path_length_m(points)

    def update(self, state: VehicleState, now_s: float) -> Progress:
        """Take in the vehicle's state as of now. Raises VehicleError: the vehicle left AUTO, disarmed, or
        makes no progress; says where and why.
        """
        self._was_active = self._was_active or state.mission_state == MISSION_ACTIVE
        self._record(state, now_s)
        if self._is_finished(state):
            return self._progress(state, now_s, finished=True)
        progress = self._progress(state, now_s, finished=False)
        self._raise_if_ended(state, progress, now_s)
        self._raise_if_stuck(progress, now_s)
        return progress

    def _record(self, state: VehicleState, now_s: float) -> None:
        if state.position is not None and (not self.track or self.track[-1].place != state.position):
            time_s = state.boat_time_s or now_s
            self.track.append(TrackPoint(time_s, state.position, state.speed_m_s))

    def _is_finished(self, state: VehicleState) -> bool:
        reached_last = bool(self._sequences) and state.reached_item >= self._sequences[-1]
        return reached_last or (self._was_active and state.mission_state == MISSION_COMPLETE)

    def _progress(self, state: VehicleState, now_s: float, *, finished: bool) -> Progress:
        sailed_to = max(state.current_item, state.reached_item + 1)
        index = next(
            (n for n, seq in enumerate(self._sequences) if seq >= sailed_to), len(self._sequences) - 1
        )
        left_m = 0.0 if finished else self._left_m(state, index)
        if math.isnan(self._first_left_m):
            self._first_left_m = left_m
        elapsed_s = now_s - self._began_s
        made_good_m_s = (self._first_left_m - left_m) / elapsed_s if elapsed_s > STEADY_AFTER_S else 0.0
        eta_s = 0.0 if finished else left_m / made_good_m_s if made_good_m_s > 0.0 else math.nan
        total_m = max(self._first_left_m, left_m)
        count = len(self._sequences)
        return Progress(index + 1, count, left_m, total_m, state.speed_m_s, eta_s, finished)

    def _left_m(self, state: VehicleState, index: int) -> float:
        """To the waypoint that is sailed to, and along the legs after it."""
        if not self._points:
            return 0.0
        here: Point = self._frame.to_local(state.position) if state.position else self._points[index]
        route = [here, *self._points[index:]]
        return path_length_m(route)

    def _raise_if_ended(self, state: VehicleState, progress: Progress, now_s: float) -> None:
        if state.armed and not (state.is_ardupilot and state.custom_mode != AUTO):
            self._ended_s = math.inf
            return
        self._ended_s = min(self._ended_s, now_s)
        at = f"on the way to waypoint {progress.waypoint} of {progress.waypoints}"
        text = state.last_warning(self._began_s)
        if not text and now_s - self._ended_s < REASON_S:
            return
        because = f" ({text})" if text else ""
        if not state.armed:
            raise VehicleError(f"the boat disarmed {at}{because}")
        raise VehicleError(f"the boat left AUTO for {state.mode} {at}{because}")

    def _raise_if_stuck(self, progress: Progress, now_s: float) -> None:
        if progress.waypoint != self._waypoint or progress.left_m < self._best_left_m - LEAST_PROGRESS_M:
            self._waypoint, self._best_left_m, self._advanced_s = progress.waypoint, progress.left_m, now_s
        # A boat that waits at a waypoint has not yet been sent on to the next, or has just been.
        near = self._holds_s[max(progress.waypoint - 2, 0) : progress.waypoint]
        patience_s = STALL_S + max(near, default=0.0)
        if now_s - self._advanced_s > patience_s:
            raise VehicleError(
                f"the boat has made no progress for {patience_s:.0f} s on the way to waypoint "
                f"{progress.waypoint} of {progress.waypoints}, {progress.left_m:.1f} m before the end"
            )
