"""A part that talks NMEA 0183 over a port, read by a thread of its own."""

from collections.abc import Callable

from companion.hal.interfaces import Port
from companion.hal.port_reader import PortReader
from companion.links.port_url import open_port
from companion.sensors.nmea import NmeaReader, Sentence


class NmeaPart:
    """Hands every wanted sentence to `take`, with the time at which it arrived."""

    def __init__(
        self,
        port: Port,
        now: Callable[[], float],
        wanted: frozenset[str],
        take: Callable[[Sentence, float], object],
    ) -> None:
        self.reader = NmeaReader(wanted)
        self._on_sentence = take
        self._port = PortReader(port, now, self._feed, self.reader.forget)

    def start(self) -> None:
        """Begin to read in a thread."""
        self._port.start()

    def step(self) -> None:
        """Take in whatever has arrived. Never waits."""
        self._port.step()

    def close(self) -> None:
        """End the thread and close the port. May be called twice."""
        self._port.close()

    def _feed(self, chunk: bytes, time_s: float) -> None:
        for sentence in self.reader.feed(chunk):
            self._on_sentence(sentence, time_s)


def open_nmea_port(place: str, baud: float, now: Callable[[], float]) -> Port:
    """A serial device at a baud rate, or any other port url (a receiver on the network).

    Raises:
        ConfigError: the url cannot be read.
        LinkError: the system refuses.
    """
    return open_port(f"{place},{int(baud)}" if place.startswith("/") and "," not in place else place, now)
