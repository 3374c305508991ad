"""The events of a run: modes, arming, messages, waypoints, contacts, faults, late commands, payload."""

from collections.abc import Mapping
from typing import NamedTuple

from companion.core.geo import Point
from companion.core.modes import Mode
from sitl.run.lockstep import Lockstep
from sitl.world.faults.catalogue import FaultSetting

MOST_EVENTS = 5000
OVER = " is over"  # after a fault's name, when it ends


class Event(NamedTuple):
    """One event. kind is mode, arming, text, waypoint, touch, fault, motors or payload."""

    time_s: float
    kind: str
    text: str


class Timeline:
    """Records changes in a lockstep run, tick by tick, up to MOST_EVENTS."""

    def __init__(self) -> None:
        self.events: list[Event] = []
        self.touched: list[str] = []  # what the hull has touched, in order, each once
        self.late_commands = 0  # ticks on which a motor was driven though the boat was not armed
        self._mode: Mode | None = None
        self._armed = False
        self._grounded = False
        self._faults: dict[str, FaultSetting] = {}
        self._texts = 0
        self._reached = 0

    def tick(self, lockstep: Lockstep) -> None:
        """To be called after each step."""
        boat, station, truth = lockstep.boat, lockstep.station, lockstep.world.truth
        vehicle = boat.vehicle
        if vehicle.mode is not self._mode:
            self._mode = vehicle.mode
            self._add(truth.time_s, "mode", vehicle.mode.name)
        if vehicle.armed is not self._armed:
            self._armed = vehicle.armed
            self._add(truth.time_s, "arming", "armed" if vehicle.armed else "disarmed")
        if len(station.texts) != self._texts:
            for text in station.texts[self._texts :]:
                self._add(truth.time_s, "text", text)
            self._texts = len(station.texts)
        if len(station.reached) != self._reached:
            for seq in station.reached[self._reached :]:
                self._add(truth.time_s, "waypoint", f"item {seq} reached")
            self._reached = len(station.reached)
        if lockstep.world.electronics.faults.active != self._faults:
            self._note_faults(lockstep.world.electronics.faults.active, truth.time_s)
        done = lockstep.world.electronics.payload.lines
        while done:
            self._add(truth.time_s, "payload", done.popleft())
        if truth.grounded is not self._grounded:
            self._grounded = truth.grounded
            if truth.grounded:
                self._touch(lockstep)
        if not vehicle.armed and (truth.left_command or truth.right_command):
            if self.late_commands == 0:
                self._add(truth.time_s, "motors", "driven though disarmed")
            self.late_commands += 1

    def _note_faults(self, active: Mapping[str, FaultSetting], time_s: float) -> None:
        for what, fault in self._faults.items():
            if active.get(what) is not fault:
                self._add(time_s, "fault", f"{what} {fault.kind}{OVER}")
        for what, fault in active.items():
            if self._faults.get(what) is not fault:
                self._add(time_s, "fault", f"{what} {fault.kind}")
        self._faults = dict(active)

    def _touch(self, lockstep: Lockstep) -> None:
        truth = lockstep.world.truth
        what = lockstep.world.scenario.chart.nearest_feature(Point(truth.north_m, truth.east_m))
        self._add(truth.time_s, "touch", what)
        if what not in self.touched:
            self.touched.append(what)

    def _add(self, time_s: float, kind: str, text: str) -> None:
        if len(self.events) < MOST_EVENTS:
            self.events.append(Event(time_s, kind, text))
