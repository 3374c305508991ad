"""A mission as GeoJSON (RFC 7946), KML 2.2 (OGC 07-147r2) or GPX 1.1, by the suffix of a file.

Formats that know no missions get its places and areas as plain coordinates: in GeoJSON `kind` is route,
waypoint, or what `--fence` and `--rally` read back; in GPX the way is a route for chart plotters, the fence
tracks, rally points waypoints.
"""

import json
import math
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from html import escape
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

from companion.cli.output_file import write_text
from companion.core.errors import OutputError
from companion.core.geo import LatLon, LocalFrame, Point, geodesic_m, longitude_difference_deg
from mission_tools.errors import PlanFileError
from mission_tools.geojson import collection, feature
from mission_tools.mission.mission import Fence, FenceCircle, Mission
from mission_tools.mission.plan_file import MISSION_SUFFIXES, save_mission
from mission_tools.overwrite_guard import GENERATOR, XML_HEADS
from mission_tools.wording import distance, duration

CIRCLE_CORNERS = 64


class Waypoint(NamedTuple):
    """A place of a mission. number: 0 is home, where the route begins."""

    number: int
    place: LatLon
    hold_s: float

    @property
    def name(self) -> str:
        """The name that files give it, such as “Home” or “Waypoint 1”."""
        return f"Waypoint {self.number}" if self.number else "Home"


class FenceArea(NamedTuple):
    """A fence area by its corners, a circle as well. No corner twice."""

    name: str
    is_inclusion: bool
    corners: tuple[LatLon, ...]


def waypoints(mission: Mission) -> list[Waypoint]:
    """Home, if it is known, and the places in their order."""
    found = [] if mission.home is None else [Waypoint(0, mission.home, 0.0)]
    places = [item for item in mission.items if item.place is not None]
    found += [Waypoint(n, item.place, item.hold_s) for n, item in enumerate(places, 1) if item.place]
    return found


def length_m(places: Sequence[LatLon]) -> float:
    """The length of a line of places, leg by leg."""
    return sum(geodesic_m(start, end) for start, end in pairwise(places))


def fence_areas(fence: Fence) -> Iterator[FenceArea]:
    """All areas; a circle is drawn by corners that are never on the wrong side of it."""
    for n, polygon in enumerate(fence.polygons, 1):
        yield FenceArea(_name(n, polygon.inclusion), polygon.inclusion, polygon.corners)
    for n, circle in enumerate(fence.circles, len(fence.polygons) + 1):
        yield FenceArea(_name(n, circle.inclusion), circle.inclusion, _corners(circle))


def _name(number: int, is_inclusion: bool) -> str:
    return f"Fence {number}: stay {'inside' if is_inclusion else 'outside'}"


def _corners(circle: FenceCircle) -> tuple[LatLon, ...]:
    frame = LocalFrame(circle.centre)
    radius_m = circle.radius_m / (1.0 if circle.inclusion else math.cos(math.pi / CIRCLE_CORNERS))
    angles = (2.0 * math.pi * n / CIRCLE_CORNERS for n in range(CIRCLE_CORNERS))
    return tuple(frame.to_global(Point(0.0, 0.0).moved(angle, radius_m)) for angle in angles)


def pieces_at_antimeridian(places: Sequence[LatLon]) -> list[list[tuple[float, float]]]:
    """A line as (longitude, latitude), cut where it crosses ±180° (RFC 7946, 3.1.9)."""
    pieces = [[(places[0].lon_deg, places[0].lat_deg)]] if places else []
    for start, end in pairwise(places):
        east_deg = longitude_difference_deg(end.lon_deg, start.lon_deg)
        side = math.copysign(180.0, east_deg)
        if abs(start.lon_deg + east_deg) > 180.0:
            share = (side - start.lon_deg) / east_deg
            lat_deg = start.lat_deg + share * (end.lat_deg - start.lat_deg)
            pieces[-1].append((side, lat_deg))
            pieces.append([(-side, lat_deg)])
        pieces[-1].append((end.lon_deg, end.lat_deg))
    return pieces


