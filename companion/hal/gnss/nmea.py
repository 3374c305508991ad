"""GNSS receiver with NMEA 0183 output on a port."""

from collections.abc import Callable, Iterable

from companion.config.parts import GnssPart
from companion.hal.gnss.receiver import GnssReceiver
from companion.links.port_url import open_line
from companion.links.serial_port import SerialPort
from companion.sensors.gnss_heading import GnssHeading
from companion.sensors.readings import GnssFix

_BAUD = 9600  # of most receivers as delivered


class NmeaGnss(GnssReceiver):
    """A receiver that is used as it is."""

    def _decode(self, chunk: bytes, time_s: float) -> Iterable[GnssFix]:
        return self._read_sentences(chunk, time_s)


def open_nmea_gnss(part: GnssPart, now: Callable[[], float], heading: GnssHeading | None = None) -> NmeaGnss:
    """Open the receiver on its port and start reading. heading: of its two antennas, if they are used.

    Raises:
        ConfigError: the port url is invalid.
        LinkError: the port cannot be opened.
    """
    baud = int(part.baud) or _BAUD
    port = open_line(part.port, baud, now)
    return NmeaGnss(
        port, now, part.latency_s, heading, baud if isinstance(port, SerialPort) else None
    ).start()
