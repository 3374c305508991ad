"""The conversation with an autopilot, without I/O: whom to listen to, what to ask for, what to send.

Whatever is wanted is asked for by SET_MESSAGE_INTERVAL, and asked for again once it has not come for a while:
after a reboot, or where it was changed by others.
"""

import math
from collections import deque
from typing import Final

from companion.config.boat_config import BoatConfig
from companion.core.status_text import Severity, StatusText
from companion.hal.autopilot.outputs import RoverOutputs
from companion.hal.autopilot.readings import AutopilotReadings
from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, build_message, dialect
from companion.sensors.silence import SilenceMonitor

SILENT_S: Final = 0.5  # ATTITUDE comes 40 times a second
_AUTOPILOT: Final = dialect.MAV_COMP_ID_AUTOPILOT1
_HEARTBEAT_S: Final = 1.0
_ASK_S: Final = 1.0
_TOLD: Final = Severity.WARNING  # texts of the autopilot that the operator gets, and worse ones
_INTERVALS_S: Final = {
    dialect.MAVLINK_MSG_ID_ATTITUDE: 0.025,  # ArduPilot gives at most 80 % of its loop's 50 Hz
    dialect.MAVLINK_MSG_ID_GPS_RAW_INT: 0.1,  # tells each fix of 5 Hz within a tenth of a second
    dialect.MAVLINK_MSG_ID_HEARTBEAT: 0.2,
    dialect.MAVLINK_MSG_ID_EKF_STATUS_REPORT: 0.5,
    dialect.MAVLINK_MSG_ID_SYS_STATUS: 0.5,
    dialect.MAVLINK_MSG_ID_SYSTEM_TIME: 1.0,
    dialect.MAVLINK_MSG_ID_RC_CHANNELS: 0.05,
    dialect.MAVLINK_MSG_ID_DISTANCE_SENSOR: 0.1,
}


class AutopilotLink:
    """peer: the autopilot, once heard. outputs: None where the boat has motors of its own.

    ignored: messages of others on the line.
    """

    def __init__(self, config: BoatConfig) -> None:
        part, fitted = config.parts.autopilot_part, config.parts
        self.own = Address(part.own_system_id, dialect.MAV_COMP_ID_ONBOARD_COMPUTER)
        self.peer: Address | None = None
        self.readings = AutopilotReadings(config)
        self.outputs = RoverOutputs(config) if fitted.motors.driver == "autopilot" else None
        self.ignored = 0
        self.texts = deque[StatusText](maxlen=8) if self.outputs is None else self.outputs.texts
        self._system_id = part.system_id
        self._is_compass = fitted.compass.driver == "autopilot"
        self._heard_s = self._beat_s = self._ask_s = -math.inf
        self._came_s: dict[int, float] = {}
        self._reboots = 0
        self._silence = SilenceMonitor("Autopilot", again="is heard again")

    def handle(self, message: Message, sender: Address, now_s: float) -> None:
        """Take a message. What is not of the autopilot is counted and dropped."""
        if self.peer is None:
            self.peer = self._introduced(message, sender)
        if sender != self.peer:
            self.ignored += 1
            return
        self._heard_s = self._came_s[message.get_msgId()] = now_s
        if (ingest := self.readings.table.get(message.get_msgId())) is not None:
            ingest(message, now_s)
        name = message.get_type()
        if name == "STATUSTEXT":
            self._on_text(message, now_s)
        elif self.outputs is not None:
            if name == "HEARTBEAT":
                self.outputs.on_heartbeat(message)
            elif name == "SYS_STATUS":
                has_heading = not self._is_compass or self.readings.has_heading(now_s)
                self.outputs.on_health(self.readings.enabled, self.readings.health, has_heading=has_heading)
            elif name == "RC_CHANNELS":
                self.outputs.on_channels(message, now_s)
            elif name == "PARAM_VALUE":
                self.outputs.parameters.ingest(message)
        if self.readings.reboots != self._reboots:
            self._reboots = self.readings.reboots
            self.texts.append(StatusText(Severity.WARNING, "Autopilot has rebooted"))
            if self.outputs is not None:
                self.outputs.restart()

    def _introduced(self, message: Message, sender: Address) -> Address | None:
        """The sender, if this is the heartbeat of the autopilot."""
        is_autopilot = (
            message.get_type() == "HEARTBEAT"
            and message.autopilot != dialect.MAV_AUTOPILOT_INVALID
            and sender.component == _AUTOPILOT
            and self._system_id in (0, sender.system)
        )
        return sender if is_autopilot else None

    def _on_text(self, message: Message, now_s: float) -> None:
        text = str(message.text).rstrip("\0")
        if self.outputs is not None:
            self.outputs.on_text(text, now_s)
        if message.severity <= _TOLD and not text.startswith(("PreArm: ", "Arm: ")):
            self.texts.append(StatusText(message.severity, f"Autopilot: {text}"))

    def tick(self, now_s: float) -> list[Message]:
        """What to send now."""
        is_heard = now_s - self._heard_s <= SILENT_S
        if (told := self._silence.update(2.0, now_s, is_heard=is_heard)) is not None:
            self.texts.append(told)
        out: list[Message] = []
        if now_s - self._beat_s >= _HEARTBEAT_S:
            self._beat_s = now_s
            kind = dialect.MAV_TYPE_ONBOARD_CONTROLLER
            out.append(build_message("HEARTBEAT", type=kind, autopilot=8, system_status=4, mavlink_version=3))
        if self.peer is not None and is_heard and now_s - self._ask_s >= _ASK_S:
            self._ask_s = now_s
            out += [self._asked(number, self.peer) for number in self._overdue(now_s)]
        if self.outputs is not None:
            out += self.outputs.tick(self.peer, is_heard, now_s)
        return out

    def _overdue(self, now_s: float) -> list[int]:
        return [
            number
            for number, interval_s in _INTERVALS_S.items()
            if now_s - self._came_s.get(number, -math.inf) > max(3.0 * interval_s, SILENT_S)
        ]

    def _asked(self, number: int, peer: Address) -> Message:
        return build_message(
            "COMMAND_LONG",
            target_system=peer.system,
            target_component=peer.component,
            command=dialect.MAV_CMD_SET_MESSAGE_INTERVAL,
            param1=number,
            param2=_INTERVALS_S[number] * 1e6,
        )

    def farewell(self) -> list[Message]:
        """What to send before the line is closed."""
        return [] if self.outputs is None or self.peer is None else self.outputs.farewell(self.peer)

    def take_texts(self) -> list[StatusText]:
        """Messages to the operator since the last call."""
        return [self.texts.popleft() for _ in range(len(self.texts))]