_NOT_IN_XML = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")  # XML 1.0, 2.2


def escaped(text: str) -> str:
    """Text as it may stand in an element or a quoted attribute; characters that XML forbids are left out."""
    return escape(_NOT_IN_XML.sub("", text))


def geojson_of(mission: Mission, title: str) -> str:
    """The mission as a FeatureCollection."""
    points = waypoints(mission)
    places = [point.place for point in points]
    features = []
    if len(places) > 1:
        pieces = [[_position(*at) for at in piece] for piece in pieces_at_antimeridian(places)]
        shape = ("LineString", pieces[0]) if len(pieces) == 1 else ("MultiLineString", pieces)
        features.append(feature(*shape, kind="route", name=title, length_m=round(length_m(places), 2)))
    for point in points:
        said = {"hold_s": point.hold_s} if point.hold_s else {}
        features.append(
            feature(
                "Point", _place(point.place), kind="waypoint", name=point.name, number=point.number, **said
            )
        )
    features += _fence(mission.fence)
    features += [feature("Point", _place(rally.place), kind="rally") for rally in mission.rally]
    tree = collection(features, generator=GENERATOR, name=title)
    return json.dumps(tree, ensure_ascii=False, indent=1) + "\n"


def _fence(fence: Fence) -> list[dict[str, Any]]:
    found = []
    for polygon in fence.polygons:
        ring = [_place(corner) for corner in (*polygon.corners, polygon.corners[0])]
        found.append(feature("Polygon", [ring], kind=_kind(polygon.inclusion)))
    for circle in fence.circles:
        kind = _kind(circle.inclusion)
        found.append(feature("Point", _place(circle.centre), kind=kind, radius_m=circle.radius_m))
    if fence.return_point is not None:
        found.append(feature("Point", _place(fence.return_point), kind="return_point"))
    return found


def _kind(is_inclusion: bool) -> str:
    return "inclusion" if is_inclusion else "exclusion"


def _place(place: LatLon) -> list[float]:
    return _position(place.lon_deg, place.lat_deg)


def _position(lon_deg: float, lat_deg: float) -> list[float]:
    """Rounded to 1e-7 degrees, about 1 cm, as a mission carries it."""
    return [round(lon_deg, 7), round(lat_deg, 7)]


def gpx_of(mission: Mission, title: str) -> str:
    """The mission as a GPX file. The order of the elements is the schema's."""
    parts = [
        f'{XML_HEADS[".gpx"]}xmlns="http://www.topografix.com/GPX/1/1">\n'
        f"<metadata><name>{escaped(title)}</name></metadata>\n"
    ]
    for number, rally in enumerate(mission.rally, 1):
        parts.append(f"<wpt {_gpx_at(rally.place)}><name>Rally point {number}</name></wpt>\n")
    points = waypoints(mission)
    if points:
        parts.append(f"<rte><name>{escaped(title)}</name>\n")
        for point in points:
            said = f"<desc>hold {duration(point.hold_s)}</desc>" if point.hold_s else ""
            parts.append(f"<rtept {_gpx_at(point.place)}><name>{point.name}</name>{said}</rtept>\n")
        parts.append("</rte>\n")
    for area in fence_areas(mission.fence):
        parts.append(f"<trk><name>{area.name}</name><type>{_kind(area.is_inclusion)}</type><trkseg>\n")
        parts += [f"<trkpt {_gpx_at(corner)}/>\n" for corner in (*area.corners, area.corners[0])]
        parts.append("</trkseg></trk>\n")
    return "".join(parts) + "</gpx>\n"


def _gpx_at(place: LatLon) -> str:
    return f'lat="{place.lat_deg:.7f}" lon="{place.lon_deg:.7f}"'


