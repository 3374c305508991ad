"""Finds what a person means by SOURCE: a scenario's name, a scenario file, or a GeoJSON file."""

import importlib.util
from pathlib import Path

from mission_tools.errors import MapError
from mission_tools.maps.geojson import load_geojson
from mission_tools.maps.scenario import load_scenario
from mission_tools.maps.source import Source


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
    """A scenario's name such as `lake`, the path of a scenario (.toml), or of a map (.geojson, .json).

    Raises:
        MapError: nothing of that name, or it cannot be used.
    """
    path = Path(text)
    if path.suffix in (".geojson", ".json"):
        return Source(load_geojson(path))
    if path.suffix == ".toml":
        return load_scenario(path)
    folder = scenario_folder()
    if folder is not None and path.name == text and (folder / f"{text}.toml").is_file():
        return load_scenario(folder / f"{text}.toml")
    known = ", ".join(scenario_names()) or "none installed"
    raise MapError(f"{text}: no such scenario (there are: {known}), and not a .toml or .geojson file")
