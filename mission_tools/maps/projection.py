"""WGS 84 positions to a local frame: `companion.core.geo.LocalFrame` for whole geometries.

A straight line of a map is not straight in the frame, so long edges get corners in between first.
"""

import math
from collections.abc import Callable
from typing import Literal

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from companion.core.geo import WGS84_A_M, WGS84_E2, LatLon, LocalFrame, Point

Coordinates = NDArray[np.float64]

DEVIATION_M = 0.01  # of an edge in the frame from the same edge on the map
LONG_EDGE_M = 1000.0
MOST_PIECES = 10_000  # of an edge; an edge that needs more is longer than any chart


def to_local(geometry: BaseGeometry, origin: LatLon) -> BaseGeometry:
    """Project a geometry of (longitude, latitude) degrees to (east, north) metres around the origin."""

    def project(lon_lat: Coordinates) -> Coordinates:
        return local_coordinates(lon_lat, origin)

    projected: BaseGeometry = shapely.transform(geometry, project)
    return projected


def local_coordinates(lon_lat: Coordinates, origin: LatLon) -> Coordinates:
    """(longitude, latitude) degrees as (east, north) metres, as `LocalFrame.to_local` for each row."""
    lat0, lat = math.radians(origin.lat_deg), np.radians(lon_lat[:, 1])
    east_deg = (lon_lat[:, 0] - origin.lon_deg + 180.0) % 360.0 - 180.0
    cos_lat, tan_lat = np.cos(lat), np.tan(lat)
    normal = WGS84_A_M / np.sqrt(1.0 - WGS84_E2 * np.sin(lat) ** 2)
    t2, eta2 = tan_lat**2, WGS84_E2 / (1.0 - WGS84_E2) * cos_lat**2
    a = np.radians(east_deg) * cos_lat
    fifth = (5.0 - 18.0 * t2 + t2**2 + 72.0 * eta2) / 120.0
    east = normal * a * (1.0 + a**2 * ((1.0 - t2 + eta2) / 6.0 + a**2 * fifth))
    arc = (lat - lat0) * (_meridian(lat0) + 4.0 * _meridian(0.5 * (lat + lat0)) + _meridian(lat)) / 6.0
    north = arc + normal * tan_lat * a**2 * (0.5 + a**2 * (5.0 - t2 + 9.0 * eta2) / 24.0)
    return np.column_stack((east, north))


def _meridian(lat_rad: NDArray[np.float64] | float) -> NDArray[np.float64]:
    w = 1.0 - WGS84_E2 * np.sin(lat_rad) ** 2
    found: NDArray[np.float64] = WGS84_A_M * (1.0 - WGS84_E2) / (w * np.sqrt(w))
    return found


def densified(geometry: BaseGeometry, edges: Literal["degrees", "geodesic"]) -> BaseGeometry:
    """The geometry with corners on its long edges, so that its projected edges deviate by 1 cm at most.

    edges: straight in longitude and latitude (GeoJSON, shapefiles), or geodesics (KML, GPX).
    """
    split = _split_degrees if edges == "degrees" else _split_geodesic
    return _with_rings(geometry, split)


def _with_rings(geometry: BaseGeometry, change: Callable[[Coordinates], Coordinates]) -> BaseGeometry:
    if isinstance(geometry, Polygon):
        outer, *holes = (
            change(shapely.get_coordinates(ring)) for ring in (geometry.exterior, *geometry.interiors)
        )
        return Polygon(outer, holes)
    if isinstance(geometry, MultiPolygon):
        return MultiPolygon([_with_rings(part, change) for part in geometry.geoms])
    return geometry


def _split_degrees(ring: Coordinates) -> Coordinates:
    """Corners on the chord in degrees. An edge turns on Earth by its change of longitude × sin(latitude)."""
    delta, lat = np.diff(ring, axis=0), np.radians(0.5 * (ring[1:, 1] + ring[:-1, 1]))
    lon_rad, lat_rad = np.abs(np.radians(delta)).T
    bend_m = WGS84_A_M * np.abs(np.sin(lat)) * lon_rad * (0.125 * np.cos(lat) * lon_rad + 0.25 * lat_rad)
    pieces = np.ceil(np.sqrt(bend_m / DEVIATION_M))
    long = np.ceil(WGS84_A_M * np.hypot(np.cos(lat) * lon_rad, lat_rad) / LONG_EDGE_M)
    return _split(ring, np.maximum(pieces, long), lambda n, shares: ring[n] + shares * delta[n])


