"""What most simulated sensors have in common: a fault, a sampling time, and the latest reading."""

from typing import Generic

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

    def read(self) -> R | None:
        """The latest reading."""
        return self._latest

    def restart(self) -> None:
        """Forget all readings: the boat's computer restarts."""
        self._latest = None

    def close(self) -> None:
        """Nothing to close."""
