"""A part that talks NMEA 0183 over a port, read by a thread of its own."""

import select
from collections.abc import Callable

from companion.hal.background import Background
from companion.hal.interfaces import Link, Port
from companion.hal.port_url import open_port
from companion.sensors.nmea import NmeaReader, Sentence

_PATIENCE_S = 0.2  # how long one step waits for bytes, and how often an unplugged part is looked for


class NmeaPart:
    """Hands every wanted sentence to `take`, with the time at which it arrived.

    The port brings the part back when it was unplugged.
    """

    def __init__(
        self,
        port: Port,
        now: Callable[[], float],
        wanted: frozenset[str],
        take: Callable[[Sentence, float], object],
    ) -> None:
        self.reader = NmeaReader(wanted)
        self._port = port
        self._now = now
        self._take = take
        self._links: list[Link] = []
        self._background = Background(self._wait_and_step, port.name)

    def start(self) -> None:
        """Begin to read in a thread."""
        self._background.start()

    def step(self) -> None:
        """Take in whatever has arrived. Never waits."""
        for link in self._port.accept():
            self._links.append(link)
            self.reader.forget()  # half a sentence of before does not belong to what comes now
        for link in self._links:
            for chunk in link.receive():
                time_s = self._now()
                for sentence in self.reader.feed(chunk):
                    self._take(sentence, time_s)
        self._links = [link for link in self._links if not link.is_closed]

    def close(self) -> None:
        """End the thread and close the port. May be called twice."""
        self._background.close()
        self._port.close()

    def _wait_and_step(self) -> float:
        waiting = {link.fileno() for link in self._links} | {self._port.fileno()}
        waiting.discard(-1)
        if waiting:
            select.select(list(waiting), [], [], _PATIENCE_S)
        self.step()
        return 0.0 if waiting else _PATIENCE_S


def open_nmea_port(place: str, baud: float, now: Callable[[], float]) -> Port:
    """A serial device at a baud rate, or any other port url (a receiver on the network).

    Raises:
        ConfigError: the url cannot be read.
        LinkError: the system refuses.
    """
    return open_port(f"{place},{int(baud)}" if place.startswith("/") and "," not in place else place, now)
