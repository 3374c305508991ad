"""GPX 1.0 and 1.1 maps: shores walked with a receiver, or drawn as tracks or routes.

A track segment or route is a way to sail, unless its `type`, or `kind: island` in its description or comment,
says what it encloses, or whoever reads it knows that lines are outlines: then one that comes back to its
beginning and does not say more is water, and land within other water.
"""

from collections.abc import Iterator
from pathlib import Path
from xml.etree.ElementTree import Element

import shapely
from shapely.geometry import Polygon

from companion.core.geo import LatLon, LocalFrame, distance_m, path_length_m
from mission_tools.errors import MapError
from mission_tools.geojson import KINDS, position
from mission_tools.maps.formats.kml import KIND_IN_TEXT, parse_xml, text_of
from mission_tools.maps.geojson import Corners
from mission_tools.maps.projection import wrapped_lon_deg
from mission_tools.maps.raw import RawFeature, RawMap, read_bytes

MOST_GAP_SHARE = 0.1  # of an outline's length between its end and its beginning


def read_gpx(path: Path, lines_are_outlines: bool = False) -> RawMap:
    """Read a .gpx map. Raises MapError: one line that names the file, the track and the place."""
    return parse_gpx(read_bytes(path), str(path), path.stem, lines_are_outlines)


def parse_gpx(data: bytes, source: str, fallback_name: str = "", lines_are_outlines: bool = False) -> RawMap:
    """The outlines of a GPX text. Raises MapError: names the source, the track and what was expected."""
    root = parse_xml(data, source)
    if root.tag != "gpx":
        raise MapError(f"{source}: not GPX: its root is <{root.tag}>")
    notes: list[str] = []
    features: list[RawFeature] = []
    for label, element, points in _lines(root, source):
        name = text_of(element, "name")
        where = f'{label} "{name}"' if name else label
        corners = [_place(point, f"{where}, point {n}") for n, point in enumerate(points, 1)]
        properties = {"name": name} if name else {}
        kind = _kind(element)
        if kind:
            properties["kind"] = kind
        elif not lines_are_outlines:
            notes.append(f"{where}: a way, not an outline (--as-route sails it, --as-outline encloses water)")
            continue
        features += _outline(where, corners, properties, notes)
    count = sum(1 for _ in root.iterfind("wpt"))
    if count:
        notes.append(f"{source}: {count} waypoint{'s' if count > 1 else ''}, which enclose no water: skipped")
    title = text_of(root, "metadata/name")
    return RawMap(
        source, fallback_name, tuple(features), title, tuple(notes), edges="geodesic", nested="land"
    )


def _lines(root: Element, source: str) -> Iterator[tuple[str, Element, list[Element]]]:
    for n, track in enumerate(root.iterfind("trk"), 1):
        segments = track.findall("trkseg")
        for m, segment in enumerate(segments, 1):
            part = f", segment {m}" if len(segments) > 1 else ""
            yield f"{source}: track {n}{part}", track, segment.findall("trkpt")
    for n, route in enumerate(root.iterfind("rte"), 1):
        yield f"{source}: route {n}", route, route.findall("rtept")


def _outline(
    where: str, corners: Corners, properties: dict[str, str], notes: list[str]
) -> Iterator[RawFeature]:
    if len(corners) < 3:
        notes.append(f"{where}: {len(corners)} points enclose nothing: skipped")
        return
    gap_m, length_m = _gap_and_length_m(corners)
    if gap_m > MOST_GAP_SHARE * length_m:
        notes.append(f"{where}: ends {gap_m:.0f} m from its beginning, so it is no outline: skipped")
        if "kind" in properties:  # a pier may be a line
            yield RawFeature(where, properties, shapely.LineString(corners))
        return
    if gap_m > 0.0:
        notes.append(f"{where}: ends {gap_m:.1f} m from its beginning: closed")
    yield RawFeature(where, properties, Polygon(corners))


def _gap_and_length_m(corners: Corners) -> tuple[float, float]:
    lon_deg, lat_deg = corners[0]
    frame = LocalFrame(LatLon(lat_deg, wrapped_lon_deg(lon_deg)))
    points = [frame.to_local(LatLon(lat, wrapped_lon_deg(lon))) for lon, lat in corners]
    length_m = path_length_m(points)
    return distance_m(points[-1], points[0]), length_m


def _place(point: Element, where: str) -> tuple[float, float]:
    try:
        values: list[object] = [float(point.get(name, "")) for name in ("lon", "lat")]
    except ValueError:
        raise MapError(f"{where}: expected the attributes lat and lon in degrees") from None
    return position(values, where)


def _kind(element: Element) -> str:
    said = text_of(element, "type").lower().replace("-", "_").replace(" ", "_")
    if said in KINDS:
        return said
    in_text = KIND_IN_TEXT.search(" ".join(text_of(element, tag) for tag in ("desc", "cmt")))
    return in_text[1].lower() if in_text else ""
