"""A mission as GeoJSON (RFC 7946): its line, its waypoints, its fence and its rally points.

`kind` is route, waypoint, or what `--fence` and `--rally` read back from such a file.
"""

import json
from typing import Any

from companion.core.geo import LatLon
from mission_tools.files.geometry import length_m, pieces_at_antimeridian, waypoints
from mission_tools.geojson import collection, feature
from mission_tools.mission.mission import Fence, Mission
from mission_tools.overwrite_guard import GENERATOR


def compose(mission: Mission, title: str) -> str:
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
        found.append(feature("Polygon", [ring], kind="inclusion" if polygon.inclusion else "exclusion"))
    for circle in fence.circles:
        kind = "inclusion" if circle.inclusion else "exclusion"
        found.append(feature("Point", _place(circle.centre), kind=kind, radius_m=circle.radius_m))
    if fence.return_point is not None:
        found.append(feature("Point", _place(fence.return_point), kind="return_point"))
    return found


def _place(place: LatLon) -> list[float]:
    return _position(place.lon_deg, place.lat_deg)


def _position(lon_deg: float, lat_deg: float) -> list[float]:
    """Rounded to 1e-7 degrees, about 1 cm, as a mission carries it."""
    return [round(lon_deg, 7), round(lat_deg, 7)]
