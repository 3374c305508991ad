"""A ground station in the emulator's process: the client of `mission_tools.station` over a memory link.

It is an onboard controller, as the planner is. An operator's station beside it only sends heartbeats, so that
the boat notices a cut link.
"""

import math
from collections.abc import Sequence

from companion.links.interfaces import Link
from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, dialect
from companion.mavlink.items import MissionItem
from mission_tools.station.commands import Commands
from mission_tools.station.items import KINDS, ItemLists, Kind
from mission_tools.station.line import Signatures, SignedLink
from mission_tools.station.outcome import Answered
from mission_tools.station.requests import BoatCommand
from mission_tools.station.sailing import Sailing
from mission_tools.station.texts import Texts
from mission_tools.station.uploads import ListUpload, Upload
from mission_tools.station.wire import heartbeat

OWN = Address(245, dialect.MAV_COMP_ID_ONBOARD_COMPUTER)
OPERATOR = Address(255, dialect.MAV_COMP_ID_MISSIONPLANNER)  # as ground stations name themselves
UPLOAD_S = 60.0  # longest upload of a short list,
_ITEM_S = 0.2  # and for each item more: it may be lost three times in a row
_RETRIES = 10
_HEARTBEAT_S = 1.0
_UNSIGNED = Signatures(None)

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
        self.has_operator = True
        self._outbox: list[Message] = []  # of an upload, until the next step
        self._joined = Texts(lambda _: True)
        self._commands = Commands(boat, OWN, self.send)
        lists = ItemLists(boat, OWN, self._outbox.append)
        self._sailing = Sailing(boat, OWN, self._outbox.append, self._commands.ask, lists)
        self._heartbeat_s = -math.inf
        self._wanted = _WANTED
        self.connect(link)

    def connect(self, link: Link) -> None:
        """Use another link: the previous one ended with the boat's program."""
        self._line = SignedLink(link, OWN, _UNSIGNED)
        self._operators = SignedLink(link, OPERATOR, _UNSIGNED)

    def listen_to(self, *message_ids: int) -> None:
        """Keep the latest of these messages, too."""
        self._wanted = self._wanted.union(message_ids)

    def send(self, message: Message) -> None:
        """Send anything."""
        self._line.send(message)

    def command(self, command: BoatCommand, answered: Answered, now_s: float) -> None:
        """Send a command, and repeat it until it is answered. answered is called once."""
        self._commands.ask(command, answered, now_s)

    def upload(
        self, items: Sequence[MissionItem], answered: Answered, now_s: float, kind: Kind = "mission"
    ) -> None:
        """Begin to upload a list. answered is called once, within UPLOAD_S and _ITEM_S an item."""
        limit_s = UPLOAD_S + _ITEM_S * len(items)
        upload = Upload((ListUpload(kind, KINDS[kind], items),), None, limit_s, retries=_RETRIES)
        self._sailing.ask(upload, answered, now_s)

    def step(self, now_s: float) -> None:
        """Receive, answer, and send heartbeats."""
        for frame in self._line.frames():
            if frame.message_id in self._wanted and frame.layout is not None:
                self._receive(frame.layout.unpack(frame.payload), now_s)
        self._commands.poll(now_s)
        self._sailing.poll(now_s)
        for message in self._outbox:
            self.send(message)
        self._outbox.clear()
        if now_s - self._heartbeat_s >= _HEARTBEAT_S:
            self._heartbeat_s = now_s
            self.send(heartbeat(is_operator=False))
            if self.has_operator:
                self._operators.send(heartbeat(is_operator=True))

    def _receive(self, message: Message, now_s: float) -> None:
        name = message.get_type()
        self.latest[name] = message
        if name == "MISSION_ITEM_REACHED":
            self.reached.append(message.seq)
        elif name.startswith("MISSION_"):
            self._sailing.handle(message, now_s)
        elif name == "COMMAND_ACK":
            self._commands.on_ack(message, now_s)
        elif name == "STATUSTEXT":
            for text in self._joined.ingest(message, now_s, now_s):
                self.texts.append(text.text)
                self._commands.on_text(text)
