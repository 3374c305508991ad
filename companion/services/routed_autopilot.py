"""An autopilot behind the boat, which stations reach as a component of the boat.

They read and set its parameters, calibrate its sensors and fetch its files and logs. It stays no vehicle: its
heartbeat is an onboard controller's, its telemetry stays on its own line, and what would drive or arm it
never reaches it.
"""

from collections import OrderedDict
from typing import Final

from companion.core.status_text import Severity
from companion.hal.interfaces import MavlinkPart
from companion.mavlink.address import ALL, Address
from companion.mavlink.dialect import Message, component_heartbeat, constants, dialect, message_ids
from companion.services.commands.command import Result, acknowledgement
from companion.services.outbox import Origin, Outbox
from companion.vehicle.vehicle import Vehicle

_KIND: Final = dialect.MAV_TYPE_ONBOARD_CONTROLLER  # which no station takes for a vehicle
_HEARTBEAT_S: Final = 1.0
_ASKING_S: Final = 60.0  # answers without a target go to who has asked within this time, as log downloads do
_MOST_ASKERS: Final = 32
_COMMANDS: Final = message_ids("COMMAND_LONG", "COMMAND_INT")
_PASSED: Final = message_ids(
    *("PARAM_REQUEST_LIST", "PARAM_REQUEST_READ", "PARAM_SET", "FILE_TRANSFER_PROTOCOL", "COMMAND_ACK"),
    *("LOG_REQUEST_LIST", "LOG_REQUEST_DATA", "LOG_REQUEST_END", "LOG_ERASE"),
)
_ANSWERS: Final = message_ids(  # of those without a target
    *("PARAM_VALUE", "LOG_ENTRY", "LOG_DATA", "MAG_CAL_PROGRESS", "MAG_CAL_REPORT", "STATUSTEXT"),
    *("COMMAND_LONG", "AUTOPILOT_VERSION", "MESSAGE_INTERVAL"),
)
_QUESTIONS: Final = constants(
    *("MAV_CMD", "REQUEST_MESSAGE", "REQUEST_AUTOPILOT_CAPABILITIES", "GET_MESSAGE_INTERVAL"),
    *("RUN_PREARM_CHECKS", "DO_SEND_BANNER"),
)
_CHANGES: Final = constants(  # only while the boat is disarmed
    *("MAV_CMD", "PREFLIGHT_CALIBRATION", "PREFLIGHT_STORAGE", "PREFLIGHT_REBOOT_SHUTDOWN"),
    *("DO_START_MAG_CAL", "DO_ACCEPT_MAG_CAL", "DO_CANCEL_MAG_CAL", "FIXED_MAG_CAL_YAW"),
    "ACCELCAL_VEHICLE_POS",
)


class RoutedAutopilot:
    """Passes messages between stations and an autopilot's line."""

    handled = frozenset((*_COMMANDS, *_PASSED))

    def __init__(self, component: int, part: MavlinkPart, vehicle: Vehicle, outbox: Outbox) -> None:
        """component: its id under the boat's system id."""
        self.component = component
        self._part = part
        self._vehicle = vehicle
        self._outbox = outbox
        self._askers: OrderedDict[Address, tuple[int, float]] = OrderedDict()  # latest last
        self._due_s = 0.0

    def handle(self, message: Message, origin: Origin, now_s: float) -> None:
        """A message that is addressed to it."""
        number = message.get_msgId()
        if number in _COMMANDS:
            if (refused := self._refusal(message.command)) is not None:
                answer = acknowledgement(message.command, refused, origin.address)
                self._outbox.send(origin.channel, answer, self.component)
                return
        elif number not in _PASSED:
            return
        self._askers[origin.address] = origin.channel, now_s
        self._askers.move_to_end(origin.address)
        if len(self._askers) > _MOST_ASKERS:
            self._askers.popitem(last=False)
        self._part.send(message, origin.address)

    def open(self, channel: int) -> None:
        if self._part.is_heard:
            self._outbox.send(channel, component_heartbeat(_KIND), self.component)

    def tick(self, now_s: float) -> None:
        """Its heartbeat while it is heard, and what it has answered."""
        if now_s >= self._due_s and self._part.is_heard:
            self._due_s = now_s + _HEARTBEAT_S
            self._outbox.broadcast(component_heartbeat(_KIND), self.component)
        for message in self._part.take_messages():
            for channel in self._channels_of(message, now_s):
                self._outbox.send(channel, message, self.component)

    def _refusal(self, command: int) -> Result | None:
        """Why a command does not reach it; None if it does."""
        if command not in (*_CHANGES, *_QUESTIONS):
            return Result.UNSUPPORTED
        if not self._part.is_heard:
            return Result.FAILED
        return Result.DENIED if command in _CHANGES and self._vehicle.armed else None

    def _channels_of(self, message: Message, now_s: float) -> set[int]:
        """Where a message of its line goes."""
        target = Address(getattr(message, "target_system", ALL), getattr(message, "target_component", ALL))
        if target.system != ALL:
            asker = self._askers.get(target)
            return set() if asker is None else {asker[0]}
        number = message.get_msgId()
        is_text = number == dialect.MAVLINK_MSG_ID_STATUSTEXT
        if number not in _ANSWERS or (is_text and message.severity <= Severity.WARNING):  # told to all
            return set()
        return {channel for channel, asked_s in self._askers.values() if now_s - asked_s <= _ASKING_S}