def _split_geodesic(ring: Coordinates) -> Coordinates:
    """Corners on the geodesic, which is straight in a frame around the edge's middle."""
    middle = np.radians(0.5 * (ring[1:, 1] + ring[:-1, 1]))
    delta = np.radians(np.diff(ring, axis=0))
    length = WGS84_A_M * np.hypot(np.cos(middle) * delta[:, 0], delta[:, 1])

    def between(n: int, shares: Coordinates) -> Coordinates:
        lon_deg, lat_deg = 0.5 * (ring[n] + ring[n + 1])
        frame = LocalFrame(LatLon(lat_deg, wrapped_lon_deg(lon_deg)))
        (east, north), (east1, north1) = local_coordinates(ring[n : n + 2], frame.origin)
        places = [
            frame.to_global(Point(north + t * (north1 - north), east + t * (east1 - east)))
            for t in shares[:, 0].tolist()
        ]
        lons = np.array([place.lon_deg for place in places])
        lons += 360.0 * np.round((lon_deg - lons) / 360.0)
        return np.column_stack((lons, [place.lat_deg for place in places]))

    return _split(ring, np.ceil(length / LONG_EDGE_M), between)


def _split(
    ring: Coordinates,
    pieces: NDArray[np.float64],
    between: Callable[[int, Coordinates], Coordinates],
) -> Coordinates:
    """The ring with each edge in so many pieces; `between` gives the places at shares of an edge."""
    (cut,) = np.nonzero(pieces > 1.0)
    if not len(cut):
        return ring
    parts, done = [], 0
    for n in cut.tolist():
        count = int(min(pieces[n], MOST_PIECES))
        shares = np.arange(1, count, dtype=np.float64)[:, None] / count
        parts += [ring[done : n + 1], between(n, shares)]
        done = n + 1
    return np.concatenate([*parts, ring[done:]])


NEAR_DEG = 179.0  # a shape without a corner beyond this is nowhere near the antimeridian
SNAP_DEG = 1e-7  # 1 cm: the two sides of a cut become one line


def is_near_antimeridian(shape: BaseGeometry) -> bool:
    """Whether a shape may need to be made continuous."""
    west, _, east, _ = shape.bounds
    return bool(max(-west, east) > NEAR_DEG)


def continuous(shape: BaseGeometry, near_lon_deg: float) -> BaseGeometry:
    """The shape without jumps, each of its parts shifted by whole turns to be near a longitude."""

    def change(lon_lat: Coordinates) -> Coordinates:
        return _continuous_ring(lon_lat, near_lon_deg)

    if isinstance(shape, Polygon | MultiPolygon):
        return _with_rings(shape, change)
    moved: BaseGeometry = shapely.transform(shape, change)
    return moved


def wrapped_lon_deg(lon_deg: float) -> float:
    """A longitude in [−180, 180]."""
    return lon_deg if abs(lon_deg) <= 180.0 else (lon_deg + 180.0) % 360.0 - 180.0


def _continuous_ring(lon_lat: NDArray[np.float64], near_lon_deg: float) -> NDArray[np.float64]:
    lon_deg = np.unwrap(lon_lat[:, 0], period=360.0)
    middle = 0.5 * (lon_deg.min() + lon_deg.max())
    lon_deg = lon_deg - 360.0 * round((middle - near_lon_deg) / 360.0)
    at_cut = np.round((lon_deg - 180.0) / 360.0) * 360.0 + 180.0
    lon_deg = np.where(np.abs(lon_deg - at_cut) < SNAP_DEG, at_cut, lon_deg)
    return np.column_stack((lon_deg, lon_lat[:, 1]))
