"""The boat's hardware, simulated: what `companion.hal.interfaces` asks for, over a world in memory.

Motors and battery monitor are here; receiver, compass and sonar, which have models of their own, are
in `sensors`.
"""

import math

from companion.sensors.readings import BatteryReading
from companion.units import clamp
from sitl.sensors import TIME_SLACK_S


class SimMotors:
    """Two motor inputs that keep the last command, as an H-bridge does."""

    __slots__ = ("left", "right")

    def __init__(self) -> None:
        """Start stopped."""
        self.left = self.right = 0.0

    def write(self, left: float, right: float) -> None:
        """Take a command, −1..1 per side; a value that is not finite stops both."""
        if math.isfinite(left) and math.isfinite(right):
            self.left, self.right = clamp(left, -1.0, 1.0), clamp(right, -1.0, 1.0)
        else:
            self.stop()

    def stop(self) -> None:
        """Cut both."""
        self.left = self.right = 0.0

    def close(self) -> None:
        """Stop."""
        self.stop()


class SimBattery:
    """The monitor of the simulated pack."""

    __slots__ = ("_latest", "_next", "_rate_hz")

    def __init__(self, rate_hz: float) -> None:
        """Start without a reading."""
        self._rate_hz = rate_hz
        self._latest: BatteryReading | None = None
        self._next = 0

    def sense(self, now_s: float, voltage_v: float, current_a: float) -> None:
        """Sample when due."""
        if now_s + TIME_SLACK_S >= self._next / self._rate_hz:
            self._next += 1
            self._latest = BatteryReading(now_s, voltage_v, current_a)

    def read(self) -> BatteryReading | None:
        """The latest reading."""
        return self._latest

    def close(self) -> None:
        """Nothing to let go."""
