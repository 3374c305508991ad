"""Masks of water: PNG with a world file, or GeoTIFF. Bright is water, dark or transparent is land.

The outline runs between pixels and is drawn with fewer corners; then the water is shrunk by what that may
have moved it, so that no pixel of land becomes water. A note says by how much.
"""

import math
import warnings
from io import BytesIO
from itertools import pairwise
from pathlib import Path
from typing import Any, cast

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from companion.core.geo import LatLon
from mission_tools.errors import MapError
from mission_tools.maps.chart import Area, area_of
from mission_tools.maps.formats.georeference import Georeference, georeference_of
from mission_tools.maps.raw import RawFeature, RawMap, read_bytes

Mask = NDArray[np.bool_]
Levels = NDArray[np.uint8]

MAX_PIXELS = 100_000_000  # of a photograph
MAX_MASK_PIXELS = 16_000_000  # each of them is looked at
# Of 16 million pixels, shores whose rows differ have 350 to 1740 pixels a byte, a disc in TIFF's Group 4 has
# 4460, a straight-edged box 8500.
MAX_PIXELS_PER_BYTE = 5_000
ALWAYS_PIXELS = 4_000_000  # are read however few bytes hold them, in under a second
# A fractal shore of 225 000 edges takes 3 s of a desktop core, 7 000 islands in one lake take 1.3 s and four
# times that for twice as many: GEOS' buffer is quadratic in holes.
MAX_EDGES = 250_000  # between a pixel of water and one of land
MAX_OUTLINES = 5_000
TOLERANCE_PIXELS = 0.35  # of the outline's corners; twice that where GEOS drops a ring's first corner
CORNER_PIXELS = 0.354  # half a pixel's half diagonal: how far a contour cuts into a corner
SHRINK_PIXELS = 2.0 * TOLERANCE_PIXELS + CORNER_PIXELS
LEAST_PIXELS = 4.0  # of a piece of water; smaller ones are specks
BRIGHT = 128
_DETAIL_HINT = "remove its specks, crop it or scale it down"


def read_mask(path: Path) -> RawMap:
    """Read a mask. Raises MapError: one line that names the file and what is wrong with it."""
    levels, georeference = read_levels(path)
    return mask_map(levels >= BRIGHT, georeference, str(path), path.stem)


def read_levels(path: Path) -> tuple[Levels, Georeference]:
    """The brightness of each pixel, 0 where it is transparent, and where the picture lies. Raises MapError:
    no picture, in colours, or without a georeference.
    """
    picture, georeference = open_picture(path, MAX_MASK_PIXELS)
    pixels = np.asarray(
        picture.convert("RGBA") if picture.mode in ("P", "PA", "LA", "RGB", "RGBA") else picture
    )
    if pixels.ndim == 2:
        return _scaled(pixels, str(path)), georeference
    colours, alpha = pixels[:, :, :3].astype(np.int16), pixels[:, :, 3]
    if np.abs(colours - colours[:, :, :1]).max(initial=0) > 8:
        raise MapError(
            f"{path}: a picture in colours is no mask: trace its water first, as by mission-trace {path} "
            "--help"
        )
    return np.where(alpha >= BRIGHT, pixels[:, :, 0], 0).astype(np.uint8), georeference


def open_picture(path: Path, most_pixels: int = MAX_PIXELS):  # type: ignore[no-untyped-def]  # noqa: ANN201 (Pillow's own class)
    """A picture and where it lies. Raises MapError: unreadable, too large, or nothing says where it lies."""
    from PIL import Image, UnidentifiedImageError  # noqa: PLC0415 (pictures only)

    data = BytesIO(read_bytes(path))
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # Pillow's, about large pictures and odd tags
            picture = Image.open(data)
            tags = dict(getattr(picture, "tag_v2", {}))
            said = _too_large(picture.width * picture.height, len(data.getbuffer()), most_pixels)
            if not said:
                picture.load()
    except UnidentifiedImageError:  # its text is the address of an object
        raise MapError(f"{path}: not a picture that can be read: expected PNG, JPEG or TIFF") from None
    except Exception as error:  # Pillow raises many kinds on damaged files
        raise MapError(f"{path}: not a picture that can be read: {str(error)[:100]}") from None
    if said:
        raise MapError(f"{path}: {said}")
    return picture, georeference_of(path, tags)


def _too_large(pixels: int, file_bytes: int, most_pixels: int) -> str:
    """Why a picture is not unpacked; empty if it is."""
    if pixels > most_pixels:
        return f"more than {most_pixels // 1_000_000} million pixels: scale it down"
    if pixels > max(ALWAYS_PIXELS, MAX_PIXELS_PER_BYTE * file_bytes):
        return (
            f"{pixels} pixels in {file_bytes} bytes: at most {MAX_PIXELS_PER_BYTE} a byte "
            f"above {ALWAYS_PIXELS // 1_000_000} million pixels: crop it to its water or scale it down"
        )
    return ""


