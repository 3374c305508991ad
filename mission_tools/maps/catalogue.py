"""Finds what a person means by SOURCE: a scenario's name, a scenario file, or a map of a known format."""

import importlib.util
from pathlib import Path
from typing import cast

from mission_tools.errors import MapError
from mission_tools.maps.map_files import MAP_SUFFIXES, load_map
from mission_tools.maps.source import Source

PHOTOGRAPHS = frozenset({".jpg", ".jpeg"})


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

    lines_are_outlines: GPX tracks and routes that do not say what they are enclose water. Raises MapError:
    nothing of that name, or it cannot be used.
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
