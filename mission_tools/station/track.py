"""Where a boat has been, thinned to a bounded number of points."""

import math

from mission_tools.station.messages import Place

_MOST = 2000
_FIRST_STEP_M = 1.0
_M_PER_DEG = 111_195.0  # of latitude, on a sphere: enough to space points


class BoatTrack:
    """Points at least `step_m` apart. When full, every other point is dropped and the step doubled."""

    def __init__(self) -> None:
        self.points: list[tuple[float, float]] = []  # lon, lat
        self._step_m = _FIRST_STEP_M

    def add(self, place: Place) -> None:
        """A new place of the boat."""
        if self.points and _apart_m(self.points[-1], place) < self._step_m:
            return
        self.points.append((place.lon, place.lat))
        if len(self.points) > _MOST:
            self.points = self.points[::2]
            self._step_m *= 2.0


def _apart_m(at: tuple[float, float], place: Place) -> float:
    east = (place.lon - at[0] + 180.0) % 360.0 - 180.0
    return _M_PER_DEG * math.hypot(place.lat - at[1], east * math.cos(math.radians(place.lat)))
