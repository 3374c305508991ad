"""Where the pixels of a picture lie: a world file beside it, or the tags of a GeoTIFF.

World file: six lines A, D, B, E, C, F; the middle of pixel (column, row) is at x = A·column + B·row + C,
y = D·column + E·row + F. Its reference system is in a .prj beside it, else WGS 84 if the numbers are degrees.
GeoTIFF: OGC 19-008, requirements for ModelPixelScale, ModelTiepoint, ModelTransformation and GeoKeyDirectory.
"""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from companion.core.geo import LatLon
from mission_tools.errors import MapError
from mission_tools.maps.raw import read_bytes

_SCALE, _TIEPOINTS, _TRANSFORMATION, _KEYS = 33550, 33922, 34264, 34735
_RASTER_TYPE, _GEOGRAPHIC_CRS, _PROJECTED_CRS = 1025, 2048, 3072
_PIXEL_IS_POINT, _USER_DEFINED = 2, 32767
_HINT = "add a world file beside it (.pgw, .jgw, .tfw), as GIS programs write it, or use a GeoTIFF"


class Georeference(NamedTuple):
    """x = a·column + b·row + c, y = d·column + e·row + f, of pixel corners; crs as PROJ understands it."""

    a: float
    b: float
    c: float
    d: float
    e: float
    f: float
    crs: str

    def places(self, column_row: NDArray[np.float64]) -> NDArray[np.float64]:
        """x and y of pixel corners (column, row)."""
        column, row = column_row[:, 0], column_row[:, 1]
        return np.column_stack(
            (self.a * column + self.b * row + self.c, self.d * column + self.e * row + self.f)
        )

    def in_degrees(self, shape: BaseGeometry, source: str) -> BaseGeometry:
        """A shape of pixel corners in WGS 84. Raises MapError: the reference system cannot be transformed."""
        placed = shapely.transform(shape, self.places)
        if self.crs == "EPSG:4326":
            return placed
        from mission_tools.maps.crs import shapes_to_wgs84  # noqa: PLC0415 (PROJ takes 0.1 s to import)

        return shapes_to_wgs84([placed], self.crs, source)[0]

    def pixel_of(self, place: LatLon, source: str) -> tuple[float, float]:
        """Column and row of a place, in pixel corners. Raises MapError: the CRS cannot be transformed."""
        x, y = place.lon_deg, place.lat_deg
        if self.crs != "EPSG:4326":
            from mission_tools.maps.crs import from_wgs84  # noqa: PLC0415 (PROJ takes 0.1 s to import)

            x, y = from_wgs84(place, self.crs, source)
        determinant = self.a * self.e - self.b * self.d
        dx, dy = x - self.c, y - self.f
        return (self.e * dx - self.b * dy) / determinant, (self.a * dy - self.d * dx) / determinant


def georeference_of(path: Path, tags: Mapping[int, Any] | None = None) -> Georeference:
    """Where a picture lies. tags: of a TIFF. Raises MapError: nothing says where in usable numbers."""
    if tags and (_TRANSFORMATION in tags or (_SCALE in tags and _TIEPOINTS in tags)):
        found = _of_tags(tags, str(path))
    else:
        world = _world_file(path)
        if world is None:
            raise MapError(f"{path}: nothing says where it lies: {_HINT}")
        found = _of_world_file(world, path)
    if not all(map(math.isfinite, found[:6])) or abs(found.a * found.e - found.b * found.d) == 0.0:
        raise MapError(f"{path}: its georeference is not usable: {[round(n, 9) for n in found[:6]]}")
    return found


def _world_file(path: Path) -> Path | None:
    """The world file of a picture: x.pgw, x.pngw, x.png.wld or x.wld for x.png, in any case."""
    suffix = path.suffix.lower()[1:]
    names = {
        f"{path.stem}.{ending}"
        for ending in (suffix[0] + suffix[-1] + "w", suffix + "w", "wld", f"{suffix}.wld")
    }
    wanted = {name.lower() for name in names}
    try:
        beside = sorted(path.parent.iterdir())
    except OSError:
        return None
    return next((file for file in beside if file.name.lower() in wanted and file.is_file()), None)


def _of_world_file(world: Path, picture: Path) -> Georeference:
    try:
        numbers = [float(word) for word in read_bytes(world).decode("ascii").split()]
    except ValueError:
        numbers = []
    if len(numbers) != 6:
        raise MapError(f"{world}: not a world file: expected six numbers")
    a, d, b, e, c, f = numbers
    prj = picture.with_suffix(".prj")
    if prj.is_file():
        crs = read_bytes(prj).decode("utf-8", "replace").strip()
    elif abs(c) <= 360.0 and abs(f) <= 90.0 and max(map(abs, (a, b, d, e))) < 0.1:
        crs = "EPSG:4326"
    else:
        raise MapError(f"{world}: {c:g}, {f:g} are no degrees: name its reference system in {prj.name}")
    return Georeference(a, b, c - 0.5 * (a + b), d, e, f - 0.5 * (d + e), crs)


def _of_tags(tags: Mapping[int, Any], source: str) -> Georeference:
    keys = _geo_keys(tags.get(_KEYS, ()))
    code = keys.get(_PROJECTED_CRS) or keys.get(_GEOGRAPHIC_CRS)
    if code is None or code == _USER_DEFINED:
        raise MapError(f"{source}: names no reference system by its EPSG code: {_HINT}")
    try:
        if _TRANSFORMATION in tags:
            m = [float(number) for number in tags[_TRANSFORMATION]]
            a, b, c, d, e, f = m[0], m[1], m[3], m[4], m[5], m[7]
        else:
            sx, sy = (float(number) for number in tags[_SCALE][:2])
            column, row, _, x, y, _ = (float(number) for number in tags[_TIEPOINTS][:6])
            a, b, c, d, e, f = sx, 0.0, x - sx * column, 0.0, -sy, y + sy * row
    except (TypeError, ValueError, IndexError):
        raise MapError(f"{source}: its GeoTIFF tags are not usable") from None
    if keys.get(_RASTER_TYPE) == _PIXEL_IS_POINT:
        c, f = c - 0.5 * (a + b), f - 0.5 * (d + e)
    return Georeference(a, b, c, d, e, f, f"EPSG:{code}")


def _geo_keys(directory: Sequence[int]) -> dict[int, int]:
    """The keys of a GeoKeyDirectory whose values stand in it."""
    entries = [tuple(directory[n : n + 4]) for n in range(4, len(directory) - 3, 4)]
    return {int(key): int(value) for key, location, _, value in entries if location == 0}
