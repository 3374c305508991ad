"""Finds what a person means by SOURCE: a scenario's name, a scenario file, or a map of a known format."""

import importlib
import importlib.util
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import cast

from companion.core.geo import LatLon, Point
from mission_tools.errors import MapError, UsageError
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

PHOTOGRAPHS = frozenset({".jpg", ".jpeg"})


@dataclass(frozen=True, slots=True)
class RouteDefaults:
    """What a scenario says about its route; None where it says nothing."""

    start: Point | None = None
    goal: Point | None = None
    via: tuple[Point, ...] = ()
    clearance_m: float | None = None
    margin_m: float | None = None
    cell_m: float | None = None
    heuristic: str | None = None
    smooth: bool | None = None


@dataclass(frozen=True, slots=True)
class Source:
    """A chart with the route that its scenario proposes, and its named cases (start, goal)."""

    chart: Chart
    route: RouteDefaults = RouteDefaults()
    cases: Mapping[str, tuple[Point, Point]] = field(default_factory=dict)

    def with_case(self, name: str) -> "Source":
        """The same source with a case's start and goal.

        Raises:
            UsageError: no case of that name.
        """
        if name not in self.cases:
            known = ", ".join(self.cases) or "none"
            raise UsageError(f"no case {name!r} in {self.chart.name}: there are {known}")
        start, goal = self.cases[name]
        return replace(self, route=replace(self.route, start=start, goal=goal, via=()))


def emulator_folder(name: str) -> Path | None:
    """Where the emulator's `boats` or `scenarios` are installed; None without it. Does not import it."""
    spec = importlib.util.find_spec("sitl")
    places = spec.submodule_search_locations if spec is not None else None
    return next((Path(place) / name for place in places or ()), None)


def scenario_names() -> tuple[str, ...]:
    """The names of the scenarios that come with the emulator."""
    folder = emulator_folder("scenarios")
    return tuple(sorted(file.stem for file in folder.glob("*.toml"))) if folder else ()


def load_source(text: str, *, lines_are_outlines: bool = False) -> Source:
    """A scenario's name such as `lake`, the path of a scenario (.toml), or of a map (MAP_SUFFIXES).

    lines_are_outlines: GPX tracks and routes that do not say what they are enclose water.

    Raises:
        MapError: nothing of that name, or it cannot be used.
    """
    path = Path(text)
    suffix = path.suffix.lower()
    if suffix in MAP_SUFFIXES:
        return Source(load_map(path, lines_are_outlines=lines_are_outlines))
    folder = emulator_folder("scenarios")
    is_installed = folder is not None and path.name == text and (folder / f"{text}.toml").is_file()
    if suffix == ".toml" or is_installed:
        from mission_tools.maps.scenario import load_scenario  # noqa: PLC0415 (a map needs no TOML)

        return load_scenario(path if suffix == ".toml" else cast(Path, folder) / f"{text}.toml")
    if suffix in PHOTOGRAPHS:
        raise MapError(f"{text}: a photograph: trace its water first, as by mission-trace {path} --help")
    if path.is_dir():
        raise MapError(f"{text}: a folder: expected a map or scenario file in it")
    known = ", ".join(scenario_names()) or "none installed"
    raise MapError(
        f"{text}: no such scenario (there are: {known}), and no map or scenario file: expected a name that "
        f"ends in .toml, {', '.join(MAP_SUFFIXES)}"
    )


def load_map(path: Path, origin: LatLon | None = None, *, lines_are_outlines: bool = False) -> Chart:
    """Read a map file; without an origin the middle of its water becomes one.

    lines_are_outlines: as of `load_source`.

    Raises:
        MapError: the suffix is not known, or the map cannot be used.
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

    lines_are_outlines: as of `load_source`.

    Raises:
        MapError: the map cannot be used.
    """
    suffix = path.suffix.lower()
    read = cast(Callable[..., RawMap], _function(*_FEATURE_READERS[suffix]))
    return read(path, lines_are_outlines) if suffix == ".gpx" else read(path)


def _function(module: str, name: str) -> Callable[..., object]:
    return cast(Callable[..., object], getattr(importlib.import_module(module), name))
