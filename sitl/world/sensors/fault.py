"""Sensor faults that are the same for all sensors: missing and late readings.

The effect of a fault on a reading's value is in the file of the sensor.
"""

import random
from collections import deque
from typing import Generic, TypeVar

import msgspec

from companion.sensors.readings import (
    BatteryReading,
    DepthReading,
    GnssFix,
    HeadingReading,
    HullReading,
    RcReading,
    SonarReading,
)

R = TypeVar("R", GnssFix, HeadingReading, SonarReading, BatteryReading, RcReading, HullReading, DepthReading)

_LONGEST_QUEUE = 1024


class SensorFault(Generic[R]):
    """One fault of one sensor, from since_s on.

    kind: `off` puts out nothing; `slow` only every size-th reading; `delayed` each reading size seconds late,
    stamped when it comes, as a driver that knows of no delay stamps it; `intermittent` nothing in the first
    half of every size seconds. Any other kind changes values: there size means what the catalogue of faults
    says, and bearing_rad is a direction over ground.
    """

    def __init__(
        self, kind: str, size: float, bearing_rad: float, since_s: float, numbers: random.Random
    ) -> None:
        self.kind = kind
        self.size = size
        self.bearing_rad = bearing_rad
        self.since_s = since_s
        self.random = numbers
        self.held: R | None = None  # the last good reading, for what is stuck
        self._seen = 0
        self._under_way: deque[tuple[float, R]] = deque(maxlen=_LONGEST_QUEUE)

    def hold(self, sampled: R | None, reading: R) -> R:
        """What a stuck sensor repeats: what was `sampled` before the fault, else the first reading in it."""
        held = self.held = self.held or sampled or reading
        return held

    def output_at(self, reading: R, now_s: float) -> R | None:
        """The sensor's output at this sample; None for nothing."""
        match self.kind:
            case "off":
                return None
            case "slow":
                self._seen += 1
                return reading if self._seen % max(1, round(self.size)) == 0 else None
            case "intermittent":
                return None if (now_s - self.since_s) % self.size < 0.5 * self.size else reading
            case "delayed":
                return self._late(reading, now_s)
            case _:
                return reading

    def _late(self, reading: R, now_s: float) -> R | None:
        self._under_way.append((now_s, reading))
        arrived: R | None = None
        while self._under_way and now_s >= self._under_way[0][0] + self.size:
            arrived = self._under_way.popleft()[1]
        return None if arrived is None else msgspec.structs.replace(arrived, time_s=reading.time_s)
