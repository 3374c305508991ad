"""AIS receiver with NMEA 0183 output, decoded by pyais."""

from collections.abc import Callable, Iterable

from companion.config.sensors import AisPart
from companion.core.readings import AisReading
from companion.hal.port_sensor import PortSensor
from companion.hal.raspberry_pi import import_optional
from companion.links.interfaces import Port
from companion.links.port_url import open_line
from companion.sensors.nmea.ais import AisReader


class AisReceiver(PortSensor[AisReading]):
    """Satisfies `companion.hal.interfaces.Ais`."""

    def __init__(self, port: Port, now: Callable[[], float], reader: AisReader) -> None:
        super().__init__(port, now)
        self.reader = reader

    def _decode(self, chunk: bytes, time_s: float) -> Iterable[AisReading]:
        reading = self.reader.feed(chunk, time_s)
        return () if reading is None else (reading,)

    def _forget(self) -> None:
        self.reader.forget()


def open_ais_receiver(part: AisPart, now: Callable[[], float]) -> AisReceiver:
    """Open the receiver and start reading. Raises as `open_line`, and HardwareError: pyais is missing."""
    decode = import_optional("pyais.decode", "AIS receiver").decode
    return AisReceiver(open_line(part.port, part.baud, now), now, AisReader(decode, part.mmsi)).start()
