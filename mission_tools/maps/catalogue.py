"""Finds what a person means by SOURCE: a scenario's name, a scenario file, or a map of a known format."""

import importlib
import importlib.util
from collections.abc import Callable
from pathlib import Path
from typing import cast

from companion.core.geo import LatLon
from mission_tools.errors import MapError
from mission_tools.maps.chart import Chart
from mission_tools.maps.source import Source

_FORMATS = "mission_tools.maps.formats."
_VECTOR = (_FORMATS + "vector", "load_vector")
_MASK = (_FORMATS + "mask", "load_mask")
_MISSION = (_FORMATS + "mission_map", "load_mission_map")
READERS: dict[str, tuple[str, str]] = {
    ".geojson": ("mission_tools.maps.geojson", "load_geojson"),
    ".json": ("mission_tools.maps.geojson", "load_geojson"),
    ".kml": (_FORMATS + "kml", "load_kml"),
    ".kmz": (_FORMATS + "kml", "load_kmz"),
    ".gpx": (_FORMATS + "gpx", "load_gpx"),
    ".plan": _MISSION,
    ".waypoints": _MISSION,
    ".wpl": _MISSION,
    ".shp": _VECTOR,
    ".gpkg": _VECTOR,
    ".fgb": _VECTOR,
    ".osm": _VECTOR,
    ".pbf": _VECTOR,
    ".000": _VECTOR,
    ".map": (_FORMATS + "grid_map", "load_grid_map"),
    ".png": _MASK,
    ".tif": _MASK,
    ".tiff": _MASK,
}
"""For each suffix the module and the function that reads it: a reader is imported when a file needs it."""

PHOTOGRAPHS = frozenset({".jpg", ".jpeg"})


def scenario_folder() -> Path | None:
    """Where the emulator's scenarios are installed; None without the emulator. Does not import it."""
    spec = importlib.util.find_spec("sitl")
    places = spec.submodule_search_locations if spec is not None else None
    return next((Path(place) / "scenarios" for place in places or ()), None)


def scenario_names() -> tuple[str, ...]:
    """The installed scenarios."""
    folder = scenario_folder()
    return tuple(sorted(file.stem for file in folder.glob("*.toml"))) if folder else ()


def load_source(text: str) -> Source:
    """A scenario's name such as `lake`, the path of a scenario (.toml), or of a map (`READERS`).

    Raises:
        MapError: nothing of that name, or it cannot be used.
    """
    path = Path(text)
    suffix = path.suffix.lower()
    if suffix in READERS:
        return Source(load_map(path))
    folder = scenario_folder()
    is_installed = folder is not None and path.name == text and (folder / f"{text}.toml").is_file()
    if suffix == ".toml" or is_installed:
        from mission_tools.maps.scenario import load_scenario  # noqa: PLC0415 (a map needs no TOML)

        return load_scenario(path if suffix == ".toml" else cast(Path, folder) / f"{text}.toml")
    if suffix in PHOTOGRAPHS:
        raise MapError(f"{text}: a photograph: trace its water first, as by mission-trace {path.name} --help")
    known = ", ".join(scenario_names()) or "none installed"
    raise MapError(
        f"{text}: no such scenario (there are: {known}), and no map or scenario file: expected a name that "
        f"ends in .toml, {', '.join(READERS)}"
    )


def load_map(path: Path, origin: LatLon | None = None) -> Chart:
    """Read a map file; without an origin the middle of its water becomes one.

    Raises:
        MapError: the suffix is not known, or the map cannot be used.
    """
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise MapError(f"{path}: no map format ends in '{path.suffix}': expected one of {', '.join(READERS)}")
    module, function = reader
    load = cast(Callable[[Path, LatLon | None], Chart], getattr(importlib.import_module(module), function))
    return load(path, origin)
