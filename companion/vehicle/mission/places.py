"""A mission's places: global, in the local frame, or relative to the start of a leg."""

from dataclasses import dataclass

from companion.core.geo import LatLon, LocalFrame, Point


@dataclass(frozen=True, slots=True)
class Offset:
    """A place relative to the start of the leg to it: the end of the leg before, or the boat."""

    north_m: float
    east_m: float


Place = LatLon | Point | Offset


def locate(place: Place, frame: LocalFrame, start: Point) -> Point:
    """A place in the local frame, for a leg that begins at start."""
    if isinstance(place, LatLon):
        return frame.to_local(place)
    if isinstance(place, Offset):
        return Point(start.north_m + place.north_m, start.east_m + place.east_m)
    return place
