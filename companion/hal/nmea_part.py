"""A part with NMEA 0183 output on a port, read in a thread."""

from collections.abc import Callable

from companion.hal.interfaces import Port
from companion.hal.port_reader import PortReader
from companion.links.port_url import open_port
from companion.sensors.nmea import NmeaReader, Sentence


class NmeaPart:
    """Passes each wanted sentence to `take`, with its arrival time."""

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
        """Process received bytes. Never waits."""
        self._port.step()

    def close(self) -> None:
        """Stop the thread and close the port. May be called twice."""
        self._port.close()

    def _feed(self, chunk: bytes, time_s: float) -> None:
        for sentence in self.reader.feed(chunk):
            self._on_sentence(sentence, time_s)


def open_nmea_port(place: str, baud: float, now: Callable[[], float]) -> Port:
    """Open a serial device at a baud rate, or any other port url.

    Raises:
        ConfigError: the url is invalid.
        LinkError: the port cannot be opened.
    """
    return open_port(f"{place},{int(baud)}" if place.startswith("/") and "," not in place else place, now)
