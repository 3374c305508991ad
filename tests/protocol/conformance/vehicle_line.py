"""A line to a vehicle, live or in simulated time, that may lose, delay, double and reorder what it carries.

Frames are packed and read by pymavlink's own generated code, so that nothing of ours judges itself.
"""

import math
import time
from abc import ABC, abstractmethod
from typing import Any, NamedTuple

from boat_rig import Rig
from pymavlink import mavutil
from pymavlink.dialects.v20 import all as dialect

from companion.boat import TICK_S
from companion.links.interfaces import Link
from sitl.radio.channel import Channel, Quality

Message = Any
PERFECT = Quality()


class Who(NamedTuple):
    """A MAVLink system and component."""

    system: int
    component: int


class Line(ABC):
    """What a station holds in its hand. Time is the line's own, in seconds."""

    def __init__(self, station: Who, quality: Quality = PERFECT, seed: int = 1) -> None:
        self.sent_bytes = self.heard_bytes = 0
        self._up, self._down = Channel(quality, seed), Channel(quality, seed + 1)
        self._codec = dialect.MAVLink(None, srcSystem=station.system, srcComponent=station.component)
        self._codec.robust_parsing = True

    @property
    @abstractmethod
    def now_s(self) -> float:
        """The time."""

    @property
    def quality(self) -> Quality:
        """What the line does to what it carries."""
        return self._up.quality

    @quality.setter
    def quality(self, quality: Quality) -> None:
        self._up.quality = self._down.quality = quality

    def send(self, message: Message) -> None:
        """One message to the vehicle."""
        self.send_bytes(bytes(message.pack(self._codec)))

    def send_bytes(self, data: bytes) -> None:
        """Anything to the vehicle, as one datagram."""
        self.sent_bytes += len(data)
        self._up.send(data, self.now_s)
        self._exchange()

    def listen(self, until_s: float) -> list[Message]:
        """What has arrived; where nothing has, what arrives first until then. Empty when time is up."""
        while True:
            self._exchange()
            arrived = [message for frame in self._down.receive(self.now_s) for message in self._parse(frame)]
            if arrived or self.now_s >= until_s:
                return arrived
            self._wait(min(until_s, self._up.next_s, self._down.next_s))

    def close(self) -> None:  # noqa: B027  only a live line has something to close
        """Hang up."""

    def _parse(self, frame: bytes) -> list[Message]:
        self.heard_bytes += len(frame)
        messages = self._codec.parse_buffer(frame) or []
        return [message for message in messages if message.get_type() != "BAD_DATA"]

    @abstractmethod
    def _exchange(self) -> None:
        """Hand over to the vehicle what has arrived there, and take what it has said."""

    @abstractmethod
    def _wait(self, until_s: float) -> None:
        """Let time go by, until then at most."""


class SimulatedLine(Line):
    """To a whole boat in simulated water: the boat's tick is its clock, and what arrives between is heard."""

    def __init__(
        self, rig: Rig, station: Who, quality: Quality = PERFECT, seed: int = 1, link: Link | None = None
    ) -> None:
        self._rig = rig
        self._link = link or rig.peer.link
        self._now_s = rig.now_s
        super().__init__(station, quality, seed)

    @property
    def now_s(self) -> float:
        """Simulated seconds; another line's waiting lets them go by here too."""
        return max(self._now_s, self._rig.now_s - TICK_S)

    def _exchange(self) -> None:
        now_s = self.now_s
        if frames := self._up.receive(now_s):
            for frame in frames:
                self._link.send(frame)
            self._rig.boat.receive(now_s)
        for frame in self._link.receive():
            self._down.send(frame, now_s)

    def _wait(self, until_s: float) -> None:
        tick_s = self._rig.now_s
        if tick_s <= until_s:
            self._now_s = max(tick_s, self._now_s)
            self._rig.step()
        else:
            self._now_s = until_s


class LiveLine(Line):
    """To any vehicle, by a connection string as pymavlink and MAVProxy take it."""

    def __init__(self, url: str, station: Who, quality: Quality = PERFECT, seed: int = 1) -> None:
        super().__init__(station, quality, seed)
        self._connection = mavutil.mavlink_connection(
            url, source_system=station.system, source_component=station.component, retries=1
        )

    @property
    def now_s(self) -> float:
        """Of a clock that only goes forward."""
        return time.monotonic()

    def close(self) -> None:
        """Hang up."""
        self._connection.close()

    def _exchange(self) -> None:
        for frame in self._up.receive(self.now_s):
            self._connection.write(frame)
        while (message := self._connection.recv_msg()) is not None:
            self._take(message)

    def _wait(self, until_s: float) -> None:
        left_s = min(until_s - self.now_s, 0.1)
        if left_s > 0.0 and math.isfinite(left_s):
            message = self._connection.recv_match(blocking=True, timeout=left_s)
            if message is not None:
                self._take(message)

    def _take(self, message: Message) -> None:
        if message.get_type() != "BAD_DATA":
            self._down.send(bytes(message.get_msgbuf()), self.now_s)
