"""Where a ranger on a servo looks: to and fro over its bearings, or over those of a sector that is asked for.

It goes one bearing at a time, since a servo takes its time and a ping on the way costs nothing: towards a
sector that it stands outside of, then to and fro within.
"""

from collections.abc import Sequence


class ServoScan:
    """bearing_rad: where it looks now, from the bow, clockwise."""

    __slots__ = ("_bearings_rad", "_index", "_sector", "_step", "bearing_rad")

    def __init__(self, bearings_rad: Sequence[float]) -> None:
        """It begins at the first bearing to port. bearings_rad: at least one, each as often as one likes."""
        self._bearings_rad = tuple(sorted(set(bearings_rad)))
        self._index, self._step = 0, 1
        self._sector = (0, len(self._bearings_rad) - 1)
        self.bearing_rad = self._bearings_rad[0]

    def set_sector(self, port_rad: float, starboard_rad: float) -> None:
        """From now on between these bearings, as far as the part goes; at the nearest one if none is."""
        bearings = self._bearings_rad
        inside = [n for n, bearing in enumerate(bearings) if port_rad <= bearing <= starboard_rad]
        if not inside:
            middle_rad = 0.5 * (port_rad + starboard_rad)
            inside = [min(range(len(bearings)), key=lambda n: abs(bearings[n] - middle_rad))]
        self._sector = (inside[0], inside[-1])

    def turn(self) -> float:
        """On to the next bearing; that bearing."""
        first, last = self._sector
        if self._index <= first:
            self._step = 1
        elif self._index >= last:
            self._step = -1
        if first != last or self._index != first:
            self._index = min(max(self._index + self._step, 0), len(self._bearings_rad) - 1)
        self.bearing_rad = self._bearings_rad[self._index]
        return self.bearing_rad
