"""Probes that are read from time to time: inputs of an ADS1115, and files."""

from collections.abc import Callable
from glob import glob
from pathlib import Path

from companion.config.parts.probes import ProbePart
from companion.core.errors import HardwareError
from companion.core.readings import ProbeReading
from companion.hal.ads1115 import Ads1115
from companion.hal.background import BackgroundSensor
from companion.hal.raspberry_pi import open_i2c_part
from companion.sensors.probe_values import raw_number, value_of


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

        Raises:
            HardwareError, OSError: there is no measurement.
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

    Raises:
        OSError: no such file, or the part behind it does not answer.
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

    Raises:
        HardwareError: smbus2 is missing, there is no bus, or nothing answers at the address.
    """
    converter = open_i2c_part("ADS1115", part.i2c_bus, part.address, lambda bus: Ads1115(bus, part.address))
    return PolledProbe(part, now, lambda: converter.read_v(part.channel), converter.bus.close).start()