_STYLES = """\
<Style id="route"><LineStyle><color>ff2e3acf</color><width>4</width></LineStyle></Style>
<Style id="inside"><LineStyle><color>ff4f9d3a</color><width>2</width></LineStyle>
<PolyStyle><fill>0</fill></PolyStyle></Style>
<Style id="outside"><LineStyle><color>ff3b41c2</color><width>2</width></LineStyle>
<PolyStyle><color>403b41c2</color></PolyStyle></Style>
"""


def kml_of(mission: Mission, title: str) -> str:
    """The mission as a document: its line, its waypoints, its fence and its rally points."""
    points = waypoints(mission)
    places = [point.place for point in points]
    parts = [
        f"{XML_HEADS['.kml']}"
        f'<kml xmlns="http://www.opengis.net/kml/2.2">\n<Document>\n<name>{escaped(title)}</name>\n{_STYLES}'
    ]
    if len(places) > 1:
        said = f"{distance(length_m(places))}, {len(mission.places)} waypoints"
        line = f"<LineString><tessellate>1</tessellate>{_kml_coordinates(places)}</LineString>"
        parts.append(_placemark(title, line, said, "route"))
    parts.append(_folder("Waypoints", (_kml_waypoint(point) for point in points)))
    fence = [
        _placemark(
            area.name,
            "<Polygon><tessellate>1</tessellate><outerBoundaryIs><LinearRing>"
            f"{_kml_coordinates((*area.corners, area.corners[0]))}</LinearRing></outerBoundaryIs></Polygon>",
            style="inside" if area.is_inclusion else "outside",
        )
        for area in fence_areas(mission.fence)
    ]
    parts.append(_folder("Fence", fence))
    rally = (_placemark(f"Rally point {n}", _kml_point(r.place)) for n, r in enumerate(mission.rally, 1))
    parts.append(_folder("Rally points", rally))
    return "".join(parts) + "</Document>\n</kml>\n"


def _kml_waypoint(point: Waypoint) -> str:
    said = f"hold {duration(point.hold_s)}" if point.hold_s else ""
    return _placemark(point.name, _kml_point(point.place), said)


def _folder(name: str, placemarks: Iterable[str]) -> str:
    inner = "".join(placemarks)
    return f"<Folder>\n<name>{name}</name>\n{inner}</Folder>\n" if inner else ""


def _placemark(name: str, shape: str, description: str = "", style: str = "") -> str:
    said = f"<description>{escaped(description)}</description>" if description else ""
    look = f"<styleUrl>#{style}</styleUrl>" if style else ""
    return f"<Placemark><name>{escaped(name)}</name>{said}{look}{shape}</Placemark>\n"


def _kml_point(place: LatLon) -> str:
    return f"<Point>{_kml_coordinates([place])}</Point>"


def _kml_coordinates(places: Iterable[LatLon]) -> str:
    inner = " ".join(f"{place.lon_deg:.7f},{place.lat_deg:.7f},0" for place in places)
    return f"<coordinates>{inner}</coordinates>"


_COMPOSERS: dict[str, Callable[[Mission, str], str]] = {
    ".geojson": geojson_of,
    ".kml": kml_of,
    ".gpx": gpx_of,
}
ROUTE_SUFFIXES = frozenset(_COMPOSERS) | MISSION_SUFFIXES


def check_route_name(path: Path) -> None:
    """See whether a mission can have this name. Raises PlanFileError: a suffix that is not written here."""
    suffix = path.suffix.lower()
    if suffix not in ROUTE_SUFFIXES:
        raise PlanFileError(
            f"{path}: missions are written as .plan (QGroundControl), as .waypoints, .wpl, .txt (QGC WPL "
            "110), or as .geojson, .kml, .gpx, and drawn as .html, .png, .svg, .pdf: expected a name that "
            "ends in one of these"
        )


def save_route(mission: Mission, path: Path, title: str = "") -> None:
    """Write a mission. title: what the file calls itself; else the file's name. Raises PlanFileError: the
    name cannot be used, the file cannot be written, or the format cannot hold the mission.
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
