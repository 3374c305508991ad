"""Probes on a serial line that sends text by itself; several may take their numbers from one line."""

from collections.abc import Callable, Iterator, Sequence
from typing import Final

from companion.config.parts.probes import ProbePart
from companion.core.readings import ProbeReading
from companion.hal.port_sensor import PortSensor
from companion.links.interfaces import Port
from companion.links.port_url import open_line
from companion.sensors.probe_values import raw_number, value_of

_LONGEST: Final = 512


class LineProbe:
    """Satisfies `companion.hal.interfaces.Probe`; close: closes the line."""

    def __init__(self, part: ProbePart, close: Callable[[], None]) -> None:
        self._part = part
        self._latest: ProbeReading | None = None
        self.close = close

    def read(self) -> ProbeReading | None:
        """The latest reading, None before the first."""
        return self._latest

    def ingest(self, text: str, time_s: float) -> None:
        """Take the number from a line, if it is there."""
        value = value_of(raw_number(text, self._part), self._part)
        if value is not None:
            self._latest = ProbeReading(time_s, self._part.name, value, self._part.unit)


class SerialLine(PortSensor[str]):
    """Splits bytes into lines, for each probe. `read` is the latest line."""

    def __init__(self, port: Port, now: Callable[[], float], parts: Sequence[ProbePart]) -> None:
        super().__init__(port, now, rest_s=0.02)
        self.probes = tuple(LineProbe(part, self.close) for part in parts)
        self._held = b""

    def _decode(self, chunk: bytes, time_s: float) -> Iterator[str]:
        *lines, self._held = (self._held + chunk).replace(b"\r", b"\n").split(b"\n")
        if len(self._held) > _LONGEST:
            self._held = b""
        for line in lines:
            if not line or len(line) > _LONGEST:
                continue
            text = line.decode("utf-8", "replace")
            for probe in self.probes:
                probe.ingest(text, time_s)
            yield text

    def _forget(self) -> None:
        self._held = b""


def open_serial_probes(parts: Sequence[ProbePart], now: Callable[[], float]) -> tuple[LineProbe, ...]:
    """Open the port of these probes, which is one, and start reading.

    Raises:
        ConfigError: the port url is invalid.
        LinkError: the port cannot be opened.
    """
    line = SerialLine(open_line(parts[0].port, parts[0].baud, now), now, parts).start()
    return line.probes