def _scaled(pixels: NDArray[Any], source: str) -> Levels:
    """Brightness of 0 to 255; a mask of other numbers has two values, of which the larger is water."""
    if pixels.dtype == np.uint8:
        largest = pixels.max(initial=0)
        return np.asarray(np.where(pixels > 0, 255, 0) if largest == 1 else pixels, dtype=np.uint8)
    values = pixels[np.isfinite(pixels)] if pixels.dtype.kind == "f" else pixels
    if not values.size:
        raise MapError(f"{source}: no values: a mask has two, the larger is water")
    smallest, largest = values.min(), values.max()
    if ((values != smallest) & (values != largest)).any():
        raise MapError(f"{source}: more than two different values: a mask has two, the larger is water")
    is_water = (pixels == largest) & (largest > 0)
    return np.where(is_water, 255, 0).astype(np.uint8)


def mask_map(mask: Mask, georeference: Georeference, source: str, fallback_name: str) -> RawMap:
    """The water of a mask as a map. Raises MapError: none, or a shore too detailed to plan along."""
    edges = int(np.count_nonzero(mask[1:] != mask[:-1]) + np.count_nonzero(mask[:, 1:] != mask[:, :-1]))
    if edges > MAX_EDGES:
        raise MapError(f"{source}: a shore of {edges} pixel edges: at most {MAX_EDGES}; {_DETAIL_HINT}")
    try:
        water = outlines(mask, MAX_OUTLINES)
    except MapError as error:
        raise MapError(f"{source}: {error}") from None
    if water.is_empty:
        raise MapError(f"{source}: no water in it: no bright pixel (water is white, land is black)")
    degrees = georeference.in_degrees(water, source)
    drawn_m = SHRINK_PIXELS * pixel_m(georeference, water, source)
    note = f"{source}: outline drawn {SHRINK_PIXELS:.2f} pixels ({drawn_m:.2f} m) into the water"
    return RawMap(source, fallback_name, (RawFeature(source, {"kind": "water"}, degrees),), notes=(note,))


def outlines(mask: Mask, most: float = math.inf) -> Area:
    """The water of a mask as polygons of pixel corners (column, row): never over a pixel of land. Raises
    MapError: more lines round water and islands than `most`.
    """
    rows, columns = (np.flatnonzero(mask.any(axis=axis)) for axis in (1, 0))
    if not len(rows):
        return MultiPolygon()
    top, left = int(rows[0]), int(columns[0])
    wet = mask[top : rows[-1] + 1, left : columns[-1] + 1]
    # a land pixel's corner neighbour does not connect
    traced = traced_area(wet, level=0.51, corner=(left, top), most=most)
    simple = area_of(shapely.make_valid(shapely.simplify(traced, TOLERANCE_PIXELS)))
    # GEOS' buffers are up to 1 % too small
    return without_specks(area_of(simple.buffer(-1.03 * SHRINK_PIXELS)))


def traced_area(
    values: NDArray[np.generic], level: float, corner: tuple[int, int] = (0, 0), most: float = math.inf
) -> Area:
    """Polygons of pixel corners around where values are above a level. Beyond the picture is land.

    corner: column and row of the first pixel in the whole picture. Raises MapError: more lines than `most`.
    """
    from contourpy import FillType, contour_generator  # noqa: PLC0415 (pictures only)

    padded = np.pad(values.astype(np.float32), 1)
    generator = contour_generator(z=padded, fill_type=FillType.OuterOffset)
    points, offsets = cast(Any, generator.filled(level, np.inf))
    lines = sum(len(starts) - 1 for starts in offsets)
    if lines > most:
        raise MapError(f"{lines} outlines of water and islands: at most {most}; {_DETAIL_HINT}")
    middle = np.array(corner) - 0.5
    polygons = []
    for corners, starts in zip(points, offsets, strict=True):
        # the middle of padded pixel (1, 1) is at pixel corner (0.5, 0.5)
        rings = [corners[a:b] + middle for a, b in pairwise(starts)]
        polygons.append(Polygon(rings[0], rings[1:]))
    return area_of(shapely.union_all(shapely.make_valid(polygons)))


def without_specks(area: Area) -> MultiPolygon:
    """The pieces of at least LEAST_PIXELS."""
    return MultiPolygon([part for part in shapely.get_parts(area) if part.area >= LEAST_PIXELS])


def pixel_m(georeference: Georeference, near: BaseGeometry, source: str) -> float:
    """The longer side of a pixel, in the middle of a shape of pixel corners."""
    from mission_tools.maps.projection import local_coordinates  # noqa: PLC0415

    at = near.centroid
    cross = shapely.MultiPoint([(at.x, at.y), (at.x + 1.0, at.y), (at.x, at.y + 1.0)])
    lon_lat = shapely.get_coordinates(georeference.in_degrees(cross, source))
    local = local_coordinates(lon_lat, LatLon(float(lon_lat[0, 1]), float(lon_lat[0, 0])))
    return float(np.hypot(*(local[1:] - local[0]).T).max())
