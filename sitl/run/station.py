"""A ground station in the emulator's process: MAVLink with the boat over a memory link.

It is an onboard controller, as the planner is. An operator's station beside it only sends heartbeats, so that
the boat notices a cut link.
"""

import math
from collections.abc import Sequence

from companion.links.interfaces import Link
from companion.mavlink.address import Address
from companion.mavlink.codec import Encoder
from companion.mavlink.dialect import Message, dialect
from companion.mavlink.finder import FrameFinder
from companion.mavlink.items import MissionItem, MissionResult, MissionType
from companion.mavlink.sender import Sender
from companion.mavlink.transfer import Completed, Failed

OWN = Address(245, dialect.MAV_COMP_ID_ONBOARD_COMPUTER)
OPERATOR = Address(255, dialect.MAV_COMP_ID_MISSIONPLANNER)  # as ground stations name themselves
_HEARTBEAT_S = 1.0

# Messages that the station uses; others are not decoded
_WANTED = frozenset(
    {
        dialect.MAVLINK_MSG_ID_SYS_STATUS,
        dialect.MAVLINK_MSG_ID_STATUSTEXT,
        dialect.MAVLINK_MSG_ID_COMMAND_ACK,
        dialect.MAVLINK_MSG_ID_MISSION_ACK,
        dialect.MAVLINK_MSG_ID_MISSION_REQUEST,
        dialect.MAVLINK_MSG_ID_MISSION_REQUEST_INT,
        dialect.MAVLINK_MSG_ID_MISSION_ITEM_REACHED,
    }
)


class Station:
    """Uploads, commands, and keeps the latest message of each type that it acts on.

    has_operator: an operator's heartbeats go out beside the station's own; False: the operator is silent.
    """

    def __init__(self, link: Link, boat: Address) -> None:
        self.boat = boat
        self.latest: dict[str, Message] = {}
        self.texts: list[str] = []
        self.reached: list[int] = []
        self.uploaded: bool | None = None  # None while an upload is under way
        self.refusal = ""
        self._link = link
        self._finder = FrameFinder(link.is_datagram)
        self._encoder = Encoder(OWN)
        self._operators = Encoder(OPERATOR)
        self.has_operator = True
        self._sender = Sender(OWN, MissionType.MISSION)
        self._acks: dict[int, int] = {}
        self._heartbeat_s = -math.inf
        self._wanted = _WANTED

    def connect(self, link: Link) -> None:
        """Use another link: the previous one ended with the boat's program."""
        self._link = link
        self._finder = FrameFinder(link.is_datagram)

    def listen_to(self, *message_ids: int) -> None:
        """Keep the latest of these messages, too."""
        self._wanted = self._wanted.union(message_ids)

    def send(self, message: Message) -> None:
        """Send anything."""
        self._link.send(self._encoder.encode(message))

    def command(self, number: int, *params: float) -> None:
        """Send a COMMAND_LONG; `answer` returns its result."""
        self._acks.pop(number, None)
        values = [*params, *([0.0] * (7 - len(params)))]
        self.send(dialect.MAVLink_command_long_message(*self.boat, number, 0, *values))

    def answer(self, number: int) -> int | None:
        """The MAV_RESULT of the latest command of this number, None while there is none."""
        return self._acks.get(number)

    def upload(
        self, items: Sequence[MissionItem], now_s: float, kind: MissionType = MissionType.MISSION
    ) -> None:
        """Begin to upload a mission or another list; the upload before it must have ended."""
        self.uploaded = None
        if kind is not self._sender.mission_type:
            self._sender = Sender(OWN, kind)
        self._sender.offer(items, self.boat, now_s)

    def step(self, now_s: float) -> None:
        """Receive, answer, and send heartbeats."""
        for chunk in self._link.receive():
            for frame in self._finder.feed(chunk):
                if frame.message_id in self._wanted and frame.layout is not None:
                    self._receive(frame.layout.unpack(frame.payload), frame.sender, now_s)
        if not self._sender.is_idle:
            self._go_on(now_s)
        if now_s - self._heartbeat_s >= _HEARTBEAT_S:
            self._heartbeat_s = now_s
            self.send(_heartbeat(dialect.MAV_TYPE_ONBOARD_CONTROLLER))
            if self.has_operator:
                self._link.send(self._operators.encode(_heartbeat(dialect.MAV_TYPE_GCS)))

    def _go_on(self, now_s: float) -> None:
        sender = self._sender
        sender.tick(now_s)
        for message in sender.take_outbox():
            self.send(message)
        for event in sender.take_events():
            if isinstance(event, Completed | Failed):
                self.uploaded = isinstance(event, Completed)
                self.refusal = "" if isinstance(event, Completed) else self._why(event)

    def _why(self, failed: Failed) -> str:
        """The boat's own message, if there is one."""
        said = [text for text in self.texts if "upload failed" in text or "refused" in text]
        return said[-1] if said else f"{MissionResult(failed.result).name}: {failed.text}"

    def _receive(self, message: Message, sender: Address, now_s: float) -> None:
        name = message.get_type()
        self.latest[name] = message
        if name.startswith("MISSION_"):
            self._sender.handle(message, sender, now_s)
            self._go_on(now_s)
            if name == "MISSION_ITEM_REACHED":
                self.reached.append(message.seq)
        elif name == "COMMAND_ACK":
            self._acks[message.command] = message.result
        elif name == "STATUSTEXT":
            self.texts.append(str(message.text).rstrip("\x00"))


def _heartbeat(mav_type: int) -> Message:
    message: Message = dialect.MAVLink_heartbeat_message(
        mav_type, dialect.MAV_AUTOPILOT_INVALID, 0, 0, dialect.MAV_STATE_ACTIVE, 3
    )
    return message
