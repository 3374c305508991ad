"""A mission as GPX 1.1: a route for chart plotters, its fence as tracks, rally points as waypoints."""

from companion.core.geo import LatLon
from mission_tools.files.geometry import fence_areas, waypoints
from mission_tools.files.xml_escape import escaped
from mission_tools.mission.mission import Mission
from mission_tools.overwrite_guard import XML_HEADS
from mission_tools.wording import duration


def compose(mission: Mission, title: str) -> str:
    """The mission as a GPX file. The order of the elements is the schema's."""
    parts = [
        f'{XML_HEADS[".gpx"]}xmlns="http://www.topografix.com/GPX/1/1">\n'
        f"<metadata><name>{escaped(title)}</name></metadata>\n"
    ]
    for number, rally in enumerate(mission.rally, 1):
        parts.append(f"<wpt {_at(rally.place)}><name>Rally point {number}</name></wpt>\n")
    points = waypoints(mission)
    if points:
        parts.append(f"<rte><name>{escaped(title)}</name>\n")
        for point in points:
            said = f"<desc>hold {duration(point.hold_s)}</desc>" if point.hold_s else ""
            parts.append(f"<rtept {_at(point.place)}><name>{point.name}</name>{said}</rtept>\n")
        parts.append("</rte>\n")
    for area in fence_areas(mission.fence):
        kind = "inclusion" if area.is_inclusion else "exclusion"
        parts.append(f"<trk><name>{area.name}</name><type>{kind}</type><trkseg>\n")
        parts += [f"<trkpt {_at(corner)}/>\n" for corner in (*area.corners, area.corners[0])]
        parts.append("</trkseg></trk>\n")
    return "".join(parts) + "</gpx>\n"


def _at(place: LatLon) -> str:
    return f'lat="{place.lat_deg:.7f}" lon="{place.lon_deg:.7f}"'
