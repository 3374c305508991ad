"""Reads a map file by its suffix; what a format needs is imported with its first file."""

import importlib
from collections.abc import Callable
from pathlib import Path
from typing import cast

from companion.core.geo import LatLon
from mission_tools.errors import MapError
from mission_tools.maps.assemble import chart_of
from mission_tools.maps.chart import Chart
from mission_tools.maps.raw import RawMap

_FORMATS = "mission_tools.maps.formats."
_VECTOR = (_FORMATS + "vector", "read_vector")
_MASK = (_FORMATS + "mask", "read_mask")
_MISSION = ("mission_tools.maps.fenced", "load_mission_map")
_GEOJSON = ("mission_tools.maps.geojson", "load_geojson")
_FEATURE_READERS: dict[str, tuple[str, str]] = {
    ".kml": (_FORMATS + "kml", "read_kml"),
    ".kmz": (_FORMATS + "kml", "read_kmz"),
    ".gpx": (_FORMATS + "gpx", "read_gpx"),
    **dict.fromkeys((".shp", ".gpkg", ".fgb", ".osm", ".pbf", ".000"), _VECTOR),
    **dict.fromkeys((".png", ".tif", ".tiff"), _MASK),
}
"""For each suffix the module and the function that reads a `RawMap`; imported when a file needs it."""

_CHART_READERS: dict[str, tuple[str, str]] = {
    **dict.fromkeys((".geojson", ".json"), _GEOJSON),
    **dict.fromkeys((".plan", ".waypoints", ".wpl"), _MISSION),
    ".map": (_FORMATS + "grid_map", "load_grid_map"),
}
"""The same for formats that become a chart in another way."""

FEATURE_SUFFIXES = frozenset(_FEATURE_READERS)
MAP_SUFFIXES = (*_CHART_READERS, *_FEATURE_READERS)


def load_map(path: Path, origin: LatLon | None = None, *, lines_are_outlines: bool = False) -> Chart:
    """Read a map file; without an origin the middle of its water becomes one.

    lines_are_outlines: as of `catalogue.load_source`. Raises MapError: the suffix is not known, or the map
    cannot be used.
    """
    suffix = path.suffix.lower()
    if suffix in _FEATURE_READERS:
        return chart_of(read_features(path, lines_are_outlines=lines_are_outlines), origin)
    if suffix not in _CHART_READERS:
        known = ", ".join(MAP_SUFFIXES)
        raise MapError(f"{path}: no map format ends in '{path.suffix}': expected one of {known}")
    load = cast(Callable[[Path, LatLon | None], Chart], _function(*_CHART_READERS[suffix]))
    return load(path, origin)


def read_features(path: Path, *, lines_are_outlines: bool = False) -> RawMap:
    """The features of a map file whose suffix is in FEATURE_SUFFIXES.

    lines_are_outlines: as of `catalogue.load_source`. Raises MapError: the map cannot be used.
    """
    suffix = path.suffix.lower()
    read = cast(Callable[..., RawMap], _function(*_FEATURE_READERS[suffix]))
    return read(path, lines_are_outlines) if suffix == ".gpx" else read(path)


def _function(module: str, name: str) -> Callable[..., object]:
    return cast(Callable[..., object], getattr(importlib.import_module(module), name))
