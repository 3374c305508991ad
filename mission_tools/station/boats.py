"""All boats heard on one port. No thread, no sleep: the server polls it.

Boats(port).poll(now_s, unix_s) reads, answers PING, sends the heartbeat, and lets each boat repeat and ask.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

import msgspec

from companion.links.interfaces import Port
from companion.links.port_url import open_port
from companion.mavlink.address import Address, concerns
from companion.mavlink.dialect import Message, dialect
from companion.mavlink.signing_key import SigningKey
from mission_tools.station.board import Board
from mission_tools.station.boat import SILENT_S, WANTED, ShoreBoat
from mission_tools.station.items import Kind
from mission_tools.station.line import Signatures, SignedLink
from mission_tools.station.messages import Answer, BoatName, PageRequest, Sensor, Snapshot
from mission_tools.station.outcome import Answered, Refused
from mission_tools.station.uploads import Upload
from mission_tools.station.wire import AUTOPILOT, OWN_COMPONENT, heartbeat
from mission_tools.station.words import say

SYSTEM_ID: Final = 250
MOST_BOATS: Final = 32
FORGOTTEN_S: Final = 3600.0  # a boat that is lost is looked for at its last place
_MOST_LINKS: Final = 64
_HEARTBEAT_S: Final = 1.0
_HEARTBEAT: Final = dialect.MAVLINK_MSG_ID_HEARTBEAT
_PING: Final = dialect.MAVLINK_MSG_ID_PING


class Boats:
    """The boats by system id.

    port: an open port, or its url. status_file: of the boat on this computer.
    key: of signed links.
    is_operator: False while nobody steers from the page: its heartbeats then do not count as the operator's.
    """

    def __init__(
        self,
        port: Port | str,
        system_id: int = SYSTEM_ID,
        status_file: Path | None = None,
        key: SigningKey | None = None,
    ) -> None:
        """Raises ConfigError or LinkError: the url is invalid or cannot be opened."""
        self.is_operator = True
        self._now_s = 0.0
        self._unix_s = 0.0
        self._port: Port = open_port(port, lambda: self._now_s) if isinstance(port, str) else port
        self._own = Address(system_id, OWN_COMPONENT)
        self._board = None if status_file is None else Board(status_file)
        self._signatures = Signatures(key)
        self._lines: list[SignedLink] = []
        self._boats: dict[int, ShoreBoat] = {}
        self._line_of: dict[int, SignedLink] = {}
        self._heartbeat_s = float("-inf")

    def poll(self, now_s: float, unix_s: float) -> None:
        """Everything that is due. now_s: a clock that never goes back; unix_s: the date."""
        self._now_s, self._unix_s = now_s, unix_s
        self._signatures.poll(unix_s)
        self._lines = [line for line in self._lines if not line.link.is_closed]
        self._lines += [SignedLink(link, self._own, self._signatures) for link in self._port.accept()]
        del self._lines[:-_MOST_LINKS]
        for line in self._lines:
            self._read(line)
        if now_s - self._heartbeat_s >= _HEARTBEAT_S:
            self._heartbeat_s = now_s
            for line in self._lines:
                line.send(heartbeat(self.is_operator))
        for number, boat in list(self._boats.items()):
            boat.poll(now_s, unix_s)
            if boat.silent_s(now_s) > FORGOTTEN_S and number != self.first:
                self._forget(number)
        if self._board is not None:
            self._board.poll(now_s)

    def close(self) -> None:
        self._port.close()

    @property
    def first(self) -> int | None:
        """The boat of this computer, as its status file says, or else the one that was heard first."""
        own = None if self._board is None else self._board.boat
        return own if own in self._boats else next(iter(self._boats), None)

    def filenos(self) -> list[int]:
        """Descriptors to wait on for what the boats send."""
        return sorted({number for line in self._lines if (number := line.link.fileno()) >= 0})

    def names(self) -> list[BoatName]:
        """The boats, by system id."""
        return [boat.in_short(self._unix_s) for _, boat in sorted(self._boats.items())]

    def get(self, boat: int) -> ShoreBoat | None:
        """A boat with its lists, files, logs and parameters; None if it was never heard."""
        return self._boats.get(boat)

    def snapshot(self, boat: int) -> Snapshot | None:
        """A boat as the page shows it; None if it was never heard."""
        if (one := self._boats.get(boat)) is None:
            return None
        snapshot = one.snapshot()
        if self._board is None or boat != self.first:
            return snapshot
        return msgspec.structs.replace(snapshot, **self._board.fields())

    def items(self, boat: int, kind: Kind) -> dict[str, Any] | None:
        """A list as GeoJSON; None while it is not downloaded."""
        one = self._boats.get(boat)
        return None if one is None else one.lists.geojson(kind)

    def sensors(self, boat: int) -> list[Sensor] | None:
        """The parts of a boat, asked for until 3 s from now; None if it was never heard."""
        if (one := self._boats.get(boat)) is None:
            return None
        board = {} if self._board is None or boat != self.first else self._board.fields()
        return one.sensors(board, self._now_s)

    @property
    def is_transferring(self) -> bool:
        """Whether a list is on its way to a boat, or back."""
        return any(boat.is_transferring for boat in self._boats.values())

    def upload(self, boat: int, upload: Upload, answered: Answered) -> None:
        """Give a boat a mission. answered is called exactly once, soon after the upload's limit at last."""
        if (one := self._boats.get(boat)) is None:
            answered(Refused(say("answer.never_heard", n=boat)))
            return
        one.upload(upload, answered, self._now_s)

    def ask(self, request: PageRequest, answer: Callable[[Answer], None]) -> None:
        """Do what the page asks. answer is called exactly once, within 10 s if polled."""
        if (one := self._boats.get(request.boat)) is None:
            answer(Answer(id=request.id, ok=False, text=say("answer.never_heard", n=request.boat)))
            return
        one.ask(request, answer, self._now_s)

    def _read(self, line: SignedLink) -> None:
        for frame in line.frames():
            if frame.layout is None or frame.sender.system in (0, self._own.system):
                continue
            if frame.message_id == _PING:
                self._answer_ping(line, frame.layout.unpack(frame.payload), frame.sender)
            elif frame.message_id in WANTED and frame.sender.component == AUTOPILOT:
                self._take(line, frame.layout.unpack(frame.payload), frame.sender)

    def _make_room(self) -> bool:
        """Whether there is room for a boat: the one that has been silent longest gives way."""
        if len(self._boats) < MOST_BOATS:
            return True
        others = [number for number in self._boats if number != self.first]
        oldest = max(others, key=lambda number: self._boats[number].silent_s(self._now_s))
        if self._boats[oldest].silent_s(self._now_s) < SILENT_S:
            return False
        self._forget(oldest)
        return True

    def _forget(self, number: int) -> None:
        del self._boats[number]
        self._line_of.pop(number, None)

    def _take(self, line: SignedLink, message: Message, sender: Address) -> None:
        boat = self._boats.get(sender.system)
        if boat is None:
            if not _is_boat(message) or not self._make_room():
                return
            boat = self._boats[sender.system] = self._new_boat(sender)
        if self._line_of.get(sender.system) is not line:
            self._line_of[sender.system] = line
            boat.relink()
        boat.handle(message, self._now_s, self._unix_s)

    def _new_boat(self, address: Address) -> ShoreBoat:
        def send(message: Message) -> None:
            self._line_of[address.system].send(message)

        return ShoreBoat(address, self._own, send)

    def _answer_ping(self, line: SignedLink, ping: Message, sender: Address) -> None:
        """The boat serves an unknown address in full once its PING was returned."""
        if ping.target_system == 0 and concerns(self._own, ping.target_system, ping.target_component):
            line.send(dialect.MAVLink_ping_message(ping.time_usec, ping.seq, *sender))


def _is_boat(message: Message) -> bool:
    """A vehicle's heartbeat: not a station's, a gimbal's or a program's."""
    is_vehicle: bool = (
        message.get_msgId() == _HEARTBEAT
        and message.autopilot != dialect.MAV_AUTOPILOT_INVALID
        and message.type != dialect.MAV_TYPE_GCS
    )
    return is_vehicle
