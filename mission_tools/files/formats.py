"""Writes a mission in the format of a file's suffix."""

from collections.abc import Callable
from pathlib import Path

from companion.cli.output_file import write_text
from companion.core.errors import OutputError
from mission_tools.errors import PlanFileError
from mission_tools.files import geojson_route, gpx_route, kml_route
from mission_tools.mission.mission import Mission
from mission_tools.mission.plan_file import MISSION_SUFFIXES, save_mission

_COMPOSERS: dict[str, Callable[[Mission, str], str]] = {
    ".geojson": geojson_route.compose,
    ".kml": kml_route.compose,
    ".gpx": gpx_route.compose,
}
ROUTE_SUFFIXES = frozenset(_COMPOSERS) | MISSION_SUFFIXES


def check_route_name(path: Path) -> None:
    """See whether a mission can be written under this name.

    Raises:
        PlanFileError: its suffix is of no format that is written here.
    """
    suffix = path.suffix.lower()
    if suffix not in ROUTE_SUFFIXES:
        raise PlanFileError(
            f"{path}: missions are written as .plan (QGroundControl), as .waypoints, .wpl, .txt (QGC WPL "
            "110), or as .geojson, .kml, .gpx, and drawn as .html, .png, .svg, .pdf: expected a name that "
            "ends in one of these"
        )


def save_route(mission: Mission, path: Path, title: str = "") -> None:
    """Write a mission. title: what the file calls itself; else the file's name.

    Raises:
        PlanFileError: the name cannot be used, the file cannot be written, or the format cannot hold the
            mission.
    """
    check_route_name(path)
    compose = _COMPOSERS.get(path.suffix.lower())
    if compose is None:
        save_mission(mission, path)
        return
    try:
        write_text(path, compose(mission, title or path.stem))
    except OutputError as error:
        raise PlanFileError(str(error)) from None
