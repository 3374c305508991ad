"""Compass with NMEA 0183 output on a port."""

from collections.abc import Callable, Iterable

from companion.config.parts import CompassPart
from companion.core.readings import HeadingReading
from companion.hal.nmea_sensor import NmeaSensor
from companion.links.interfaces import Port
from companion.links.port_url import open_line
from companion.sensors.nmea.heading import HEADING_SENTENCES, HeadingAssembler
from companion.sensors.nmea.sentences import Sentence


class NmeaCompass(NmeaSensor[HeadingReading]):
    """A compass on a line of NMEA 0183. Satisfies `companion.hal.interfaces.Compass`."""

    def __init__(self, port: Port, now: Callable[[], float], correction_rad: float = 0.0) -> None:
        super().__init__(port, now, HEADING_SENTENCES)
        self._assembler = HeadingAssembler(correction_rad)

    def _assemble(self, sentence: Sentence, time_s: float) -> Iterable[HeadingReading]:
        reading = self._assembler.feed(sentence, time_s)
        return () if reading is None else (reading,)


def open_nmea_compass(part: CompassPart, now: Callable[[], float]) -> NmeaCompass:
    """Open the compass on its port and start reading.

    Raises:
        ConfigError: the port url is invalid.
        LinkError: the port cannot be opened.
    """
    return NmeaCompass(open_line(part.port, part.baud, now), now, part.correction_rad).start()
