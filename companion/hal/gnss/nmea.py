"""GNSS receiver with NMEA 0183 output on a port."""

from collections.abc import Callable, Iterator
from typing import Final

from companion.config.parts import GnssPart
from companion.core.readings import GnssFix
from companion.core.status_text import Severity
from companion.hal.gnss.receiver import GnssReceiver
from companion.links.interfaces import Port
from companion.links.port_url import open_line
from companion.links.serial_port import SerialPort
from companion.sensors.gnss_heading import GnssHeading

_BAUD: Final = 9600  # of most receivers as delivered
_SILENT_S: Final = 5.0  # receivers send once a second at least, most also without a fix


class NmeaGnss(GnssReceiver):
    """A receiver that is used as it is. Tells when nothing is heard, or no sentence in what is heard."""

    def __init__(
        self,
        port: Port,
        now: Callable[[], float],
        latency_s: float = 0.0,
        heading: GnssHeading | None = None,
        baud: int | None = None,
    ) -> None:
        super().__init__(port, now, latency_s, heading, baud)
        self._sentence_s = now()  # of the latest sentence, at first of the start
        self._noise_bytes = 0  # since then
        self._is_silent = False

    def step(self) -> None:
        """Process received bytes, and send corrections. Never waits."""
        super().step()
        is_silent = self._now() - self._sentence_s > _SILENT_S
        if is_silent and not self._is_silent:
            heard = "sends no sentences; check parts.gnss.baud" if self._noise_bytes else "is silent"
            self.notify(Severity.WARNING, f"GNSS receiver {heard}")
        elif self._is_silent and not is_silent:
            self.notify(Severity.NOTICE, "GNSS receiver measures again")
        self._is_silent = is_silent

    def _decode(self, chunk: bytes, time_s: float) -> Iterator[GnssFix]:
        before = self.reader.accepted + self.reader.skipped
        yield from self._read_sentences(chunk, time_s)
        if self.reader.accepted + self.reader.skipped > before:
            self._sentence_s, self._noise_bytes = time_s, 0
        else:
            self._noise_bytes += len(chunk)


def open_nmea_gnss(part: GnssPart, now: Callable[[], float], heading: GnssHeading | None = None) -> NmeaGnss:
    """Open the receiver on its port and start reading. heading: of its two antennas, if they are used.

    Raises:
        ConfigError: the port url is invalid.
        LinkError: the port cannot be opened.
    """
    baud = int(part.baud) or _BAUD
    port = open_line(part.port, baud, now)
    line_baud = baud if isinstance(port, SerialPort) else None
    return NmeaGnss(port, now, part.latency_s, heading, line_baud).start()
