"""The simulated computer of the boat: power, clock, disk and radio.

`Lockstep` and `Server` run the `Boat` on it while there is power, and build a new one over the same storage
when `boots` increases.
"""

from collections.abc import Sequence
from typing import Protocol

from sitl.radio.channel import WHOLE, Quality


class Clocked(Protocol):
    """A driver that stamps readings with the computer's clock and loses them at a restart."""

    clock_offset_s: float

    def restart(self) -> None:
        """Forget all readings."""


class Computer:
    """clock_offset_s: its clock minus the world's. load: simulated share of a tick that the program needs."""

    def __init__(self, drivers: Sequence[Clocked] = ()) -> None:
        self._drivers = drivers
        self.boots = 1
        self.has_power = True
        self.clock_offset_s = 0.0
        self.disk_is_full = False
        self.load = 0.0
        self.link_quality: Quality = WHOLE  # of every link, on top of its own

    def lose_power(self) -> None:
        """Stop the program at once; unstored data is lost."""
        self.has_power = False

    def begin(self, now_s: float) -> None:
        """Restart the program; its clock starts at zero."""
        self.has_power = True
        self.boots += 1
        self.set_clock_offset(-now_s)
        for driver in self._drivers:
            driver.restart()

    def set_clock_offset(self, offset_s: float) -> None:
        """Set the offset of the computer's clock from the world's."""
        self.clock_offset_s = offset_s
        for driver in self._drivers:
            driver.clock_offset_s = offset_s
