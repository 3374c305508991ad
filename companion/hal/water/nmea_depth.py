"""Depth sounder with NMEA 0183 output, on a port of its own or on that of the GNSS receiver."""

from collections.abc import Callable, Iterable

from companion.config.parts.depth import DepthPart
from companion.core.readings import DepthReading
from companion.hal.gnss.receiver import GnssReceiver
from companion.hal.nmea_sensor import NmeaSensor
from companion.links.interfaces import Port
from companion.links.port_url import open_line
from companion.sensors.nmea.depth import DEPTH_SENTENCES, DepthAssembler
from companion.sensors.nmea.sentences import Sentence

BAUD = 4800  # of NMEA 0183


def _assembler(part: DepthPart) -> DepthAssembler:
    return DepthAssembler(part.transducer_m, part.min_range_m, part.max_range_m)


class NmeaDepthSounder(NmeaSensor[DepthReading]):
    """A sounder on a line of NMEA 0183. Satisfies `companion.hal.interfaces.DepthSounder`."""

    def __init__(self, port: Port, now: Callable[[], float], part: DepthPart) -> None:
        super().__init__(port, now, DEPTH_SENTENCES)
        self._assembler = _assembler(part)

    def _assemble(self, sentence: Sentence, time_s: float) -> Iterable[DepthReading]:
        reading = self._assembler.feed(sentence, time_s)
        return () if reading is None else (reading,)


class SharedDepthSounder:
    """Satisfies `companion.hal.interfaces.DepthSounder`: sentences among those of the GNSS receiver."""

    def __init__(self, part: DepthPart) -> None:
        self._assembler = _assembler(part)
        self._latest: DepthReading | None = None

    def listen_to(self, gnss: GnssReceiver) -> None:
        """Read from this receiver."""
        gnss.listen(DEPTH_SENTENCES, self._ingest)

    def read(self) -> DepthReading | None:
        """The latest sounding, None before the first."""
        return self._latest

    def close(self) -> None:
        """The receiver closes its port."""

    def _ingest(self, sentence: Sentence, time_s: float) -> None:
        self._latest = self._assembler.feed(sentence, time_s) or self._latest


def open_nmea_depth(part: DepthPart, now: Callable[[], float]) -> NmeaDepthSounder:
    """Open the sounder on its port and start reading.

    Raises:
        ConfigError: the port url is invalid.
        LinkError: the port cannot be opened.
    """
    return NmeaDepthSounder(open_line(part.port, part.baud or BAUD, now), now, part).start()
