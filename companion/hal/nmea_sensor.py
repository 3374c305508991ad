"""A sensor with NMEA 0183 output on a port."""

from abc import abstractmethod
from collections.abc import Callable, Iterable, Iterator

from companion.hal.background import Reading
from companion.hal.port_sensor import PortSensor
from companion.links.interfaces import Port
from companion.sensors.nmea.sentences import NmeaReader, Sentence


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
