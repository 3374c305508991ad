"""Sensor faults that are the same for all sensors: missing and late readings.

The effect of a fault on a reading's value is in the file of the sensor.
"""

import math
import random
from collections import deque
from typing import Generic, TypeVar

import msgspec

from companion.core.readings import Reading
from companion.core.units import clamp

R = TypeVar("R", bound=Reading)

_LONGEST_QUEUE = 1024
_HALF = 0x8000  # of the range of 16 bits
_OLD_SHARE = 0.15  # of the corrupt readings


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
        self._recent: deque[R] = deque(maxlen=3)
        self._under_way: deque[tuple[float, R]] = deque(maxlen=_LONGEST_QUEUE)

    def hold(self, sampled: R | None, reading: R) -> R:
        """What a stuck sensor repeats: what was `sampled` before the fault, else the first reading in it."""
        held = self.held = self.held or sampled or reading
        return held

    def corrupt(self, reading: R, **scales: float) -> R:
        """The reading; for the share `size`, one or all of these fields garbled, or the last but one.

        scales: the fields and their full scales.
        """
        numbers, recent = self.random, self._recent
        recent.append(reading)
        if numbers.random() >= self.size:
            return reading
        if numbers.random() < _OLD_SHARE:
            return msgspec.structs.replace(recent[0], time_s=reading.time_s)
        garbled = scales if numbers.random() < 0.5 else (numbers.choice(tuple(scales)),)
        return msgspec.structs.replace(
            reading, **{name: self.garbled(getattr(reading, name), scales[name]) for name in garbled}
        )

    def garbled(self, value: float | None, full_scale: float) -> float:
        """A signed number of 16 bits: random, one bit flipped, 0, full scale, negated; or NaN."""
        numbers = self.random
        bits = round(clamp((value or 0.0) / full_scale, -1.0, 1.0) * _HALF)
        match numbers.randrange(7):
            case 0:
                bits = numbers.getrandbits(16)
            case 1:
                bits ^= 1 << numbers.randrange(16)
            case 2:
                bits = 0
            case 3:
                bits = _HALF - 1
            case 4:
                bits = _HALF
            case 5:
                bits = -bits
            case _:
                return math.nan
        return full_scale * ((bits + _HALF) % (2 * _HALF) - _HALF) / _HALF

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
