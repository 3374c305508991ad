"""Routes that other programs drew, as missions: GPX 1.0 and 1.1, KML 2.2, GeoJSON (RFC 7946).

A route counts before a track or line, a line before single points; several lines are sailed one after the
other. A polygon is an area, not a route. What this package wrote itself (`written.py`)
keeps its home, and in GeoJSON its holds.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final, NamedTuple
from xml.etree.ElementTree import Element

import shapely

from companion.core.geo import LatLon, LocalFrame, Point, geodesic_m
from mission_tools.errors import PlanFileError
from mission_tools.geojson import position
from mission_tools.maps.formats.kml import parse_xml, text_of
from mission_tools.maps.geojson import feature_entries, read_json
from mission_tools.maps.projection import wrapped_lon_deg
from mission_tools.maps.raw import read_bytes
from mission_tools.mission.mission import Command, Mission, MissionItem
from mission_tools.overwrite_guard import CREATOR, GENERATOR, XML_HEADS

MOST_BYTES: Final = 20_000_000  # a day's track of a receiver at 10 Hz has half of it
THINNED_ABOVE: Final = 500
"""Points of a line: a track of a receiver has one a second, which is more than a boat needs or holds."""
THINNED_M: Final = 1.0  # what a line is moved by at most: half a waypoint radius
_SAME_M: Final = 0.05
_SAILED: Final = ("LineString", "MultiLineString", "Point", "MultiPoint")
_HOME: Final = "Home"


class DrawnStop(NamedTuple):
    """A place. hold_s: to wait there; is_home: where the boat lay, not a place to sail to."""

    place: LatLon
    hold_s: float = 0.0
    is_home: bool = False


@dataclass(slots=True)
class Drawn:
    """What is in a file: routes, then lines, then single points, in the order of the file."""

    routes: list[list[DrawnStop]] = field(default_factory=list)
    lines: list[list[DrawnStop]] = field(default_factory=list)
    points: list[DrawnStop] = field(default_factory=list)


class DrawnMission(NamedTuple):
    """notes: for a person."""

    mission: Mission
    notes: tuple[str, ...]


def load_drawn(path: Path) -> DrawnMission:
    """The route in a .gpx, .kml or .geojson file. Raises MapError, PlanFileError: one line that names the
    file and what was expected in it.
    """
    read = _READERS.get(path.suffix.lower())
    if read is None:
        raise PlanFileError(f"{path}: no route is read from '{path.suffix}': expected .gpx, .kml or .geojson")
    if path.is_file() and path.stat().st_size > MOST_BYTES:
        raise PlanFileError(f"{path}: more than {MOST_BYTES // 1_000_000} MB: expected a route")
    drawn = read(path)
    lines = [line for line in drawn.routes or drawn.lines if line]
    notes: list[str] = []
    if len(lines) > 1:
        notes.append(f"{len(lines)} lines, sailed one after the other")
    stops = [stop for line in lines for stop in _thinned(line, notes)] or drawn.points
    home = next((stop.place for stop in stops if stop.is_home), None)
    items = tuple(_items(stops))
    if not items:
        raise PlanFileError(f"{path}: no route: expected a line or points (an area is for --survey)")
    return DrawnMission(Mission(items, home), tuple(notes))


def _items(stops: Sequence[DrawnStop]) -> Iterator[MissionItem]:
    before: LatLon | None = None
    for stop in stops:
        if stop.is_home or (before is not None and not stop.hold_s and _is_same(before, stop.place)):
            continue
        before = stop.place
        yield MissionItem.at(stop.place, Command.NAV_WAYPOINT, (stop.hold_s, 0.0, 0.0, 0.0))


def _is_same(a: LatLon, b: LatLon) -> bool:
    return abs(a.lat_deg - b.lat_deg) < 1e-4 and geodesic_m(a, b) < _SAME_M


def _thinned(line: list[DrawnStop], notes: list[str]) -> list[DrawnStop]:
    if len(line) <= THINNED_ABOVE or any(stop.hold_s for stop in line):
        return line
    frame = LocalFrame(line[0].place)
    local = [frame.to_local(stop.place) for stop in line]
    kept = shapely.LineString(local).simplify(THINNED_M, preserve_topology=False)
    places = [frame.to_global(Point(*at)) for at in kept.coords]
    notes.append(f"{len(line)} points of a line thinned to {len(places)}, within {THINNED_M:g} m")
    return [DrawnStop(place) for place in places]


def _read_gpx(path: Path) -> Drawn:
    root = parse_xml(read_bytes(path), str(path))
    if root.tag != "gpx":
        raise PlanFileError(f"{path}: not GPX: its root is <{root.tag}>")
    is_own = root.get("creator") == CREATOR
    drawn = Drawn()
    for n, route in enumerate(root.iterfind("rte"), 1):
        drawn.routes.append(_gpx_stops(route.findall("rtept"), f"{path}: route {n}", is_own=is_own))
    for n, segment in enumerate(root.iterfind("trk/trkseg"), 1):
        drawn.lines.append(_gpx_stops(segment.findall("trkpt"), f"{path}: track segment {n}"))
    drawn.points = _gpx_stops(root.findall("wpt"), f"{path}: waypoints")
    return drawn


def _gpx_stops(elements: Sequence[Element], where: str, *, is_own: bool = False) -> list[DrawnStop]:
    stops = []
    for n, element in enumerate(elements, 1):
        values = (element.get("lon", ""), element.get("lat", ""))
        place = _place(values, f"{where}, point {n}", "the attributes lat and lon in degrees")
        stops.append(DrawnStop(place, is_home=is_own and n == 1 and text_of(element, "name") == _HOME))
    return stops


def _read_kml(path: Path) -> Drawn:
    data = read_bytes(path)
    root = parse_xml(data, str(path))
    if root.tag not in ("kml", "Document", "Folder", "Placemark"):
        raise PlanFileError(f"{path}: not KML: its root is <{root.tag}>")
    is_own = data.startswith(XML_HEADS[".kml"].encode())
    drawn = Drawn()
    for n, placemark in enumerate(root.iter("Placemark"), 1):
        where = f"{path}: placemark {n}"
        for shape in placemark.iter():
            if shape.tag == "LineString":
                drawn.lines.append(_kml_stops(text_of(shape, "coordinates").split(), ",", where))
            elif shape.tag == "Track":  # gx:Track, of a receiver
                told = [(element.text or "").strip() for element in shape.iterfind("coord")]
                drawn.lines.append(_kml_stops(told, None, where))
            elif shape.tag == "Point":
                drawn.points += _kml_stops(text_of(shape, "coordinates").split()[:1], ",", where)
                if is_own and text_of(placemark, "name") == _HOME and drawn.lines:
                    drawn.lines[0][:1] = [DrawnStop(drawn.points[-1].place, is_home=True)]
    return drawn


def _kml_stops(texts: Sequence[str], separator: str | None, where: str) -> list[DrawnStop]:
    return [
        DrawnStop(_place(text.split(separator)[:2], f"{where}, position {n}", "lon,lat"))
        for n, text in enumerate(texts, 1)
    ]


def _read_geojson(path: Path) -> Drawn:
    tree = read_json(path)
    if isinstance(tree, Mapping) and tree.get("type") in _SAILED:
        tree = {"type": "Feature", "properties": {}, "geometry": tree}
    is_own = isinstance(tree, Mapping) and tree.get("generator") == GENERATOR
    drawn = Drawn()
    for n, entry in enumerate(feature_entries(tree, str(path)), 1):
        where = f"{path}: feature {n}"
        geometry = entry.get("geometry") if isinstance(entry, Mapping) else None
        if not isinstance(geometry, Mapping):
            continue
        given = entry.get("properties")
        properties = given if is_own and isinstance(given, Mapping) else {}
        kind = properties.get("kind")
        if kind not in (None, "route", "waypoint"):  # of the fence and the rally points
            continue
        _take(drawn, geometry, where)
        if kind == "waypoint" and geometry.get("type") == "Point":
            drawn.routes = drawn.routes or [[]]
            drawn.routes[0].append(_own_stop(drawn.points.pop().place, properties))
    return drawn


def _take(drawn: Drawn, geometry: Mapping[str, Any], where: str) -> None:
    """Add a geometry's line or points; others are no route."""
    kind, coordinates = geometry.get("type"), geometry.get("coordinates")
    if kind not in _SAILED:
        return
    if not isinstance(coordinates, list):
        raise PlanFileError(f"{where}: expected coordinates, got {str(coordinates)[:60]}")
    if kind == "Point":
        drawn.points.append(DrawnStop(_geojson_place(coordinates, where)))
        return
    for line in coordinates if kind == "MultiLineString" else [coordinates]:
        if not isinstance(line, list):
            raise PlanFileError(f"{where}: expected positions, got {str(line)[:60]}")
        stops = [DrawnStop(_geojson_place(at, f"{where}, position {n}")) for n, at in enumerate(line, 1)]
        if kind == "MultiPoint":
            drawn.points += stops
        else:
            drawn.lines.append(stops)


def _own_stop(place: LatLon, properties: Mapping[str, Any]) -> DrawnStop:
    hold = properties.get("hold_s", 0.0)
    is_time = isinstance(hold, int | float) and not isinstance(hold, bool) and 0.0 < hold < 1e9
    return DrawnStop(place, float(hold) if is_time else 0.0, is_home=properties.get("number") == 0)


def _geojson_place(value: object, where: str) -> LatLon:
    lon_deg, lat_deg = position(value, where)
    return LatLon(lat_deg, wrapped_lon_deg(lon_deg))


def _place(texts: Sequence[str], where: str, expected: str) -> LatLon:
    try:
        values: list[object] = [float(text) for text in texts]
    except ValueError:
        raise PlanFileError(f"{where}: '{','.join(texts)[:40]}': expected {expected}") from None
    return _geojson_place(values, where)


_READERS: Final[dict[str, Callable[[Path], Drawn]]] = {
    ".gpx": _read_gpx,
    ".kml": _read_kml,
    ".geojson": _read_geojson,
    ".json": _read_geojson,
}
