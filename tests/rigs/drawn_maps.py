"""GeoJSON maps for tests: corners in metres, east and north, of one place."""

from collections.abc import Sequence
from typing import Any

from companion.core.geo import LatLon, LocalFrame, Point
from mission_tools import geojson
from mission_tools.maps.chart import Chart
from mission_tools.maps.geojson import parse_geojson

Json = dict[str, Any]
Corners = Sequence[tuple[float, float]]

ORIGIN = LatLon(50.0, -1.2)
FRAME = LocalFrame(ORIGIN)


def positions(corners: Corners) -> list[list[float]]:
    """Longitude and latitude of each."""
    places = [FRAME.to_global(Point(north, east)) for east, north in corners]
    return [[place.lon_deg, place.lat_deg] for place in places]


def ring(corners: Corners) -> list[list[float]]:
    """A closed one."""
    return positions([*corners, corners[0]])


def box(west: float, south: float, east: float, north: float) -> list[list[float]]:
    """A rectangle's ring."""
    return ring([(west, south), (east, south), (east, north), (west, north)])


def feature(coordinates: Sequence[Any], geometry: str = "Polygon", **properties: object) -> Json:
    """A polygon unless said otherwise."""
    return geojson.feature(geometry, coordinates, **properties)


def collection(*features: Json, **members: object) -> Json:
    """A whole map."""
    return geojson.collection(list(features), **members)


def chart_of(*features: Json) -> Chart:
    """The chart of these features, round ORIGIN; it is called “f” in messages."""
    return parse_geojson(collection(*features), "f", "f", ORIGIN)


def is_inside(corners: Corners, east: float, north: float) -> bool:
    """The even-odd rule, by counting crossings."""
    crossings = 0
    for (e1, n1), (e2, n2) in zip(corners, [*corners[1:], corners[0]], strict=True):
        if (n1 > north) != (n2 > north):
            crossings += east < e1 + (north - n1) / (n2 - n1) * (e2 - e1)
    return crossings % 2 == 1
