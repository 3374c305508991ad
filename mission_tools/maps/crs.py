"""The coordinate reference system (CRS) of a GeoJSON file: its positions become WGS 84 degrees.

RFC 7946 knows WGS 84 alone. Its forerunner, GeoJSON 2008, had a member `crs`; GIS programs still write it.
PROJ transforms what it knows; a file whose CRS it does not know, or only roughly, is refused.
"""

import math
import warnings
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
import pyproj
import shapely
from pyproj.transformer import AreaOfInterest, TransformerGroup
from shapely.geometry.base import BaseGeometry

from companion.core.geo import LatLon
from mission_tools.errors import MapError
from mission_tools.maps.projection import LONG_EDGE_M, MOST_PIECES

# PROJ's stated accuracy: NAD83 and GDA94 to WGS 84 have 3 to 4 m, NAD27 without its grid files has 7 to 10 m,
# which is more than a boat's usual clearance
WORST_ACCURACY_M = 5.0
MOST_LENGTH_M = 5e8  # of all lines, twelve times round the Earth: each kilometre becomes a corner
_WGS84 = "EPSG:4326"
_SAME = ("OGC:CRS84", _WGS84)
_ADVICE = "convert the file to WGS 84, as by ogr2ogr -t_srs EPSG:4326 OUT.geojson IN.geojson"


def to_wgs84(tree: Mapping[str, Any], source: str) -> Mapping[str, Any]:
    """A tree that names a CRS with its positions in WGS 84. Raises MapError: why the CRS cannot be used."""
    name = _name(tree["crs"], source)
    leaves: list[list[Any]] = []
    rest = {key: value for key, value in tree.items() if key != "crs"}
    crs = _known(name, source)
    step = LONG_EDGE_M / (crs.axis_info[0].unit_conversion_factor or 1.0) if crs.is_projected else math.inf
    copied: dict[str, Any] = _copied(rest, leaves, step)
    if leaves and not _is_wgs84(crs):
        found = _transformed([leaf[:2] for leaf in leaves], crs, f'{source}: crs "{name}" ({crs.name})')
        for leaf, lon_lat in zip(leaves, found, strict=True):
            leaf[:2] = lon_lat
    return copied


def shapes_to_wgs84(shapes: Sequence[BaseGeometry], name: str, source: str) -> list[BaseGeometry]:
    """Shapes of one CRS, named as PROJ understands it (also WKT), in WGS 84 degrees.

    Edges longer than 1 km of a projected CRS get corners in between, as they are straight there. Raises
    MapError: as `to_wgs84`.
    """
    crs = _known(name, source)
    if not shapes or _is_wgs84(crs):
        return list(shapes)
    if crs.is_projected:
        unit_m = crs.axis_info[0].unit_conversion_factor or 1.0
        length_m = unit_m * sum(shape.length for shape in shapes)
        if length_m > MOST_LENGTH_M:
            raise MapError(
                f"{source}: its lines are {length_m / 1000:.3g} km long in crs {crs.name}: "
                f"at most {MOST_LENGTH_M / 1000:g} km; cut out what matters"
            )
        shapes = [shapely.segmentize(shape, LONG_EDGE_M / unit_m) for shape in shapes]
    xy = shapely.get_coordinates(shapes)
    where = f"{source}: crs {crs.name}"
    if not len(xy):
        return list(shapes)
    if not np.isfinite(xy).all():
        raise MapError(f"{where}: a coordinate is not a number")
    lon_lat = _transformed(xy.tolist(), crs, where)
    return list(shapely.set_coordinates(np.array(shapes, dtype=object), np.array(lon_lat)))


def from_wgs84(place: LatLon, name: str, source: str) -> tuple[float, float]:
    """x and y of a place in a CRS. Raises MapError: the CRS is not known, or has no place for it."""
    crs = _known(name, source)
    x, y = pyproj.Transformer.from_crs(_WGS84, crs, always_xy=True).transform(place.lon_deg, place.lat_deg)
    if not (math.isfinite(x) and math.isfinite(y)):
        raise MapError(f"{source}: {place.lat_deg:.6f},{place.lon_deg:.6f} is outside of {crs.name}")
    return x, y


def _is_wgs84(crs: pyproj.CRS) -> bool:
    return any(crs.equals(pyproj.CRS(same), ignore_axis_order=True) for same in _SAME)


