"""Access control: with `identity.only_operator`, only the operator and programs on the boat may change
anything.

As ArduPilot's SYSID_ENFORCE, but other stations still receive everything, and refusals use the protocol's own
answers. Ids can be chosen freely: this prevents mistakes; only signing prevents attacks.
"""

import math
from collections.abc import Container
from dataclasses import dataclass, field

from companion.config.parameters import Parameters
from companion.core.status_text import Severity
from companion.mavlink.dialect import Message, dialect, message_ids
from companion.mavlink.ftp_frames import Code, Opcode, Refusal, nak, parse_request
from companion.mavlink.items import MissionResult
from companion.services.camera.component import QUESTIONS as CAMERA_QUESTIONS
from companion.services.commands.command import Result, acknowledgement
from companion.services.outbox import Origin, Outbox
from companion.services.parameters import ParameterService
from companion.services.statustext import StatusTextService

_REPEAT_S = 30.0

_UPLOADS = message_ids(
    *("MISSION_COUNT", "MISSION_ITEM", "MISSION_ITEM_INT", "MISSION_CLEAR_ALL", "MISSION_WRITE_PARTIAL_LIST")
)
_COMMANDS = message_ids("COMMAND_LONG", "COMMAND_INT")
_CHANGES = (
    *_UPLOADS,
    *message_ids("SET_MODE", "PARAM_SET"),
    # Without an answer in the protocol
    *message_ids("GPS_INJECT_DATA", "GPS_RTCM_DATA", "LOG_ERASE", "MISSION_SET_CURRENT", "SETUP_SIGNING"),
    *message_ids("SET_ATTITUDE_TARGET", "SET_GPS_GLOBAL_ORIGIN"),
    *message_ids("SET_POSITION_TARGET_GLOBAL_INT", "SET_POSITION_TARGET_LOCAL_NED"),
)
# All opcodes below CREATE_FILE read, too
_READING = (*range(Opcode.CREATE_FILE), Opcode.CALC_FILE_CRC32, Opcode.BURST_READ_FILE)


@dataclass(eq=False)
class AccessService:
    """Checks each message before its service."""

    _parameters: Parameters
    _listings: ParameterService
    _questions: Container[int]  # commands that change nothing
    _outbox: Outbox
    _texts: StatusTextService
    _reported_s: dict[int, float] = field(default_factory=dict, init=False)  # last report by system id

    def refuses(self, message: Message, origin: Origin, now_s: float) -> bool:
        """Whether the sender is refused; the answer has then been sent."""
        identity = self._parameters.config.identity
        allowed = (0, origin.address.system)
        if not identity.only_operator or identity.operator_system_id in allowed:
            return False
        if origin.address.system == identity.system_id or not self._is_change(message):
            return False
        self._answer(message, origin)
        if now_s - self._reported_s.get(origin.address.system, -math.inf) >= _REPEAT_S:
            self._reported_s[origin.address.system] = now_s
            text = f"Station {origin.address.system} refused: not the operator (SYSID_ENFORCE)"
            self._texts.notify(Severity.WARNING, text)
        return True

    def _is_change(self, message: Message) -> bool:
        number = message.get_msgId()
        if number in _COMMANDS:
            return message.command not in self._questions and message.command not in CAMERA_QUESTIONS
        if number == dialect.MAVLINK_MSG_ID_FILE_TRANSFER_PROTOCOL:
            request = parse_request(bytes(message.payload))
            return request is not None and request.opcode not in _READING
        return number in _CHANGES

    def _answer(self, message: Message, origin: Origin) -> None:
        number, asker = message.get_msgId(), origin.address
        target = getattr(message, "target_component", 0)
        component = target if target in self._parameters.config.components else 0
        if number == dialect.MAVLINK_MSG_ID_PARAM_SET and not component:
            self._listings.on_request_read(message, origin)
        elif number in _UPLOADS:
            refusal = dialect.MAVLink_mission_ack_message(*asker, MissionResult.DENIED, message.mission_type)
            self._outbox.send(origin.channel, refusal)
        elif number in _COMMANDS:
            refusal = acknowledgement(message.command, Result.DENIED, asker)
            self._outbox.send(origin.channel, refusal, component)
        elif number == dialect.MAVLINK_MSG_ID_SET_MODE:
            refusal = acknowledgement(dialect.MAV_CMD_DO_SET_MODE, Result.DENIED, asker)
            self._outbox.send(origin.channel, refusal)
        elif (
            number == dialect.MAVLINK_MSG_ID_FILE_TRANSFER_PROTOCOL
            and (request := parse_request(bytes(message.payload))) is not None
        ):
            payload = nak(request, Refusal(Code.FILE_PROTECTED))
            refusal = dialect.MAVLink_file_transfer_protocol_message(0, *asker, payload)
            self._outbox.send(origin.channel, refusal, component)
