"""Scan pattern of a ranger on a servo: back and forth over its bearings, or over a requested sector.

It moves one bearing at a time and pings on the way: first towards the sector, then back and forth within.
"""

from collections.abc import Sequence


class ServoScan:
    """bearing_rad: present bearing, from the bow, clockwise."""

    def __init__(self, bearings_rad: Sequence[float]) -> None:
        """Start at the first bearing to port. bearings_rad: at least one; duplicates are ignored."""
        self._bearings_rad = tuple(sorted(set(bearings_rad)))
        self._index, self._step = 0, 1
        self._sector = (0, len(self._bearings_rad) - 1)
        self.bearing_rad = self._bearings_rad[0]

    def set_sector(self, port_rad: float, starboard_rad: float) -> None:
        """Scan between these bearings, as far as the servo reaches; the nearest one if none lies between."""
        bearings = self._bearings_rad
        inside = [n for n, bearing in enumerate(bearings) if port_rad <= bearing <= starboard_rad]
        if not inside:
            middle_rad = 0.5 * (port_rad + starboard_rad)
            inside = [min(range(len(bearings)), key=lambda n: abs(bearings[n] - middle_rad))]
        self._sector = (inside[0], inside[-1])

    def turn(self) -> float:
        """Advance to the next bearing and return it."""
        first, last = self._sector
        if self._index <= first:
            self._step = 1
        elif self._index >= last:
            self._step = -1
        if first != last or self._index != first:
            self._index = min(max(self._index + self._step, 0), len(self._bearings_rad) - 1)
        self.bearing_rad = self._bearings_rad[self._index]
        return self.bearing_rad
