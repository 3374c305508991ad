"""Telemetry of the probes: NAMED_VALUE_FLOAT, each at its own rate."""

import math
from collections.abc import Iterator, Sequence
from typing import Final

from companion.autopilot.sensor_suite import READ_S
from companion.autopilot.snapshot import Snapshot
from companion.config.sensors import ProbePart
from companion.core.readings import ProbeReading
from companion.mavlink.dialect import Message, dialect

_SLACK_S: Final = 1e-6


def probe_value(reading: ProbeReading) -> Message:
    """One value, at the time of its measurement."""
    name = reading.name.encode("ascii")
    return dialect.MAVLink_named_value_float_message(
        round(reading.time_s * 1e3) & 0xFFFFFFFF, name, reading.value
    )


def probe_values(now: Snapshot, which: float = 0.0) -> list[Message]:  # noqa: ARG001 — as for other requests
    """The values of all probes that are not silent."""
    return [probe_value(reading) for reading in now.sensors.probes]


class ProbeSchedule:
    """Which probe is due: at its rate, and with a new value."""

    def __init__(self, parts: Sequence[ProbePart]) -> None:
        self._period_s = {part.name: 1.0 / part.rate_hz for part in parts}
        self._due_s = dict.fromkeys(self._period_s, 0.0)
        self._sent_s: dict[str, float] = {}
        self._look_s = 0.0 if parts else math.inf

    def has_due(self, now_s: float) -> bool:
        """Whether to look: ten times a second, the highest rate."""
        return now_s + _SLACK_S >= self._look_s

    def due(self, readings: Sequence[ProbeReading], now_s: float) -> Iterator[Message]:
        self._look_s = now_s + READ_S
        for reading in readings:
            name = reading.name
            if now_s + _SLACK_S < self._due_s.get(name, 0.0) or self._sent_s.get(name) == reading.time_s:
                continue
            period_s = self._period_s.get(name, 1.0)
            self._due_s[name] = max(self._due_s.get(name, 0.0) + period_s, now_s)
            self._sent_s[name] = reading.time_s
            yield probe_value(reading)
