"""Compasses, depth sounders (also on the GNSS receiver's line) and AIS receivers with NMEA 0183 output."""

from collections.abc import Callable, Iterator

from companion.config.sensors import AisPart, CompassPart, DepthPart
from companion.core.readings import AisReading, DepthReading, HeadingReading
from companion.hal.background import Reading
from companion.hal.gnss.receiver import GnssReceiver
from companion.hal.port_sensor import ParsedSensor, PortSensor
from companion.hal.raspberry_pi import import_optional
from companion.links.interfaces import Port
from companion.links.port_url import open_line
from companion.sensors.nmea.ais import AisReader
from companion.sensors.nmea.depth import DEPTH_SENTENCES, DepthAssembler
from companion.sensors.nmea.heading import HEADING_SENTENCES, HeadingAssembler
from companion.sensors.nmea.sentences import NmeaReader, Sentence


class NmeaSensor(PortSensor[Reading]):
    """Assembles readings from the wanted sentences. Satisfies `companion.hal.interfaces.Sensor`."""

    def __init__(
        self,
        port: Port,
        now: Callable[[], float],
        wanted: frozenset[str],
        assemble: Callable[[Sentence, float], Reading | None],
    ) -> None:
        """assemble: takes a sentence and its arrival; returns the reading that it completes."""
        super().__init__(port, now)
        self.reader = NmeaReader(wanted)
        self._assemble = assemble

    def _decode(self, chunk: bytes, time_s: float) -> Iterator[Reading]:
        for sentence in self.reader.feed(chunk):
            if (reading := self._assemble(sentence, time_s)) is not None:
                yield reading

    def _forget(self) -> None:
        self.reader.forget()


def open_nmea_compass(part: CompassPart, now: Callable[[], float]) -> NmeaSensor[HeadingReading]:
    """Open the compass on its port and start reading. Raises as `open_line`."""
    port, assembler = open_line(part.port, part.baud, now), HeadingAssembler(part.correction_rad)
    return NmeaSensor(port, now, HEADING_SENTENCES, assembler.feed).start()


BAUD = 4800  # of NMEA 0183
_AIS_REST_S = 0.1  # every reading has all vessels, and the boat looks at them ten times a second


def depth_assembler(part: DepthPart) -> DepthAssembler:
    """Of this sounder's sentences."""
    return DepthAssembler(part.transducer_m, part.min_range_m, part.max_range_m)


class SharedDepthSounder:
    """Satisfies `companion.hal.interfaces.DepthSounder`: sentences among those of the GNSS receiver."""

    def __init__(self, part: DepthPart) -> None:
        self._assembler = depth_assembler(part)
        self._latest: DepthReading | None = None

    def listen_to(self, gnss: GnssReceiver) -> None:
        """Read from this receiver."""
        gnss.listen(DEPTH_SENTENCES, self._ingest)

    def read(self) -> DepthReading | None:
        return self._latest

    def close(self) -> None:
        """The receiver closes its port."""

    def _ingest(self, sentence: Sentence, time_s: float) -> None:
        self._latest = self._assembler.feed(sentence, time_s) or self._latest


def open_nmea_depth(part: DepthPart, now: Callable[[], float]) -> NmeaSensor[DepthReading]:
    """Open the sounder on its port and start reading. Raises as `open_line`."""
    port = open_line(part.port, part.baud or BAUD, now)
    return NmeaSensor(port, now, DEPTH_SENTENCES, depth_assembler(part).feed).start()


def open_ais(part: AisPart, now: Callable[[], float]) -> ParsedSensor[AisReading]:
    """Open the receiver and start reading. Raises as `open_line`, and HardwareError: pyais is missing."""
    reader = AisReader(import_optional("pyais", "AIS receiver").decode, part.mmsi)
    return ParsedSensor(open_line(part.port, part.baud, now), now, reader, _AIS_REST_S).start()
