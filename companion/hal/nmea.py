"""GNSS receiver and compass with NMEA 0183 output on a port."""

from abc import abstractmethod
from collections.abc import Callable, Iterable, Iterator

from companion.config import parts
from companion.hal.background import Reading
from companion.hal.interfaces import Port
from companion.hal.port_sensor import PortSensor
from companion.links.port_url import open_port
from companion.sensors.nmea import NmeaReader, Sentence
from companion.sensors.nmea_fix import GNSS_SENTENCES, FixAssembler
from companion.sensors.nmea_heading import HEADING_SENTENCES, HeadingAssembler
from companion.sensors.readings import GnssFix, HeadingReading
from companion.sensors.receiver_clock import ReceiverClock


class NmeaSensor(PortSensor[Reading]):
    """Assembles readings from the wanted sentences."""

    def __init__(self, port: Port, now: Callable[[], float], wanted: frozenset[str]) -> None:
        super().__init__(port, now)
        self.reader = NmeaReader(wanted)

    @abstractmethod
    def _assemble(self, sentence: Sentence, time_s: float) -> Iterable[Reading]:
        """The readings that this sentence completes."""

    def _decode(self, chunk: bytes, time_s: float) -> Iterator[Reading]:
        for sentence in self.reader.feed(chunk):
            yield from self._assemble(sentence, time_s)

    def _forget(self) -> None:
        self.reader.forget()


class NmeaGnss(NmeaSensor[GnssFix]):
    """Satisfies `companion.hal.interfaces.Gnss`.

    Fixes are stamped with the time of measurement, from the receiver's time of day. latency_s: shortest time
    from measurement to the arrival of the first sentence.
    """

    def __init__(self, port: Port, now: Callable[[], float], latency_s: float = 0.0) -> None:
        super().__init__(port, now, GNSS_SENTENCES)
        self._assembler = FixAssembler()
        self._clock = ReceiverClock(latency_s)

    def _assemble(self, sentence: Sentence, time_s: float) -> Iterable[GnssFix]:
        return map(self._clock.stamp, self._assembler.feed(sentence, time_s))


class NmeaCompass(NmeaSensor[HeadingReading]):
    """Satisfies `companion.hal.interfaces.Compass`. For HDM, correction_rad includes the local variation."""

    def __init__(self, port: Port, now: Callable[[], float], correction_rad: float = 0.0) -> None:
        super().__init__(port, now, HEADING_SENTENCES)
        self._assembler = HeadingAssembler(correction_rad)

    def _assemble(self, sentence: Sentence, time_s: float) -> Iterable[HeadingReading]:
        reading = self._assembler.feed(sentence, time_s)
        return () if reading is None else (reading,)


def open_nmea_gnss(part: parts.GnssPart, now: Callable[[], float]) -> NmeaGnss:
    """Open the receiver on its port and start reading.

    Raises:
        ConfigError: the port url is invalid.
        LinkError: the port cannot be opened.
    """
    return NmeaGnss(_open_port(part.port, part.baud, now), now, part.latency_s).start()


def open_nmea_compass(part: parts.CompassPart, now: Callable[[], float]) -> NmeaCompass:
    """Open the compass on its port and start reading.

    Raises:
        ConfigError: the port url is invalid.
        LinkError: the port cannot be opened.
    """
    return NmeaCompass(_open_port(part.port, part.baud, now), now, part.correction_rad).start()


def _open_port(place: str, baud: float, now: Callable[[], float]) -> Port:
    """Open a serial device at a baud rate, or any other port url."""
    return open_port(f"{place},{int(baud)}" if place.startswith("/") and "," not in place else place, now)
