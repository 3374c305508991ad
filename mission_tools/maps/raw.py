"""What a reader finds in a map file, before anything is repaired or classified.

Every reader ends here, so that one file (`assemble.py`) decides for all formats what is water.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, NamedTuple

from shapely.geometry.base import BaseGeometry

from mission_tools.errors import MapError

MAX_FILE_BYTES = 256_000_000


class RawFeature(NamedTuple):
    """A shape in WGS 84 degrees, x longitude, y latitude. It may be invalid or cross the antimeridian.

    where: for messages, with the file: `lake.kml: placemark 3 "Isle"`.
    """

    where: str
    properties: Mapping[str, Any]
    shape: BaseGeometry


@dataclass(frozen=True, slots=True)
class RawMap:
    """The features of a file.

    title: what the file calls itself. fallback_name: a name where nothing in the file has one.
    notes: what was repaired or skipped while reading. edges: what a straight line of the format is on Earth.
    unlabelled: what a polygon is that does not say what it is. nested: what it is within other water.
    """

    source: str
    fallback_name: str
    features: tuple[RawFeature, ...]
    title: str = ""
    notes: tuple[str, ...] = ()
    edges: Literal["degrees", "geodesic"] = "degrees"
    unlabelled: Literal["water", "skipped"] = "water"
    nested: Literal["asked about", "land"] = "asked about"


def read_bytes(path: Path) -> bytes:
    """A map file. Raises MapError: it cannot be read, or is too large for a map of one piece of water."""
    try:
        if path.stat().st_size > MAX_FILE_BYTES:
            raise MapError(f"{path}: more than {MAX_FILE_BYTES // 1_000_000} MB: cut out what matters")
        return path.read_bytes()
    except OSError as error:
        raise MapError(f"{path}: cannot be read: {error.strerror}") from None
