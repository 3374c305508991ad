"""What most simulated sensors have in common: a fault, a sampling time, and the latest reading."""

from typing import Generic

import msgspec

from sitl.world.sampling import TIME_SLACK_S
from sitl.world.sensors.fault import R, SensorFault


class Sensor(Generic[R]):
    """A sensor whose driver keeps the latest reading.

    clock_offset_s: the boat's clock, which stamps readings, minus the world's. due_s: when to sample next.
    """

    def __init__(self) -> None:
        self.fault: SensorFault[R] | None = None
        self.clock_offset_s = 0.0
        self.due_s = 0.0
        self._count = 0  # of samples
        self._latest: R | None = None
        self._sampled: R | None = None  # before a fault

    def _is_due(self, now_s: float, rate_hz: float) -> bool:
        """Whether to sample now; sets the time of the next sample."""
        if now_s < self.due_s:
            return False
        self._count += 1
        self.due_s = self._count / rate_hz - TIME_SLACK_S
        return True

    def _output(self, reading: R, now_s: float) -> None:
        """The sensor's output at this sample, with its fault."""
        if self.fault is None:
            self._latest = self._sampled = reading
        elif (faulty := self._with_fault(reading, self.fault, now_s)) is not None:
            self._latest = faulty

    def _with_fault(self, reading: R, fault: SensorFault[R], now_s: float) -> R | None:
        """What the fault makes of a reading; None for nothing."""
        if fault.kind == "stuck":
            return msgspec.structs.replace(fault.hold(self._sampled, reading), time_s=reading.time_s)
        return fault.output_at(reading, now_s)

    def read(self) -> R | None:
        """The latest reading."""
        return self._latest

    def restart(self) -> None:
        """Forget all readings: the boat's computer restarts."""
        self._latest = None

    def close(self) -> None:
        """Nothing to close."""
