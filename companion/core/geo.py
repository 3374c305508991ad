"""Geodesy for small waters: WGS 84 positions, a local metric frame, and plane geometry.

The local frame is a transverse Mercator projection with scale 1 at its origin: a straight line in it is a
geodesic to within millimetres over 10 km. The series are those of J. P. Snyder, *Map Projections: A Working
Manual* (USGS PP 1395, 1987), equations 8-9 to 8-18, truncated where the next term is below 0.1 mm at 20 km.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

from companion.core.units import deg_to_e7, e7_to_deg

WGS84_A_M = 6378137.0
WGS84_F = 1.0 / 298.257223563
WGS84_E2 = WGS84_F * (2.0 - WGS84_F)


class Point(NamedTuple):
    """A position in a local frame."""

    north_m: float
    east_m: float

    def moved(self, bearing_rad: float, distance_m: float) -> "Point":
        """The place at a distance in a direction, clockwise from north."""
        return Point(
            self.north_m + distance_m * math.cos(bearing_rad),
            self.east_m + distance_m * math.sin(bearing_rad),
        )

    def towards(self, other: "Point", share: float) -> "Point":
        """The place at a share of the straight way to another point."""
        return Point(
            self.north_m + share * (other.north_m - self.north_m),
            self.east_m + share * (other.east_m - self.east_m),
        )


@dataclass(frozen=True, slots=True)
class LatLon:
    """A WGS 84 position in degrees.
    Raises ValueError: not finite, latitude outside ±90 or longitude outside ±180.
    """

    lat_deg: float
    lon_deg: float

    def __post_init__(self) -> None:
        if not -90.0 <= self.lat_deg <= 90.0:
            raise ValueError(f"latitude {self.lat_deg} is outside -90..90 degrees")
        if not -180.0 <= self.lon_deg <= 180.0:
            raise ValueError(f"longitude {self.lon_deg} is outside -180..180 degrees")


def position_from_e7(lat_e7: int, lon_e7: int) -> LatLon | None:
    """MAVLink's 1e-7 degree integers as a position; None for 0, 0, which means "unknown", or out of range."""
    if lat_e7 == lon_e7 == 0 or abs(lat_e7) > 900_000_000 or abs(lon_e7) > 1_800_000_000:
        return None
    return LatLon(e7_to_deg(lat_e7), e7_to_deg(lon_e7))


def position_to_e7(place: LatLon) -> tuple[int, int]:
    """A position as MAVLink's 1e-7 degree integers."""
    return deg_to_e7(place.lat_deg), deg_to_e7(place.lon_deg)


def _meridian_radius_m(lat_rad: float) -> float:
    s = math.sin(lat_rad)
    w = 1.0 - WGS84_E2 * s * s
    return WGS84_A_M * (1.0 - WGS84_E2) / (w * math.sqrt(w))


def _normal_radius_m(lat_rad: float) -> float:
    s = math.sin(lat_rad)
    return WGS84_A_M / math.sqrt(1.0 - WGS84_E2 * s * s)


