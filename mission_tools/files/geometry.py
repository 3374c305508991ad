"""A mission's places and areas as plain coordinates, for formats that know no missions."""

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

from companion.core.geo import LatLon, LocalFrame, Point, distance_m, longitude_difference_deg
from mission_tools.mission.mission import Fence, FenceCircle, Mission

CIRCLE_CORNERS = 64


class Waypoint(NamedTuple):
    """A place of a mission. number: 0 is home, where the route begins."""

    number: int
    place: LatLon
    hold_s: float

    @property
    def name(self) -> str:
        """The name that files give it, such as “Home” or “Waypoint 1”."""
        return f"Waypoint {self.number}" if self.number else "Home"


class FenceArea(NamedTuple):
    """A fence area by its corners, a circle as well. No corner twice."""

    name: str
    is_inclusion: bool
    corners: tuple[LatLon, ...]


def waypoints(mission: Mission) -> list[Waypoint]:
    """Home, if it is known, and the places in their order."""
    found = [] if mission.home is None else [Waypoint(0, mission.home, 0.0)]
    places = [item for item in mission.items if item.place is not None]
    found += [Waypoint(n, item.place, item.hold_s) for n, item in enumerate(places, 1) if item.place]
    return found


def length_m(places: Sequence[LatLon]) -> float:
    """The length of a line of places, leg by leg."""
    return sum(leg_length_m(start, end) for start, end in pairwise(places))


def leg_length_m(start: LatLon, end: LatLon) -> float:
    """The length of the geodesic between two places some kilometres apart."""
    return distance_m(Point(0.0, 0.0), LocalFrame(start).to_local(end))


def fence_areas(fence: Fence) -> Iterator[FenceArea]:
    """All areas; a circle is drawn by corners that are never on the wrong side of it."""
    for n, polygon in enumerate(fence.polygons, 1):
        yield FenceArea(_name(n, polygon.inclusion), polygon.inclusion, polygon.corners)
    for n, circle in enumerate(fence.circles, len(fence.polygons) + 1):
        yield FenceArea(_name(n, circle.inclusion), circle.inclusion, _corners(circle))


def _name(number: int, is_inclusion: bool) -> str:
    return f"Fence {number}: stay {'inside' if is_inclusion else 'outside'}"


def _corners(circle: FenceCircle) -> tuple[LatLon, ...]:
    frame = LocalFrame(circle.centre)
    radius_m = circle.radius_m / (1.0 if circle.inclusion else math.cos(math.pi / CIRCLE_CORNERS))
    angles = (2.0 * math.pi * n / CIRCLE_CORNERS for n in range(CIRCLE_CORNERS))
    return tuple(
        frame.to_global(Point(radius_m * math.cos(angle), radius_m * math.sin(angle))) for angle in angles
    )


def pieces_at_antimeridian(places: Sequence[LatLon]) -> list[list[tuple[float, float]]]:
    """A line as (longitude, latitude), cut where it crosses ±180° (RFC 7946, 3.1.9)."""
    pieces = [[(places[0].lon_deg, places[0].lat_deg)]] if places else []
    for start, end in pairwise(places):
        east_deg = longitude_difference_deg(end.lon_deg, start.lon_deg)
        side = math.copysign(180.0, east_deg)
        if abs(start.lon_deg + east_deg) > 180.0:
            share = (side - start.lon_deg) / east_deg
            lat_deg = start.lat_deg + share * (end.lat_deg - start.lat_deg)
            pieces[-1].append((side, lat_deg))
            pieces.append([(-side, lat_deg)])
        pieces[-1].append((end.lon_deg, end.lat_deg))
    return pieces
