"""The vehicle: mode, arming, home, mission and failsafes. Requests go in, an intent comes out each tick."""

from collections.abc import Sequence

from companion.core.geo import LatLon, Point
from companion.core.intent import Intent, Stop
from companion.core.modes import Mode
from companion.core.requests import Outcome, Request
from companion.core.state import lacks_position
from companion.core.status_text import Severity, StatusText
from companion.geofence.fence import FenceArea
from companion.vehicle.commands import execute, follow_mission
from companion.vehicle.failsafes import recheck_motors, run_failsafes, run_recovery
from companion.vehicle.mission.steps import Mission
from companion.vehicle.vehicle_core import VehicleCore

_STOP = Stop()


class Vehicle(VehicleCore):
    """The vehicle's cycle, and what stations ask of it. Commands and failsafes are functions of their own."""

    def decide(self) -> Intent:
        """Run the failsafes, then the mode. The intent for guidance."""
        if self.nav is not None and self.frame is not None:
            self.route.prepare(self.frame, self.home, self.config)
        if self.failsafes.is_due(self._now_s):
            run_failsafes(self, self._now_s)
        for text in self.data_losses.update(self._now_s):
            self.notify(Severity.WARNING, text)
        if not self.armed:
            for fault in self._pre_arm.update(self.arming_faults, self._now_s, self.config.arming.repeat_s):
                self.notify(Severity.CRITICAL, f"PreArm: {fault}")
            return _STOP
        inputs = self._mode_inputs()
        if inputs is not None and not lacks_position(inputs.nav, self.config.motors.estimate_timeout_s):
            self._record_track(inputs.nav.point)
        if self.recovery.is_active:
            return run_recovery(self, self._now_s)
        if self.mode is Mode.MANUAL:
            return self.modes.manual.drive(self.config, self._now_s)
        if self.mode is Mode.HOLD or inputs is None:
            return _STOP
        recheck_motors(self, self._now_s)
        intent = self.modes.controllers[self.mode].intent(inputs)
        return follow_mission(self, intent, inputs)

    def take_status_texts(self) -> list[StatusText]:
        """Messages to the operator since the last call."""
        status_texts = self.status_texts.copy()
        self.status_texts.clear()
        return status_texts

    # Requests

    def request(self, request: Request) -> Outcome:
        """Carry out a request, at once or not at all."""
        return execute(request, self, self._now_s)

    def set_mission(self, mission: Mission) -> None:
        """Replace the mission. AUTO continues if no item up to the current one has changed, else restarts."""
        goes_on = self.progress.replace(mission)
        if self.mode is Mode.AUTO and self.progress.is_empty:
            self.change_mode(Mode.LOITER, "mission cleared")
        elif self.mode is Mode.AUTO and self.armed:
            what = f"goes on with item {self.progress.current_seq}" if goes_on else "begins at item 1"
            self.notify(Severity.INFO, f"New mission {what}")

    def set_fence(self, areas: Sequence[FenceArea]) -> None:
        """Replace the fence, with immediate effect."""
        if self.fence.uploaded and not areas:
            self.notify(Severity.NOTICE, "Fence removed")
        self.fence.set_areas(areas)
        self.fence.update(self.frame, self.home, self.config.fence)
        self._warn_of_rally_points()

    def set_rally(self, places: Sequence[LatLon]) -> None:
        """Replace the rally points. RTL leads to the nearest of them and home."""
        if self.route.rally and not places:
            self.notify(Severity.NOTICE, "Rally points removed")
        self.route.rally = tuple(places)
        self._warn_of_rally_points()

    def _warn_of_rally_points(self) -> None:
        for number, place in enumerate(self.route.rally):
            if self.frame is not None and not self.fence.allows(self.frame.to_local(place)):
                self.notify(Severity.WARNING, f"Rally point {number} is outside the fence")

    def _record_track(self, at: Point) -> None:
        """Record the way back, which SMART_RTL consumes."""
        if self.mode is Mode.SMART_RTL:
            self.track.resume_at(at)
        else:
            self.track.add(at, self.config.modes.trail_accuracy_m, self.config.modes.trail_points)
