"""All boats heard on one port. No thread, no sleep: the server polls it.

Boats(port).poll(now_s, unix_s) reads, answers PING, sends the heartbeat, and lets each boat repeat and ask.
"""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Final

import msgspec

from companion.links.port_url import open_port
from companion.mavlink.address import Address, concerns
from companion.mavlink.codec import Encoder
from companion.mavlink.dialect import Message, dialect
from companion.mavlink.finder import FrameFinder
from companion.mavlink.items import MissionItem
from companion.shore.messages import Answer, BoatName, Request, Sensor, Snapshot
from companion.shore.parameters.book import Book
from companion.shore.station.board import Board
from companion.shore.station.boat import WANTED, ShoreBoat
from companion.shore.station.commands import Answered
from companion.shore.station.ftp.client import FtpClient
from companion.shore.station.items import Kind
from companion.shore.station.logs import LogList
from companion.shore.station.uploads import Upload
from companion.shore.station.wire import AUTOPILOT, OWN_COMPONENT, Link, Port, heartbeat
from companion.shore.words import say

SYSTEM_ID: Final = 250
MOST_BOATS: Final = 32
_MOST_LINKS: Final = 64
_HEARTBEAT_S: Final = 1.0
_HEARTBEAT: Final = dialect.MAVLINK_MSG_ID_HEARTBEAT
_PING: Final = dialect.MAVLINK_MSG_ID_PING


class _Line:
    """A link with its framing."""

    def __init__(self, link: Link, own: Address) -> None:
        self.link = link
        self.finder = FrameFinder(link.is_datagram)
        self._encoder = Encoder(own)

    def send(self, message: Message) -> None:
        self.link.send(self._encoder.encode(message))


class Boats:
    """The boats by system id.

    port: an open port, or its url. names: of boats, by system id. status_file: of the boat on this computer.
    is_operator: False while nobody steers from the page: its heartbeats then do not count as the operator's.
    """

    def __init__(
        self,
        port: Port | str,
        system_id: int = SYSTEM_ID,
        names: Mapping[int, str] | None = None,
        status_file: Path | None = None,
    ) -> None:
        """Raises ConfigError or LinkError: the url is invalid or cannot be opened."""
        self.is_operator = True
        self._now_s = 0.0
        self._unix_s = 0.0
        self._port: Port = open_port(port, lambda: self._now_s) if isinstance(port, str) else port
        self._own = Address(system_id, OWN_COMPONENT)
        self._names = dict(names or {})
        self._board = None if status_file is None else Board(status_file)
        self._lines: list[_Line] = []
        self._boats: dict[int, ShoreBoat] = {}
        self._line_of: dict[int, _Line] = {}
        self._heartbeat_s = float("-inf")

    def poll(self, now_s: float, unix_s: float) -> None:
        """Everything that is due. now_s: a clock that never goes back; unix_s: the date."""
        self._now_s, self._unix_s = now_s, unix_s
        self._lines = [line for line in self._lines if not line.link.is_closed]
        self._lines += [_Line(link, self._own) for link in self._port.accept()]
        del self._lines[:-_MOST_LINKS]
        for line in self._lines:
            self._read(line)
        if now_s - self._heartbeat_s >= _HEARTBEAT_S:
            self._heartbeat_s = now_s
            for line in self._lines:
                line.send(heartbeat(self.is_operator))
        for boat in self._boats.values():
            boat.poll(now_s, unix_s)
        if self._board is not None:
            self._board.poll(now_s)

    def close(self) -> None:
        """Close the port. May be called twice."""
        self._port.close()

    def names(self) -> list[BoatName]:
        """The boats, by system id."""
        return [
            boat.in_short(self._names.get(number, ""), self._unix_s)
            for number, boat in sorted(self._boats.items())
        ]

    def snapshot(self, boat: int) -> Snapshot | None:
        """A boat as the page shows it; None if it was never heard."""
        if (one := self._boats.get(boat)) is None:
            return None
        snapshot = one.snapshot()
        if self._board is None or boat != min(self._boats):
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
        is_here = self._board is not None and boat == min(self._boats)
        board = self._board.fields() if self._board is not None and is_here else {}
        return one.sensors(board, self._now_s)

    def track(self, boat: int) -> list[tuple[float, float]]:
        """Where the boat was, longitude and latitude, oldest first."""
        one = self._boats.get(boat)
        return [] if one is None else list(one.view.track.points)

    def files(self, boat: int) -> FtpClient | None:
        """The boat's files; None if it was never heard."""
        one = self._boats.get(boat)
        return None if one is None else one.files

    @property
    def is_uploading(self) -> bool:
        """Whether a mission is on its way to a boat, or back."""
        return any(boat.is_uploading for boat in self._boats.values())

    def mission(self, boat: int) -> tuple[MissionItem, ...] | None:
        """The mission on board, home first; None while it is not downloaded."""
        one = self._boats.get(boat)
        return None if one is None else one.lists.items("mission")

    def upload(self, boat: int, upload: Upload, answered: Answered) -> None:
        """Give a boat a mission. answered is called exactly once, soon after the upload's limit at last."""
        if (one := self._boats.get(boat)) is None:
            answered(False, f"Boat {boat} was never heard")
            return
        one.upload(upload, answered, self._now_s)

    def parameters(self, boat: int) -> Book | None:
        """A boat's parameters; None if it was never heard."""
        one = self._boats.get(boat)
        return None if one is None else one.parameters

    def logs(self, boat: int) -> LogList | None:
        """The boat's logs; None if it was never heard."""
        one = self._boats.get(boat)
        return None if one is None else one.logs

    def ask(self, request: Request, answer: Callable[[Answer], None]) -> None:
        """Do what the page asks. answer is called exactly once, within 10 s if polled."""
        if (one := self._boats.get(request.boat)) is None:
            answer(Answer(id=request.id, ok=False, text=say("answer.never_heard", n=request.boat)))
            return
        one.ask(request, answer, self._now_s)

    def _read(self, line: _Line) -> None:
        for chunk in line.link.receive():
            line.finder.put(chunk)
            for frame in line.finder.find():
                if frame.layout is None or frame.sender.system in (0, self._own.system):
                    continue
                if frame.message_id == _PING:
                    self._answer_ping(line, frame.layout.unpack(frame.payload), frame.sender)
                elif frame.message_id in WANTED and frame.sender.component == AUTOPILOT:
                    self._take(line, frame.layout.unpack(frame.payload), frame.sender)

    def _take(self, line: _Line, message: Message, sender: Address) -> None:
        boat = self._boats.get(sender.system)
        if boat is None:
            if not _is_boat(message) or len(self._boats) >= MOST_BOATS:
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

    def _answer_ping(self, line: _Line, ping: Message, sender: Address) -> None:
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