def _name(given: object, source: str) -> str:
    """The name in a `crs` member: of the form of 2008, or an EPSG number as still older files have it."""
    properties = given.get("properties") if isinstance(given, Mapping) else None
    if isinstance(given, Mapping) and isinstance(properties, Mapping):
        if given.get("type") == "name" and isinstance(properties.get("name"), str):
            return str(properties["name"])
        if given.get("type") == "EPSG" and isinstance(properties.get("code"), int | str):
            return f"EPSG:{properties['code']}"
    raise MapError(f"{source}: crs {str(given)[:80]} is not the name of one; {_ADVICE}")


def _known(name: str, source: str) -> pyproj.CRS:
    try:
        return pyproj.CRS.from_user_input(name)
    except pyproj.exceptions.CRSError:
        raise MapError(f'{source}: crs "{name}" is not known; {_ADVICE}') from None


def _transformed(positions: Sequence[Sequence[float]], crs: pyproj.CRS, where: str) -> list[list[float]]:
    """Longitude and latitude of each x and y. Raises MapError: no transformation good enough here."""
    x, y = ([float(at[axis]) for at in positions] for axis in (0, 1))
    found = list(map(list, zip(*_best(x, y, crs, where).transform(x, y), strict=True)))
    for number, (lon_lat, at) in enumerate(zip(found, positions, strict=True), 1):
        if not all(map(math.isfinite, lon_lat)):
            raise MapError(f"{where}: position {number}, {list(at)}, is outside of it; {_ADVICE}")
    return found


def _best(x: list[float], y: list[float], crs: pyproj.CRS, where: str) -> pyproj.Transformer:
    """The best transformation for where the data lie; a CRS may have several, each for its own country."""
    try:
        area = _area(x, y, crs)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)  # that a better one needs a file which is not here
            found = TransformerGroup(
                crs, _WGS84, always_xy=True, area_of_interest=area, allow_ballpark=False
            ).transformers
    except pyproj.exceptions.ProjError:
        found = []
    known = [transformer for transformer in found if transformer.accuracy >= 0.0]
    if not known:
        raise MapError(f"{where}: no transformation to WGS 84 is known for this place; {_ADVICE}")
    if known[0].accuracy > WORST_ACCURACY_M:
        raise MapError(
            f"{where}: can be transformed to WGS 84 only to {known[0].accuracy:g} m here, "
            f"expected {WORST_ACCURACY_M:g} m or better; {_ADVICE}, with this CRS's grid files installed"
        )
    return known[0]


def _area(x: list[float], y: list[float], crs: pyproj.CRS) -> AreaOfInterest | None:
    """Bounds in degrees, roughly: in the CRS's own datum. None where it has none, or the data are outside."""
    if crs.geodetic_crs is None:
        return None
    to_degrees = pyproj.Transformer.from_crs(crs, crs.geodetic_crs, always_xy=True)
    lon_deg, lat_deg = to_degrees.transform(x, y)
    if not all(map(math.isfinite, (*lon_deg, *lat_deg))) or max(map(abs, lat_deg)) > 90.0:
        return None
    return AreaOfInterest(min(lon_deg), min(lat_deg), max(lon_deg), max(lat_deg))


def _copied(value: Any, leaves: list[list[Any]], step: float) -> Any:  # noqa: ANN401 (decoded JSON)
    """A copy of decoded JSON; `leaves` gets every position in it. step: longest edge without corners."""
    if isinstance(value, Mapping):
        return {
            key: _coordinates(part, leaves, step) if key == "coordinates" else _copied(part, leaves, step)
            for key, part in value.items()
        }
    if isinstance(value, list):
        return [_copied(part, leaves, step) for part in value]
    return value


def _coordinates(value: Any, leaves: list[list[Any]], step: float) -> Any:  # noqa: ANN401 (decoded JSON)
    if not isinstance(value, list):
        return value
    if _is_position(value):
        leaf = list(value)
        leaves.append(leaf)
        return leaf
    if value and math.isfinite(step) and all(map(_is_position, value)):
        value = _with_corners(value, step)
    return [_coordinates(part, leaves, step) for part in value]


def _is_position(value: object) -> bool:
    return (
        isinstance(value, list)
        and len(value) >= 2
        and all(
            isinstance(n, int | float) and not isinstance(n, bool) and math.isfinite(n) for n in value[:2]
        )
    )


def _with_corners(line: list[list[Any]], step: float) -> list[list[Any]]:
    """Positions with others between them, so that no edge is longer than a step."""
    found = [line[0]]
    for start, end in pairwise(line):
        count = min(math.ceil(math.dist(start[:2], end[:2]) / step), MOST_PIECES)
        found += [
            [start[axis] + n / count * (end[axis] - start[axis]) for axis in (0, 1)] for n in range(1, count)
        ]
        found.append(end)
    return found
