"""Probes: inputs of an ADS1115 and files, read from time to time, and lines of text on a port."""

import re
from collections.abc import Callable, Iterator, Sequence
from glob import glob
from pathlib import Path
from typing import Final

from companion.config.section import FLOAT32_MAX
from companion.config.sensors import ProbePart
from companion.core.errors import HardwareError
from companion.core.readings import ProbeReading
from companion.hal.ads1115 import Ads1115
from companion.hal.background import BackgroundSensor
from companion.hal.port_sensor import PortSensor
from companion.hal.raspberry_pi import open_i2c_part
from companion.links.interfaces import Port
from companion.links.port_url import open_line

_SEPARATORS = re.compile(r"[,;\s]+")


def raw_number(text: str, part: ProbePart) -> float | None:
    """The number in a text, None if there is none."""
    if part.pattern:
        found = re.search(part.pattern, text)
        word = "" if found is None else found[1] or ""
    elif part.column >= 0:
        words = _SEPARATORS.split(text.strip())
        word = words[part.column] if part.column < len(words) else ""
    else:
        word = text
    try:
        return float(word)
    except ValueError:
        return None


def value_of(raw: float | None, part: ProbePart) -> float | None:
    """The value in the probe's unit, None if it is no measurement."""
    if raw is None or raw in part.invalid:
        return None
    value = part.scale * raw + part.offset
    is_low = part.min_value is not None and value < part.min_value
    is_high = part.max_value is not None and value > part.max_value
    return None if is_low or is_high or not abs(value) <= FLOAT32_MAX else value


class PolledProbe(BackgroundSensor[ProbeReading]):
    """Satisfies `companion.hal.interfaces.Probe`. measure: the source's number, None without one."""

    def __init__(
        self,
        part: ProbePart,
        now: Callable[[], float],
        measure: Callable[[], float | None],
        release: Callable[[], None] = lambda: None,
    ) -> None:
        super().__init__(self.step, f"probe {part.name}", now, release)
        self._part = part
        self._measure = measure

    def step(self) -> float:
        """Measure once; returns the seconds to wait before the next time.
        Raises HardwareError, OSError: there is no measurement.
        """
        part, began_s = self._part, self._now()
        raw = self._measure()
        value = value_of(raw, part)
        if value is None:
            raise HardwareError(f"no measurement: {'nothing' if raw is None else raw}")
        self._latest = ProbeReading(self._now(), part.name, value, part.unit)
        return max(1.0 / part.rate_hz - (self._now() - began_s), 0.01)


def file_number(part: ProbePart) -> float | None:
    """The number in the probe's file, None if there is none.
    Raises OSError: no such file, or the part behind it does not answer.
    """
    path = part.path
    if "*" in path:
        path = min(glob(path), default=path)
    return raw_number(Path(path).read_text(encoding="utf-8", errors="replace"), part)


def open_file_probe(part: ProbePart, now: Callable[[], float]) -> PolledProbe:
    """Start to read the file; it may appear later."""
    return PolledProbe(part, now, lambda: file_number(part)).start()


def open_analog_probe(part: ProbePart, now: Callable[[], float]) -> PolledProbe:
    """Open the converter and start to read the input, in volts.
    Raises HardwareError: smbus2 is missing, there is no bus, or nothing answers at the address.
    """
    converter = open_i2c_part("ADS1115", part.i2c_bus, part.address, lambda bus: Ads1115(bus, part.address))
    return PolledProbe(part, now, lambda: converter.read_v(part.channel), converter.bus.close).start()


_LONGEST: Final = 512


class LineProbe:
    """Satisfies `companion.hal.interfaces.Probe`; close: closes the line."""

    def __init__(self, part: ProbePart, close: Callable[[], None]) -> None:
        self._part = part
        self._latest: ProbeReading | None = None
        self.close = close

    def read(self) -> ProbeReading | None:
        return self._latest

    def ingest(self, text: str, time_s: float) -> None:
        """Take the number from a line, if it is there."""
        value = value_of(raw_number(text, self._part), self._part)
        if value is not None:
            self._latest = ProbeReading(time_s, self._part.name, value, self._part.unit)


class SerialLine(PortSensor[str]):
    """Splits bytes into lines; several probes may take their numbers from one. `read` is the latest line."""

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
    """Open the port of these probes, which is one, and start reading. Raises as `open_line`."""
    line = SerialLine(open_line(parts[0].port, parts[0].baud, now), now, parts).start()
    return line.probes
