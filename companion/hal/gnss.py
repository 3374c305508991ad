"""A satellite receiver that talks NMEA 0183."""

from collections.abc import Callable

from companion import parts
from companion.hal.interfaces import Port
from companion.hal.nmea_part import NmeaPart, open_nmea_port
from companion.sensors.nmea import Sentence
from companion.sensors.nmea_fix import GNSS_SENTENCES, FixAssembler
from companion.sensors.readings import GnssFix


class NmeaGnss:
    """Satisfies `companion.hal.interfaces.Gnss`. Fixes bear the time at which their first sentence came."""

    def __init__(self, port: Port, now: Callable[[], float]) -> None:
        self._assembler = FixAssembler()
        self._latest: GnssFix | None = None
        self.part = NmeaPart(port, now, GNSS_SENTENCES, self._take)

    def read(self) -> GnssFix | None:
        """The latest fix, None before the first."""
        return self._latest

    def close(self) -> None:
        """End the thread and close the port. May be called twice."""
        self.part.close()

    def _take(self, sentence: Sentence, time_s: float) -> None:
        for fix in self._assembler.feed(sentence, time_s):
            self._latest = fix


def open_nmea_gnss(part: parts.GnssPart, now: Callable[[], float]) -> NmeaGnss:
    """The receiver on its port, being read.

    Raises:
        ConfigError: the port cannot be read.
        LinkError: the system refuses it.
    """
    gnss = NmeaGnss(open_nmea_port(part.port, part.baud, now), now)
    gnss.part.start()
    return gnss
