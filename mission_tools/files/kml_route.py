"""A mission as KML 2.2 (OGC 07-147r2), for Google Earth and marine programs."""

from collections.abc import Iterable

from companion.core.geo import LatLon
from mission_tools.files.geometry import Waypoint, fence_areas, length_m, waypoints
from mission_tools.files.xml_escape import escaped
from mission_tools.mission.mission import Mission
from mission_tools.overwrite_guard import XML_HEADS
from mission_tools.wording import distance, duration

_STYLES = """\
<Style id="route"><LineStyle><color>ff2e3acf</color><width>4</width></LineStyle></Style>
<Style id="inside"><LineStyle><color>ff4f9d3a</color><width>2</width></LineStyle>
<PolyStyle><fill>0</fill></PolyStyle></Style>
<Style id="outside"><LineStyle><color>ff3b41c2</color><width>2</width></LineStyle>
<PolyStyle><color>403b41c2</color></PolyStyle></Style>
"""


def compose(mission: Mission, title: str) -> str:
    """The mission as a document: its line, its waypoints, its fence and its rally points."""
    points = waypoints(mission)
    places = [point.place for point in points]
    parts = [
        f"{XML_HEADS['.kml']}"
        f'<kml xmlns="http://www.opengis.net/kml/2.2">\n<Document>\n<name>{escaped(title)}</name>\n{_STYLES}'
    ]
    if len(places) > 1:
        said = f"{distance(length_m(places))}, {len(mission.places)} waypoints"
        line = f"<LineString><tessellate>1</tessellate>{_coordinates(places)}</LineString>"
        parts.append(_placemark(title, line, said, "route"))
    parts.append(_folder("Waypoints", (_waypoint(point) for point in points)))
    fence = [
        _placemark(
            area.name,
            "<Polygon><tessellate>1</tessellate><outerBoundaryIs><LinearRing>"
            f"{_coordinates((*area.corners, area.corners[0]))}</LinearRing></outerBoundaryIs></Polygon>",
            style="inside" if area.is_inclusion else "outside",
        )
        for area in fence_areas(mission.fence)
    ]
    parts.append(_folder("Fence", fence))
    rally = (_placemark(f"Rally point {n}", _point(r.place)) for n, r in enumerate(mission.rally, 1))
    parts.append(_folder("Rally points", rally))
    return "".join(parts) + "</Document>\n</kml>\n"


def _waypoint(point: Waypoint) -> str:
    said = f"hold {duration(point.hold_s)}" if point.hold_s else ""
    return _placemark(point.name, _point(point.place), said)


def _folder(name: str, placemarks: Iterable[str]) -> str:
    inner = "".join(placemarks)
    return f"<Folder>\n<name>{name}</name>\n{inner}</Folder>\n" if inner else ""


def _placemark(name: str, shape: str, description: str = "", style: str = "") -> str:
    said = f"<description>{escaped(description)}</description>" if description else ""
    look = f"<styleUrl>#{style}</styleUrl>" if style else ""
    return f"<Placemark><name>{escaped(name)}</name>{said}{look}{shape}</Placemark>\n"


def _point(place: LatLon) -> str:
    return f"<Point>{_coordinates([place])}</Point>"


def _coordinates(places: Iterable[LatLon]) -> str:
    inner = " ".join(f"{place.lon_deg:.7f},{place.lat_deg:.7f},0" for place in places)
    return f"<coordinates>{inner}</coordinates>"
