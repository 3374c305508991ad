"""Fence and rally points from a file of their own: GeoJSON, a map, or what a mission file has of them.

A GeoJSON file (RFC 7946, WGS 84, [longitude, latitude]) is a FeatureCollection, a Feature or a geometry. The
property `kind` says what a feature is, `radius_m` makes a circle of a point:

| kind | shape | means |
|---|---|---|
| inclusion | polygon, or point with radius_m | the boat stays inside; what they are without a kind |
| exclusion | polygon, or point with radius_m | the boat stays out; so are the holes of an inclusion |
| return_point | point | where a breach leads back to, at most one |
| rally | point | a place to return to; what a point without radius_m is |

A map of any format does as well: the outer line of its `water` is an inclusion, and the islands in it,
everything solid and everything to keep out of are exclusions. Landmarks do not count.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

import shapely
from shapely.geometry import Polygon

from companion.core.geo import LatLon
from mission_tools.errors import MapError, PlanFileError
from mission_tools.geojson import KEPT_OUT, SOLID, labelled, position, tagged_kind
from mission_tools.geojson import KINDS as MAP_KINDS
from mission_tools.maps.assemble import Classified, classified
from mission_tools.maps.geojson import feature_entries, polygon_parts, raw_map, read_json
from mission_tools.maps.map_files import FEATURE_SUFFIXES, read_features
from mission_tools.maps.projection import wrapped_lon_deg
from mission_tools.mission.mission import (
    Command,
    Fence,
    FenceCircle,
    FencePolygon,
    Mission,
    MissionItem,
    MissionType,
    Rally,
)
from mission_tools.mission.plan_file import parse_mission, read_text
from mission_tools.mission.wire import FENCE_COMMANDS, fence_from, mission_from
from mission_tools.mission.wpl_text import parse_lists
from mission_tools.wording import counted

NONE = "none"  # instead of a file: what the boat holds is cleared
FENCE_KINDS = ("inclusion", "exclusion", "return_point")
KINDS = (*FENCE_KINDS, "rally")
ROUTE_KINDS = ("route", "waypoint")  # of a mission that was saved as GeoJSON: not a part of its fence


@dataclass(frozen=True, slots=True)
class Areas:
    """What an upload says about fence and rally points: None nothing, empty that there are to be none.

    fence_name: the fence's file, for messages. notes: what was repaired or skipped in the files.
    """

    fence: Fence | None = None
    rally: tuple[Rally, ...] | None = None
    fence_name: str = ""
    notes: tuple[str, ...] = ()

    def over(self, mission: Mission) -> Mission:
        """The mission with these instead of its own."""
        fence = mission.fence if self.fence is None else self.fence
        return replace(mission, fence=fence, rally=mission.rally if self.rally is None else self.rally)

    def __str__(self) -> str:
        said = []
        if self.fence is not None:
            said.append(counted(len(self.fence.polygons) + len(self.fence.circles), "fence area"))
        if self.rally is not None:
            said.append(counted(len(self.rally), "rally point"))
        return ", ".join(said)

    def lines(self) -> list[str]:
        """The summary and the notes as lines of output."""
        return [str(self), *(f"note: {note}" for note in self.notes)]

    def wire_lists(self) -> dict[MissionType, tuple[MissionItem, ...]]:
        """The lists that are to be as they are here, empty ones too."""
        lists: dict[MissionType, tuple[MissionItem, ...]] = {}
        if self.fence is not None:
            lists[MissionType.FENCE] = self.fence.items()
        if self.rally is not None:
            lists[MissionType.RALLY] = tuple(point.item() for point in self.rally)
        return lists


NO_AREAS = Areas()


class FileAreas(NamedTuple):
    """The fence and the rally points of one file. notes: what was repaired or skipped in it."""

    fence: Fence
    rally: tuple[Rally, ...] = ()
    notes: tuple[str, ...] = ()


def open_areas(fence: str | None, rally: str | None) -> Areas:
    """Read what --fence and --rally name: a file, `none`, or nothing. Raises PlanFileError, MapError: one
    line that names the file and what is wrong in it.
    """
    cleared = FileAreas(Fence())
    fences = None if fence is None else cleared if fence == NONE else load_fence(Path(fence))
    points = None if rally is None else cleared if rally == NONE else load_rally(Path(rally))
    return Areas(
        fence=fences and fences.fence,
        rally=None if points is None else points.rally,
        fence_name=fence or "",
        notes=tuple(dict.fromkeys(note for areas in (fences, points) if areas for note in areas.notes)),
    )


def load_fence(path: Path) -> FileAreas:
    """The fence of a `.plan` or `.geojson` file. Raises PlanFileError, MapError: unreadable, or no fence."""
    areas = _load(path)
    if not (areas.fence.polygons or areas.fence.circles):
        raise PlanFileError(f"{path}: no fence in it: expected a polygon or a circle (--fence none clears)")
    return areas


def load_rally(path: Path) -> FileAreas:
    """Rally points of a `.plan` or `.geojson` file. Raises PlanFileError, MapError: unreadable, or none."""
    areas = _load(path)
    if not areas.rally:
        raise PlanFileError(f"{path}: no rally point in it: expected points (--rally none clears)")
    return areas


def _load(path: Path) -> FileAreas:
    suffix = path.suffix.lower()
    if suffix in (".geojson", ".json"):
        return parse_areas(read_json(path), str(path))
    if suffix in FEATURE_SUFFIXES:
        return _fence_of_map(classified(read_features(path, lines_are_outlines=True)), str(path))
    text = read_text(path)
    try:
        if (lists := parse_lists(text)) is not None:
            return FileAreas(*lists)
        mission = parse_mission(text, str(path))
        stray = [item for item in mission.items if item.command in FENCE_COMMANDS]  # of Mission Planner
        points = [item for item in mission.items if item.command == Command.NAV_RALLY_POINT]
        rally = mission_from({MissionType.RALLY: points}, home_first=False).rally
        return FileAreas(fence_from(stray) if stray else mission.fence, rally or mission.rally)
    except PlanFileError:
        raise
    except ValueError as error:
        raise PlanFileError(f"{path}: {error}") from None


def parse_areas(tree: object, source: str) -> FileAreas:
    """Fence and rally points of decoded GeoJSON; `source` stands before every error message. Raises MapError:
    names the feature and what was expected there.
    """
    found: list[FencePolygon | FenceCircle | Rally] = []
    returns: list[LatLon] = []
    entries = feature_entries(tree, source)
    if any(_is_of_a_map(entry, f"{source}: feature {n}") for n, entry in enumerate(entries, start=1)):
        return _fence_of_map(classified(raw_map(entries, source)), source)
    for number, entry in enumerate(entries, start=1):
        where = f"{source}: feature {number}"
        for part in _parts(entry, where):
            if isinstance(part, LatLon):
                returns.append(part)
            else:
                found.append(part)
        if len(returns) > 1:
            raise MapError(f"{where}: a second return_point: one is enough")
    fence = Fence(
        polygons=tuple(part for part in found if isinstance(part, FencePolygon)),
        circles=tuple(part for part in found if isinstance(part, FenceCircle)),
        return_point=returns[0] if returns else None,
    )
    return FileAreas(fence, tuple(part for part in found if isinstance(part, Rally)))


def _is_of_a_map(entry: object, where: str) -> bool:
    """Whether a feature says what it is on a map, and not in a fence."""
    if isinstance(entry, Mapping) and entry.get("geometry") is None:
        return False
    _, properties, geometry = labelled(entry, where)
    if "kind" in properties:
        return properties["kind"] in MAP_KINDS
    return geometry.get("type") != "Point" and tagged_kind(properties) is not None


def _fence_of_map(found: Classified, source: str) -> FileAreas:
    """The water's outline, without its islands and whatever else is no water to sail on. Raises MapError: no
    water, or several pieces of it, while a boat must be inside of all inclusions.
    """
    features, notes = found
    water = shapely.union_all([feature.shape for feature in features if feature.kind == "water"])
    pieces = [part for part in shapely.get_parts(water) if isinstance(part, Polygon)]
    if len(pieces) != 1:
        raise MapError(
            f"{source}: {len(pieces) or 'no'} separate pieces of water: a fence has one, as a boat must be "
            "inside of all its inclusions"
        )
    closed = [feature.shape for feature in features if feature.kind in SOLID | KEPT_OUT]
    parts = [part for shape in closed for part in shapely.get_parts(shape)]
    exclusions = [*pieces[0].interiors, *(part.exterior for part in parts)]
    outline = _polygon(pieces[0].exterior, is_inclusion=True)
    fence = Fence(polygons=(outline, *(_polygon(ring, is_inclusion=False) for ring in exclusions)))
    return FileAreas(fence, notes=notes)


def _parts(entry: object, where: str) -> Iterator[FencePolygon | FenceCircle | Rally | LatLon]:
    """What one feature stands for; a return point is its bare place."""
    where, properties, geometry = labelled(entry, where)
    is_point, has_radius = geometry.get("type") == "Point", "radius_m" in properties
    kind = properties.get("kind", "rally" if is_point and not has_radius else "inclusion")
    if kind in ROUTE_KINDS:
        return
    if kind not in KINDS:
        raise MapError(f"{where}: kind {kind!r} is none of {', '.join(KINDS)}")
    is_inclusion = kind == "inclusion"
    if is_point:
        lon_deg, lat_deg = position(geometry.get("coordinates"), where)
        place = LatLon(lat_deg, wrapped_lon_deg(lon_deg))
        if kind == "rally":
            yield Rally(place)
        elif kind == "return_point":
            yield place
        else:
            radius_m = _radius_m(properties, where)
            try:
                yield FenceCircle(place, radius_m, is_inclusion)
            except ValueError as error:
                raise MapError(f"{where}: {error}") from None
    elif kind in ("rally", "return_point"):
        raise MapError(f"{where}: a {kind} is a Point, not {geometry.get('type')!r}")
    else:
        for polygon in polygon_parts(geometry, where):
            if polygon.interiors and not is_inclusion:
                raise MapError(f"{where}: an exclusion with a hole: MAVLink has no such fence")
            yield _polygon(polygon.exterior, is_inclusion)
            for hole in polygon.interiors:
                yield _polygon(hole, is_inclusion=False)


def _polygon(ring: shapely.LinearRing, is_inclusion: bool) -> FencePolygon:
    corners = shapely.get_coordinates(ring)[:-1].tolist()
    return FencePolygon(
        tuple(LatLon(lat_deg, wrapped_lon_deg(lon_deg)) for lon_deg, lat_deg in corners), is_inclusion
    )


def _radius_m(properties: Mapping[str, Any], where: str) -> float:
    radius = properties.get("radius_m")
    if isinstance(radius, bool) or not isinstance(radius, int | float) or not 0.0 < radius < math.inf:
        raise MapError(f"{where}: radius_m is {radius!r}: a fence's point needs a radius above 0 metres")
    return float(radius)
