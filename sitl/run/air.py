"""The radio between boat and stations: links and ports with the scenario's loss, delay and bandwidth.

The same model serves lockstep (a memory link) and real time (TCP, UDP, serial): it sits on the boat's side
of a link, between `Boat` and the link's driver. On a stream a chunk counts as a datagram, so a lossy stream
loses whole chunks, as a serial radio does.
"""

from collections.abc import Callable

from companion.links.interfaces import Link, Port
from sitl.radio.channel import WHOLE, Channel, LinkSettings, Quality
from sitl.world.computer import Computer
from sitl.world.sampling import generator

_SILENT = Quality(loss=1.0)


class Air:
    """The quality that all links of a boat share: the scenario's, reduced by faults.

    is_perfect: without faults, links are not degraded.
    """

    def __init__(
        self, settings: LinkSettings, seed: int, computer: Computer, now: Callable[[], float]
    ) -> None:
        """now: the world's time."""
        own = settings.quality
        self.computer = computer
        self.now = now
        self._own = own if own != Quality(backlog_s=own.backlog_s) else WHOLE
        self._outages = sorted(settings.outages)
        self.is_perfect = self._own is WHOLE and not self._outages
        self._seed = seed
        self._links = 0
        self._faulty, self._joined = WHOLE, self._own

    def quality(self, now_s: float) -> Quality:
        """The quality for messages sent now."""
        if any(from_s <= now_s < to_s for from_s, to_s in self._outages):
            return _SILENT
        faulty = self.computer.link_quality
        if faulty is not self._faulty:
            self._faulty, self._joined = faulty, self._own.with_(faulty)
        return self._joined

    def channels(self) -> tuple[Channel, Channel]:
        """To the boat and from it, for one more link."""
        self._links += 1
        seeds = generator(self._seed, f"link/{self._links}")
        return Channel(WHOLE, seeds.getrandbits(64)), Channel(WHOLE, seeds.getrandbits(64))


class AirLink:
    """Satisfies `companion.hal.interfaces.Link` over another link."""

    def __init__(self, link: Link, air: Air) -> None:
        self._link = link
        self._air = air
        self.name, self.is_datagram = link.name, link.is_datagram
        self._inward, self._outward = air.channels()

    @property
    def host(self) -> str:
        """The driver's."""
        return self._link.host

    @property
    def is_closed(self) -> bool:
        """True once the far side is gone and nothing is on its way any more."""
        return self._link.is_closed and self._inward.is_empty

    def receive(self) -> list[bytes]:
        """What has come through by now; what is due to leave does."""
        if self._is_open():
            return self._link.receive()
        now_s = self._air.now()
        inward = self._inward
        inward.quality = self._air.quality(now_s)
        for chunk in self._link.receive():
            inward.send(chunk, now_s)
        self._flush(now_s)
        return inward.receive(now_s)

    def send(self, data: bytes) -> bool:
        """Send a frame, which may be lost."""
        if self._is_open():
            return self._link.send(data)
        now_s = self._air.now()
        self._outward.quality = self._air.quality(now_s)
        self._outward.send(bytes(data), now_s)
        self._flush(now_s)
        return True

    def _is_open(self) -> bool:
        """Nothing between the driver and the boat, and nothing left from when there was."""
        air = self._air
        if not (air.is_perfect and air.computer.link_quality is WHOLE):
            return False
        return self._inward.is_empty and self._outward.is_empty

    def _flush(self, now_s: float) -> None:
        for data in self._outward.receive(now_s):
            self._link.send(data)

    def fileno(self) -> int:
        """The driver's."""
        return self._link.fileno()

    def close(self) -> None:
        """Close the driver's link. May be called twice."""
        self._link.close()


class AirPort:
    """Satisfies `companion.hal.interfaces.Port`: its links go through the air."""

    def __init__(self, port: Port, air: Air) -> None:
        self._port = port
        self._air = air
        self.name = port.name

    def accept(self) -> list[Link]:
        """Links that came into being since the last call."""
        return [AirLink(link, self._air) for link in self._port.accept()]

    def fileno(self) -> int:
        """The driver's."""
        return self._port.fileno()

    def close(self) -> None:
        """Close, with every link that came out of it. May be called twice."""
        self._port.close()