class LocalFrame:
    """North-east metres around an origin, in both directions.

    Accurate to 1 mm within 20 km of the origin at latitudes up to 85°.
    """

    __slots__ = ("_lat0_rad", "_lon0_rad", "_radius0_m", "origin")

    def __init__(self, origin: LatLon) -> None:
        self.origin = origin
        self._lat0_rad = math.radians(origin.lat_deg)
        self._lon0_rad = math.radians(origin.lon_deg)
        self._radius0_m = _meridian_radius_m(self._lat0_rad)

    def _arc_m(self, lat_rad: float, radius_m: float) -> float:
        """Meridian arc from the origin's latitude (Simpson's rule on the radius of curvature, radius_m)."""
        lat0 = self._lat0_rad
        mid = _meridian_radius_m(0.5 * (lat_rad + lat0))
        ends = self._radius0_m + radius_m
        return (lat_rad - lat0) * (ends + 4.0 * mid) / 6.0

    def to_local(self, position: LatLon) -> Point:
        """Project a WGS 84 position."""
        lat = math.radians(position.lat_deg)
        dlon = (math.radians(position.lon_deg) - self._lon0_rad + math.pi) % (2.0 * math.pi) - math.pi
        normal = _normal_radius_m(lat)
        cos_lat = math.cos(lat)
        t2 = math.tan(lat) ** 2
        eta2 = WGS84_E2 / (1.0 - WGS84_E2) * cos_lat * cos_lat
        a = dlon * cos_lat
        fifth = (5.0 - 18.0 * t2 + t2 * t2 + 72.0 * eta2) / 120.0
        east = normal * a * (1.0 + a * a * ((1.0 - t2 + eta2) / 6.0 + a * a * fifth))
        north = self._arc_m(lat, _meridian_radius_m(lat)) + normal * math.tan(lat) * a * a * (
            0.5 + a * a * (5.0 - t2 + 9.0 * eta2) / 24.0
        )
        return Point(north, east)

    def to_global(self, point: Point) -> LatLon:
        """Invert the projection."""
        # The footpoint latitude has the same northing on the central meridian; two Newton steps suffice.
        foot = self._lat0_rad + point.north_m / self._radius0_m
        for _ in range(3):
            radius_m = _meridian_radius_m(foot)
            foot += (point.north_m - self._arc_m(foot, radius_m)) / radius_m
        normal = _normal_radius_m(foot)
        tan_foot = math.tan(foot)
        t2 = tan_foot * tan_foot
        eta2 = WGS84_E2 / (1.0 - WGS84_E2) * math.cos(foot) ** 2
        d = point.east_m / normal
        ratio = normal / _meridian_radius_m(foot)
        lat = foot - ratio * tan_foot * d * d * (0.5 - d * d * (5.0 + 3.0 * t2 + eta2) / 24.0)
        fifth = (5.0 + 28.0 * t2 + 24.0 * t2 * t2) / 120.0
        off = d * (1.0 - d * d * ((1.0 + 2.0 * t2 + eta2) / 6.0 - d * d * fifth))
        lon = self._lon0_rad + off / math.cos(foot)
        lon_deg = (math.degrees(lon) + 180.0) % 360.0 - 180.0
        return LatLon(math.degrees(lat), lon_deg)


def geodesic_m(start: LatLon, end: LatLon) -> float:
    """Distance of two positions some kilometres apart."""
    return math.hypot(*LocalFrame(start).to_local(end))


def longitude_difference_deg(lon_deg: float, from_deg: float) -> float:
    """Eastward difference of two longitudes, the short way around: in [−180, 180)."""
    return (lon_deg - from_deg + 180.0) % 360.0 - 180.0


def from_body_axes(ahead: float, right: float, heading_rad: float) -> Point:
    """A vector in body axes, as north and east; likewise any frame turned clockwise from north."""
    c, s = math.cos(heading_rad), math.sin(heading_rad)
    return Point(ahead * c - right * s, ahead * s + right * c)


def yaw_of_quaternion(q: Sequence[float]) -> float:
    """Yaw of a rotation w, x, y, z (Diebel, "Representing attitude", 2006, equation 290)."""
    w, x, y, z = q
    return math.atan2(2.0 * (w * z + x * y), w * w + x * x - y * y - z * z)


def distance_m(a: Point, b: Point) -> float:
    """Distance of two points of one frame."""
    return math.hypot(b.north_m - a.north_m, b.east_m - a.east_m)


def path_length_m(points: Sequence[Point]) -> float:
    """Sum of the legs; 0 of a single point or none."""
    return sum(distance_m(a, b) for a, b in pairwise(points))


def bearing_rad(a: Point, b: Point) -> float:
    """Direction from a to b, 0 = north, clockwise positive, in [−π, π]."""
    return math.atan2(b.east_m - a.east_m, b.north_m - a.north_m)


class Line:
    """A straight line from start through end, with precomputed direction.

    A line of zero length points north. course_rad is in [−π, π].
    """

    __slots__ = ("_cos", "_sin", "course_rad", "end", "length_m", "start")

    def __init__(self, start: Point, end: Point) -> None:
        self.start = start
        self.end = end
        self.length_m = distance_m(start, end)
        self.course_rad = bearing_rad(start, end)
        self._cos = math.cos(self.course_rad)
        self._sin = math.sin(self.course_rad)

    def along_and_cross_track_m(self, at: Point) -> tuple[float, float]:
        """Distance of `at` along the line from its start, and to the right of it (starboard positive)."""
        north, east = at.north_m - self.start.north_m, at.east_m - self.start.east_m
        return north * self._cos + east * self._sin, east * self._cos - north * self._sin
