"""COMMAND_LONG and COMMAND_INT: one table of commands, and an immediate answer to every one.

Silence is what costs a ground station time, so a command that is not in the table is refused at once.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

from companion.geo import LatLon
from companion.mavlink.dialect import Message, dialect
from companion.requests import (
    Arm,
    ChangeMode,
    ChangeSpeed,
    Disarm,
    GoTo,
    Outcome,
    Request,
    SetCurrentItem,
    SetHome,
    StartMission,
)
from companion.services.outbox import Origin, Outbox
from companion.services.telemetry import TelemetryService
from companion.units import e7_to_deg
from companion.vehicle.modes import Mode
from companion.vehicle.vehicle import Vehicle

_ARM_MAGIC, _DISARM_MAGIC = 2989, 21196
_GLOBAL_FRAMES = frozenset(
    {
        dialect.MAV_FRAME_GLOBAL,
        dialect.MAV_FRAME_GLOBAL_INT,
        dialect.MAV_FRAME_GLOBAL_RELATIVE_ALT,
        dialect.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT,
    }
)
_OK = dialect.MAV_RESULT_ACCEPTED
_DENIED = dialect.MAV_RESULT_DENIED
_FAILED = dialect.MAV_RESULT_FAILED
_UNSUPPORTED = dialect.MAV_RESULT_UNSUPPORTED


@dataclass(frozen=True, slots=True)
class Command:
    """A command of either form. p is param1..param4; lat and lon are degrees, NaN where not given."""

    number: int
    p: tuple[float, float, float, float]
    x: float
    y: float
    frame: int
    origin: Origin
    now_s: float

    def whole(self, index: int) -> int | None:
        """A parameter as a whole number, None where it is not one."""
        value = self.p[index]
        return int(value) if math.isfinite(value) and value == int(value) else None

    def position(self) -> LatLon | None:
        """Where the command points, None when that is not a place on a global frame."""
        if self.frame not in _GLOBAL_FRAMES or (self.x == 0.0 and self.y == 0.0):
            return None
        try:
            return LatLon(self.x, self.y)
        except ValueError:
            return None


def from_long(message: Message, origin: Origin, now_s: float) -> Command:
    """COMMAND_LONG carries a position as floats in param5 and param6."""
    return Command(
        message.command,
        (message.param1, message.param2, message.param3, message.param4),
        message.param5,
        message.param6,
        dialect.MAV_FRAME_GLOBAL,
        origin,
        now_s,
    )


def from_int(message: Message, origin: Origin, now_s: float) -> Command:
    """COMMAND_INT carries a position as 1e7 integers."""
    return Command(
        message.command,
        (message.param1, message.param2, message.param3, message.param4),
        e7_to_deg(message.x),
        e7_to_deg(message.y),
        message.frame,
        origin,
        now_s,
    )


class CommandService:
    """Carries out commands by asking the vehicle, and acknowledges each."""

    def __init__(self, vehicle: Vehicle, telemetry: TelemetryService, outbox: Outbox) -> None:
        self._vehicle = vehicle
        self._telemetry = telemetry
        self._outbox = outbox
        self._table: dict[int, Callable[[Command], int]] = {
            dialect.MAV_CMD_COMPONENT_ARM_DISARM: self._arm_disarm,
            dialect.MAV_CMD_DO_CHANGE_SPEED: self._change_speed,
            dialect.MAV_CMD_DO_REPOSITION: self._reposition,
            dialect.MAV_CMD_DO_SET_HOME: self._set_home,
            dialect.MAV_CMD_DO_SET_MISSION_CURRENT: self._set_current,
            dialect.MAV_CMD_DO_SET_MODE: self._set_mode,
            dialect.MAV_CMD_GET_MESSAGE_INTERVAL: self._get_interval,
            dialect.MAV_CMD_MISSION_START: self._start_mission,
            dialect.MAV_CMD_NAV_LOITER_UNLIM: lambda _: self._ask(ChangeMode(Mode.LOITER)),
            dialect.MAV_CMD_NAV_RETURN_TO_LAUNCH: lambda _: self._ask(ChangeMode(Mode.RTL)),
            dialect.MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES: self._request_capabilities,
            dialect.MAV_CMD_REQUEST_MESSAGE: self._request_message,
            dialect.MAV_CMD_SET_MESSAGE_INTERVAL: self._set_interval,
        }

    def handle(self, command: Command) -> None:
        """Carry out one command; its ACK goes to the asker alone."""
        carry_out = self._table.get(command.number)
        result = _UNSUPPORTED if carry_out is None else carry_out(command)
        self._outbox.send(
            command.origin.channel,
            dialect.MAVLink_command_ack_message(
                command.number,
                result,
                progress=0,
                result_param2=0,
                target_system=command.origin.address.system,
                target_component=command.origin.address.component,
            ),
        )

    def on_set_mode(self, message: Message, origin: Origin) -> None:
        """SET_MODE, the old way; acknowledged like the command, as ArduPilot does."""
        flags = float(message.base_mode)
        p = (flags, float(message.custom_mode), 0.0, 0.0)
        self.handle(Command(dialect.MAV_CMD_DO_SET_MODE, p, math.nan, math.nan, 0, origin, 0.0))

    def _ask(self, request: Request) -> int:
        return self._result(self._vehicle.request(request))

    @staticmethod
    def _result(outcome: Outcome) -> int:
        result: int = _OK if outcome.accepted else _FAILED
        return result

    def _arm_disarm(self, command: Command) -> int:
        arm, magic = command.whole(0), command.p[1]
        if arm == 1:
            return self._ask(Arm(force=magic == _ARM_MAGIC))
        if arm == 0:
            return self._ask(Disarm("by emergency stop" if magic == _DISARM_MAGIC else "by command"))
        return _DENIED

    def _set_mode(self, command: Command) -> int:
        flags, number = command.whole(0), command.whole(1)
        if flags is None or number is None or not flags & dialect.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED:
            return _DENIED
        return self._ask(ChangeMode(number))

    def _start_mission(self, command: Command) -> int:
        first = command.whole(0)
        return _DENIED if first is None or first < 0 else self._ask(StartMission(first or None))

    def _set_current(self, command: Command) -> int:
        seq = command.whole(0)
        return _DENIED if seq is None else self._ask(SetCurrentItem(seq))

    def _reposition(self, command: Command) -> int:
        position = command.position()
        if position is None:
            return _DENIED
        speed_m_s = command.p[0] if math.isfinite(command.p[0]) and command.p[0] > 0.0 else None
        change_mode = bool((command.whole(1) or 0) & dialect.MAV_DO_REPOSITION_FLAGS_CHANGE_MODE)
        return self._ask(GoTo(position, speed_m_s, change_mode))

    def _change_speed(self, command: Command) -> int:
        speed_m_s = command.p[1]
        if not math.isfinite(speed_m_s) or speed_m_s <= 0.0:
            return _DENIED
        return self._ask(ChangeSpeed(speed_m_s))

    def _set_home(self, command: Command) -> int:
        if command.whole(0) == 1:
            return self._ask(SetHome())
        position = command.position()
        return _DENIED if position is None else self._ask(SetHome(position))

    def _request_message(self, command: Command) -> int:
        return self._send_once(command.whole(0), command.origin)

    def _request_capabilities(self, command: Command) -> int:
        return self._send_once(dialect.MAVLINK_MSG_ID_AUTOPILOT_VERSION, command.origin)

    def _send_once(self, message_id: int | None, origin: Origin) -> int:
        if message_id is None or not self._telemetry.offers(message_id):
            return _UNSUPPORTED
        message = self._telemetry.build(message_id)
        if message is None:
            return _FAILED
        self._outbox.send(origin.channel, message)
        return _OK

    def _set_interval(self, command: Command) -> int:
        message_id = command.whole(0)
        if message_id is None:
            return _DENIED
        channel, interval_us = command.origin.channel, command.p[1]
        done = self._telemetry.set_interval_us(channel, message_id, interval_us, command.now_s)
        return _OK if done else _UNSUPPORTED

    def _get_interval(self, command: Command) -> int:
        message_id = command.whole(0)
        if message_id is None or not 0 <= message_id <= 0xFFFF:
            return _DENIED
        interval_us = self._telemetry.interval_us(command.origin.channel, message_id)
        self._outbox.send(
            command.origin.channel, dialect.MAVLink_message_interval_message(message_id, interval_us)
        )
        return _OK
