"""Vehicle commands: each is one request to the vehicle."""

import math

from companion.config.tuning import CIRCLE_KIND
from companion.core import requests
from companion.core.modes import Mode
from companion.core.status_text import Severity, StatusText
from companion.mavlink.dialect import constants, dialect
from companion.services.commands.command import Command, CommandTable, Result
from companion.services.parameters import ParameterService
from companion.services.statustext import StatusTextService
from companion.vehicle.vehicle import Vehicle

_DISARM_MAGIC = 21196
_ARM_MAGIC = (2989, 21196)  # ArduPilot's, and that of MAVLink's common set, which forces both ways
_AIRSPEED_OR_GROUND = (0.0, 1.0)
REGIONS_OF_INTEREST = constants(
    "MAV_CMD_DO_SET", "ROI", "ROI_LOCATION", "ROI_NONE", "ROI_SYSID", "ROI_WPNEXT_OFFSET"
)
_NO_CHANGE, _BACK_TO_DEFAULT = -1.0, -2.0  # of DO_CHANGE_SPEED


class VehicleCommands:
    """Executes the requests; the vehicle reports refusals itself."""

    def __init__(self, vehicle: Vehicle, parameters: ParameterService, texts: StatusTextService) -> None:
        self._vehicle = vehicle
        self._parameters = parameters
        self._texts = texts
        self._paused: Mode | None = None
        self.table: CommandTable = {
            dialect.MAV_CMD_COMPONENT_ARM_DISARM: self._arm_disarm,
            dialect.MAV_CMD_DO_CHANGE_SPEED: self._change_speed,
            dialect.MAV_CMD_DO_FENCE_ENABLE: self._fence_enable,
            dialect.MAV_CMD_DO_FLIGHTTERMINATION: self._terminate,
            dialect.MAV_CMD_DO_PAUSE_CONTINUE: self._pause_continue,
            dialect.MAV_CMD_DO_REPOSITION: self._reposition,
            dialect.MAV_CMD_DO_SET_HOME: self._set_home,
            dialect.MAV_CMD_DO_SET_MISSION_CURRENT: self._set_current,
            dialect.MAV_CMD_DO_SET_MODE: self._set_mode,
            dialect.MAV_CMD_MISSION_START: self._start_mission,
            dialect.MAV_CMD_NAV_LOITER_UNLIM: lambda _: self._ask(requests.ChangeMode(Mode.LOITER)),
            dialect.MAV_CMD_NAV_RETURN_TO_LAUNCH: lambda _: self._ask(requests.ChangeMode(Mode.RTL)),
            dialect.MAV_CMD_RUN_PREARM_CHECKS: self._check,
            **dict.fromkeys(REGIONS_OF_INTEREST, self._refuse_region),
        }

    def _ask(self, request: requests.Request) -> Result:
        return Result.ACCEPTED if self._vehicle.request(request).accepted else Result.FAILED

    def _arm_disarm(self, command: Command) -> Result:
        arm, magic = command.whole(0), command.p[1]
        if arm == 1:
            return self._ask(requests.Arm(force=magic in _ARM_MAGIC))
        if arm == 0:
            return self._ask(requests.Disarm("by emergency stop" if magic == _DISARM_MAGIC else "by command"))
        return Result.DENIED

    def _terminate(self, command: Command) -> Result:
        return self._ask(requests.Disarm("by flight termination")) if command.whole(0) == 1 else Result.DENIED

    def _check(self, command: Command) -> Result:  # noqa: ARG002
        if self._vehicle.armed:
            return Result.REJECTED_FOR_NOW
        faults = self._vehicle.arming_faults()
        self._texts.send([StatusText(Severity.CRITICAL, f"PreArm: {fault}") for fault in faults])
        return Result.ACCEPTED

    def _set_mode(self, command: Command) -> Result:
        flags, number = command.whole(0), command.whole(1)
        if flags is None or number is None or not flags & dialect.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED:
            return Result.DENIED
        return self._ask(requests.ChangeMode(number))

    def _start_mission(self, command: Command) -> Result:
        first = command.whole(0)
        return (
            Result.DENIED if first is None or first < 0 else self._ask(requests.StartMission(first or None))
        )

    def _pause_continue(self, command: Command) -> Result:
        """Pause keeps station (drifts without a position); continue returns to the paused mode."""
        wanted, mode = command.whole(0), self._vehicle.mode
        if wanted == 0:
            goes_on = mode not in (Mode.LOITER, Mode.HOLD)
            result = self._ask(requests.ChangeMode(Mode.LOITER))
            if result == Result.ACCEPTED and goes_on:
                self._paused = mode
            return result
        if wanted == 1:
            paused, self._paused = self._paused, None
            return self._ask(requests.ChangeMode(paused or Mode.AUTO))
        return Result.DENIED

    def _set_current(self, command: Command) -> Result:
        """seq −1 is the present item; param2 = 1 restarts the jump counters."""
        seq = command.whole(0)
        if seq is None or seq < -1:
            return Result.DENIED
        is_beyond = seq > self._vehicle.progress.last_seq
        result = self._ask(requests.SetCurrentItem(None if seq == -1 else seq, reset=command.whole(1) == 1))
        return Result.DENIED if is_beyond else result

    def _reposition(self, command: Command) -> Result:
        position = command.position()
        if position is None:
            return Result.DENIED
        speed_m_s = command.p[0] if math.isfinite(command.p[0]) and command.p[0] > 0.0 else None
        change_mode = bool((command.whole(1) or 0) & dialect.MAV_DO_REPOSITION_FLAGS_CHANGE_MODE)
        return self._ask(requests.GoTo(position, speed_m_s, change_mode))

    def _change_speed(self, command: Command) -> Result:
        kind, speed_m_s = command.p[0], command.p[1]
        if kind not in _AIRSPEED_OR_GROUND:
            return Result.DENIED
        if speed_m_s == _NO_CHANGE:
            return Result.ACCEPTED
        if speed_m_s == _BACK_TO_DEFAULT:
            speed_m_s = self._vehicle.config.speed.cruise_m_s
        if not math.isfinite(speed_m_s) or speed_m_s <= 0.0:
            return Result.DENIED
        return self._ask(requests.ChangeSpeed(speed_m_s))

    def _set_home(self, command: Command) -> Result:
        if command.whole(0) == 1:
            return self._ask(requests.SetHome())
        position = command.position()
        return Result.DENIED if position is None else self._ask(requests.SetHome(position))

    def _refuse_region(self, command: Command) -> Result:  # noqa: ARG002
        self._texts.notify(Severity.ERROR, "ROI: this boat has no camera mount that turns")
        return Result.UNSUPPORTED

    def _fence_enable(self, command: Command) -> Result:
        """As parameter FENCE_ENABLE; param1 = 2 (disable the floor) has no effect."""
        wanted = command.whole(0)
        if wanted not in (0, 1):
            return Result.ACCEPTED if wanted == 2 else Result.DENIED
        return self._switch_fence(is_on=wanted == 1)

    def _switch_fence(self, *, is_on: bool) -> Result:
        if is_on and not self._vehicle.fence.uploaded and not self._vehicle.config.fence.kinds & CIRCLE_KIND:
            self._texts.notify(Severity.ERROR, "Fence: none uploaded")
            return Result.FAILED
        return Result.FAILED if self._parameters.set("FENCE_ENABLE", float(is_on)) else Result.ACCEPTED

    def tick(self) -> None:
        """Switch the fence as the mission asks."""
        for is_on in self._vehicle.progress.take_fence_switches():
            if self._switch_fence(is_on=is_on) == Result.ACCEPTED:
                done = "enabled" if is_on else "disabled"
                self._texts.notify(Severity.NOTICE, f"Fence {done} by the mission")
