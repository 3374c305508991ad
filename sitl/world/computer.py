"""The boat's computer as the world around it knows it: power, clock, disk and radio.

The program that runs on it is the companion's own `Boat`; `Lockstep` and `Server` run it while there is power
and build it anew, over the same storage, when `boots` has gone up.
"""

from collections.abc import Sequence
from typing import Protocol

from sitl.radio.channel import WHOLE, Quality


class Clocked(Protocol):
    """A driver that stamps readings with the computer's clock, and loses them when the program ends."""

    clock_offset_s: float

    def restart(self) -> None:
        """Forget what was read."""


class Computer:
    """Its state. clock_offset_s: what its clock shows more than the world's.

    load: share of a tick that the boat's program needs on this computer, apart from what it costs the host.
    """

    def __init__(self, drivers: Sequence[Clocked] = ()) -> None:
        """Running, at time zero."""
        self._drivers = drivers
        self.boots = 1
        self.has_power = True
        self.clock_offset_s = 0.0
        self.disk_is_full = False
        self.load = 0.0
        self.link_quality: Quality = WHOLE  # of every link, on top of its own

    def lose_power(self) -> None:
        """The program is gone at once, and all that was not stored."""
        self.has_power = False

    def begin(self, now_s: float) -> None:
        """Start the program anew; its clock begins at zero."""
        self.has_power = True
        self.boots += 1
        self.set_clock_offset(-now_s)
        for driver in self._drivers:
            driver.restart()

    def set_clock_offset(self, offset_s: float) -> None:
        """Let the clock show so much more than the world's."""
        self.clock_offset_s = offset_s
        for driver in self._drivers:
            driver.clock_offset_s = offset_s
