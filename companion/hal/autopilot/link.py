"""The conversation with an autopilot, without I/O: whom to listen to, what to ask for, what to send.

Whatever is wanted is asked for by SET_MESSAGE_INTERVAL, and asked for again once it has not come for a while:
after a reboot, or where it was changed by others.
"""

import math
from collections import deque
from typing import Final

from companion.config.boat_config import BoatConfig
from companion.core.status_text import Severity, StatusText
from companion.hal.autopilot.outputs import REASONS, RoverOutputs, command
from companion.hal.autopilot.readings import AutopilotReadings
from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, component_heartbeat, dialect
from companion.sensors.silence import SilenceMonitor

SILENT_S: Final = 0.5  # ATTITUDE comes 40 times a second
_SET_INTERVAL: Final = dialect.MAV_CMD_SET_MESSAGE_INTERVAL
_AUTOPILOT: Final = dialect.MAV_COMP_ID_AUTOPILOT1
_HEARTBEAT_S: Final = 1.0
_ASK_S: Final = 1.0
_TOLD: Final = Severity.WARNING  # texts of the autopilot that the operator gets, and worse ones
_MOST_ROUTED: Final = 256  # of which the boat takes all in its next tick
_INTERVALS_S: Final = {
    dialect.MAVLINK_MSG_ID_ATTITUDE: 0.025,  # ArduPilot gives at most 80 % of its loop's 50 Hz
    dialect.MAVLINK_MSG_ID_GPS_RAW_INT: 0.1,  # tells each fix of 5 Hz within a tenth of a second
    dialect.MAVLINK_MSG_ID_HEARTBEAT: 0.2,
    dialect.MAVLINK_MSG_ID_SYS_STATUS: 0.2,
    dialect.MAVLINK_MSG_ID_SYSTEM_TIME: 1.0,
    dialect.MAVLINK_MSG_ID_RC_CHANNELS: 0.05,
    dialect.MAVLINK_MSG_ID_DISTANCE_SENSOR: 0.1,
}
_FILTERS: Final = {  # the report of its filter, by autopilot
    dialect.MAV_AUTOPILOT_ARDUPILOTMEGA: {dialect.MAVLINK_MSG_ID_EKF_STATUS_REPORT: 0.5},
    dialect.MAV_AUTOPILOT_PX4: {dialect.MAVLINK_MSG_ID_ESTIMATOR_STATUS: 0.5},
}


class AutopilotLink:
    """peer: the autopilot, once heard. ignored: messages of others on the line. routed: for the stations,
    nothing unless it is a component of its own.
    """

    def __init__(self, config: BoatConfig) -> None:
        part = config.parts.autopilot_part
        self.own = Address(part.own_system_id, dialect.MAV_COMP_ID_ONBOARD_COMPUTER)
        self.peer: Address | None = None
        self.readings = AutopilotReadings(config)
        self.outputs = RoverOutputs(config, self.readings)
        self.ignored = 0
        self.texts = self.outputs.texts
        self.routed: deque[Message] = deque(maxlen=_MOST_ROUTED if part.component else 0)
        self._system_id = part.system_id
        self._heard_s = self._beat_s = self._ask_s = -math.inf
        self._came_s: dict[int, float] = {}
        self._intervals_s = _INTERVALS_S
        self._reboots = 0
        self._silence = SilenceMonitor("Autopilot", again="is heard again")

    def handle(self, message: Message, sender: Address, now_s: float) -> None:
        """Take a message. What is not of the autopilot is counted and dropped."""
        number = message.get_msgId()
        if self.peer is None and number == dialect.MAVLINK_MSG_ID_HEARTBEAT:
            is_autopilot = message.autopilot != dialect.MAV_AUTOPILOT_INVALID
            is_named = sender.component == _AUTOPILOT and self._system_id in (0, sender.system)
            self.peer = sender if is_autopilot and is_named else None
            self._intervals_s = _INTERVALS_S | _FILTERS.get(message.autopilot, {})
        if sender != self.peer:
            self.ignored += 1
            return
        self._heard_s = self._came_s[number] = now_s
        self.routed.append(message)
        for table in (self.readings.table, self.outputs.table):
            if (ingest := table.get(number)) is not None:
                ingest(message, now_s)
        if number == dialect.MAVLINK_MSG_ID_STATUSTEXT and message.severity <= _TOLD:
            text = str(message.text).rstrip("\0")
            if not text.startswith(REASONS):
                self.texts.append(StatusText(message.severity, f"Autopilot: {text}"))
        if self.readings.reboots != self._reboots:
            self._reboots = self.readings.reboots
            self.texts.append(StatusText(Severity.WARNING, "Autopilot has rebooted"))
            self.outputs.restart()

    def is_heard(self, now_s: float) -> bool:
        return now_s - self._heard_s <= SILENT_S

    def addressed(self, message: Message) -> Message | None:
        """A station's message with the autopilot as its target; None before it is heard."""
        if self.peer is None:
            return None
        message.target_system, message.target_component = self.peer
        return message

    def tick(self, now_s: float) -> list[Message]:
        """What to send now."""
        is_heard = self.is_heard(now_s)
        if (told := self._silence.update(2.0, now_s, is_heard=is_heard)) is not None:
            self.texts.append(told)
        out: list[Message] = []
        if now_s - self._beat_s >= _HEARTBEAT_S:
            self._beat_s = now_s
            out.append(component_heartbeat(dialect.MAV_TYPE_ONBOARD_CONTROLLER))
        if self.peer is not None and is_heard and now_s - self._ask_s >= _ASK_S:
            self._ask_s = now_s
            for number, interval_s in self._intervals_s.items():
                if now_s - self._came_s.get(number, -math.inf) > max(3.0 * interval_s, SILENT_S):
                    out.append(command(self.peer, _SET_INTERVAL, number, interval_s * 1e6))
        return out + self.outputs.tick(self.peer, is_heard, now_s)
