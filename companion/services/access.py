"""Access control: with `identity.only_operator`, only the operator and programs on the boat may change
anything.

As ArduPilot's SYSID_ENFORCE, but other stations still receive everything, and refusals use the protocol's own
answers. Ids can be chosen freely: this prevents mistakes; only signing prevents attacks.
"""

import math
from collections.abc import Container

from companion.config.parameters import Parameters
from companion.core.status_text import Severity
from companion.mavlink.dialect import Message, dialect
from companion.mavlink.ftp_frames import Code, Opcode, Refusal, nak, parse_request
from companion.mavlink.items import MissionResult
from companion.services.camera.component import QUESTIONS as CAMERA_QUESTIONS
from companion.services.commands.command import DENIED
from companion.services.outbox import Origin, Outbox
from companion.services.parameters import ParameterService
from companion.services.telemetry.statustext import StatusTextService

_REPEAT_S = 30.0

_UPLOADS = frozenset(
    (
        dialect.MAVLINK_MSG_ID_MISSION_COUNT,
        dialect.MAVLINK_MSG_ID_MISSION_ITEM,
        dialect.MAVLINK_MSG_ID_MISSION_ITEM_INT,
        dialect.MAVLINK_MSG_ID_MISSION_CLEAR_ALL,
        dialect.MAVLINK_MSG_ID_MISSION_WRITE_PARTIAL_LIST,
    )
)
_COMMANDS = frozenset((dialect.MAVLINK_MSG_ID_COMMAND_LONG, dialect.MAVLINK_MSG_ID_COMMAND_INT))
# Messages without an answer in the protocol
_UNANSWERED = frozenset(
    (
        dialect.MAVLINK_MSG_ID_GPS_INJECT_DATA,
        dialect.MAVLINK_MSG_ID_GPS_RTCM_DATA,
        dialect.MAVLINK_MSG_ID_LOG_ERASE,
        dialect.MAVLINK_MSG_ID_MISSION_SET_CURRENT,
        dialect.MAVLINK_MSG_ID_SET_ATTITUDE_TARGET,
        dialect.MAVLINK_MSG_ID_SET_GPS_GLOBAL_ORIGIN,
        dialect.MAVLINK_MSG_ID_SET_POSITION_TARGET_GLOBAL_INT,
        dialect.MAVLINK_MSG_ID_SET_POSITION_TARGET_LOCAL_NED,
        dialect.MAVLINK_MSG_ID_SETUP_SIGNING,
    )
)
_READING = frozenset(
    (
        Opcode.NONE,
        Opcode.TERMINATE_SESSION,
        Opcode.RESET_SESSIONS,
        Opcode.LIST_DIRECTORY,
        Opcode.OPEN_FILE_RO,
        Opcode.READ_FILE,
        Opcode.CALC_FILE_CRC32,
        Opcode.BURST_READ_FILE,
    )
)


class AccessService:
    """Checks each message before its service."""

    def __init__(
        self,
        parameters: Parameters,
        listings: ParameterService,
        questions: Container[int],
        outbox: Outbox,
        texts: StatusTextService,
    ) -> None:
        """questions: commands that change nothing."""
        self._parameters = parameters
        self._listings = listings
        self._questions = questions
        self._outbox = outbox
        self._texts = texts
        self._reported_s: dict[int, float] = {}  # last report by system id

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
        return (
            number in _UPLOADS
            or number in _UNANSWERED
            or number in (dialect.MAVLINK_MSG_ID_SET_MODE, dialect.MAVLINK_MSG_ID_PARAM_SET)
        )

    def _answer(self, message: Message, origin: Origin) -> None:
        number, asker = message.get_msgId(), origin.address
        if number == dialect.MAVLINK_MSG_ID_PARAM_SET:
            self._listings.on_request_read(_read_of(message), origin)
        elif number in _UPLOADS:
            self._send(
                origin,
                dialect.MAVLink_mission_ack_message(
                    asker.system, asker.component, MissionResult.DENIED, message.mission_type
                ),
            )
        elif number in _COMMANDS or number == dialect.MAVLINK_MSG_ID_SET_MODE:
            command = message.command if number in _COMMANDS else dialect.MAV_CMD_DO_SET_MODE
            self._send(
                origin,
                dialect.MAVLink_command_ack_message(
                    command,
                    DENIED,
                    progress=0,
                    result_param2=0,
                    target_system=asker.system,
                    target_component=asker.component,
                ),
                message.target_component if number in _COMMANDS else 0,
            )
        elif number == dialect.MAVLINK_MSG_ID_FILE_TRANSFER_PROTOCOL:
            request = parse_request(bytes(message.payload))
            if request is not None:
                payload = nak(request, Refusal(Code.FILE_PROTECTED))
                self._send(
                    origin,
                    dialect.MAVLink_file_transfer_protocol_message(0, asker.system, asker.component, payload),
                )

    def _send(self, origin: Origin, message: Message, component: int = 0) -> None:
        self._outbox.send(origin.channel, message, component)


def _read_of(message: Message) -> Message:
    """A request for the parameter that a PARAM_SET names."""
    name = (
        message.param_id
        if isinstance(message.param_id, bytes)
        else message.param_id.encode("ascii", "replace")
    )
    return dialect.MAVLink_param_request_read_message(
        message.target_system, message.target_component, name, -1
    )
