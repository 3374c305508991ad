"""GNSS receiver with NMEA 0183 output on a port."""

from collections.abc import Callable, Iterable

from companion.config.parts import GnssPart
from companion.hal.interfaces import Port
from companion.hal.nmea_sensor import NmeaSensor
from companion.links.port_url import open_line
from companion.sensors.nmea import Sentence
from companion.sensors.nmea_fix import GNSS_SENTENCES, FixAssembler
from companion.sensors.readings import GnssFix
from companion.sensors.receiver_clock import ReceiverClock


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


def open_nmea_gnss(part: GnssPart, now: Callable[[], float]) -> NmeaGnss:
    """Open the receiver on its port and start reading.

    Raises:
        ConfigError: the port url is invalid.
        LinkError: the port cannot be opened.
    """
    return NmeaGnss(open_line(part.port, part.baud, now), now, part.latency_s).start()
