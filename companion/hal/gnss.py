"""A GNSS receiver with NMEA 0183 output."""

from collections.abc import Callable

from companion.config import parts
from companion.hal.interfaces import Port
from companion.hal.nmea_part import NmeaPart, open_nmea_port
from companion.sensors.nmea import Sentence
from companion.sensors.nmea_fix import GNSS_SENTENCES, FixAssembler
from companion.sensors.readings import GnssFix
from companion.sensors.receiver_clock import ReceiverClock


class NmeaGnss:
    """Satisfies `companion.hal.interfaces.Gnss`.

    Fixes are stamped with the time of measurement, from the receiver's time of day. latency_s: shortest time
    from measurement to the arrival of the first sentence.
    """

    def __init__(self, port: Port, now: Callable[[], float], latency_s: float = 0.0) -> None:
        self._assembler = FixAssembler()
        self._clock = ReceiverClock(latency_s)
        self._latest: GnssFix | None = None
        self.part = NmeaPart(port, now, GNSS_SENTENCES, self._ingest)

    def read(self) -> GnssFix | None:
        """The latest fix, None before the first."""
        return self._latest

    def close(self) -> None:
        """Stop the thread and close the port. May be called twice."""
        self.part.close()

    def _ingest(self, sentence: Sentence, time_s: float) -> None:
        for fix in self._assembler.feed(sentence, time_s):
            self._latest = self._clock.stamp(fix)


def open_nmea_gnss(part: parts.GnssPart, now: Callable[[], float]) -> NmeaGnss:
    """Open the receiver on its port and start reading.

    Raises:
        ConfigError: the port url is invalid.
        LinkError: the port cannot be opened.
    """
    gnss = NmeaGnss(open_nmea_port(part.port, part.baud, now), now, part.latency_s)
    gnss.part.start()
    return gnss
