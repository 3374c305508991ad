"""Maps across the antimeridian: longitudes become continuous, and may then be beyond ±180°.

Three spellings are in use: cut at ±180° (RFC 7946), longitudes beyond 180°, and a jump from 180° to −180°.
"""

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

NEAR_DEG = 179.0  # a shape without a corner beyond this is nowhere near the antimeridian
SNAP_DEG = 1e-7  # 1 cm: the two sides of a cut become one line


def is_near_antimeridian(shape: BaseGeometry) -> bool:
    """Whether a shape may need to be made continuous."""
    west, _, east, _ = shape.bounds
    return bool(max(-west, east) > NEAR_DEG)


def continuous(shape: BaseGeometry, near_lon_deg: float) -> BaseGeometry:
    """The shape without jumps, each of its parts shifted by whole turns to be near a longitude."""
    if isinstance(shape, Polygon):
        rings = [shape.exterior, *shape.interiors]
        outer, *holes = (_continuous_ring(shapely.get_coordinates(ring), near_lon_deg) for ring in rings)
        return Polygon(outer, holes)
    if isinstance(shape, MultiPolygon):
        return MultiPolygon([continuous(part, near_lon_deg) for part in shape.geoms])
    moved: BaseGeometry = shapely.transform(shape, lambda lon_lat: _continuous_ring(lon_lat, near_lon_deg))
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
