"""The recent track, to find a place with room to wait."""

from collections import deque
from collections.abc import Sequence

from companion.core.geo import Point, distance_m

_POINTS = 24
_STEP = 0.5  # of the margin


class Breadcrumbs:
    """Recent places, half a margin apart."""

    __slots__ = ("_places",)

    def __init__(self) -> None:
        self._places: deque[Point] = deque(maxlen=_POINTS)

    def add(self, here: Point, margin_m: float) -> None:
        """Add the present place."""
        if not self._places or distance_m(self._places[-1], here) > _STEP * margin_m:
            self._places.append(here)

    def last_with_room(self, here: Point, obstacles: Sequence[Point], margin_m: float) -> Point:
        """The last place with the margin around it, or the present one."""
        for place in reversed(self._places):
            if all(distance_m(place, obstacle) > margin_m for obstacle in obstacles):
                return place
        return here
