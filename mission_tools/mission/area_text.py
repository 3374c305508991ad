"""Fence and rally lists of ArduPilot's stations as text, from before they were lists of mission items.

A fence has a line "latitude longitude" for each point: the return point, then the corners, the first of them
again at the end. A rally point is a line "RALLY latitude longitude altitude …". Format: `mavwp.py` of
pymavlink.
"""

from companion.core.geo import LatLon
from mission_tools.mission.mission import Fence, FencePolygon, Rally

_RALLY = "rally"
_FEWEST_CORNERS = 3


def parse_lists(text: str) -> tuple[Fence, tuple[Rally, ...]] | None:
    """The fence and rally points of a text; None if it is no such list.

    Raises:
        ValueError: names the line and what was expected there.
    """
    lines = [(number, line.split()) for number, line in enumerate(text.splitlines(), 1)]
    rows = [(number, row) for number, row in lines if row and not row[0].startswith("#")]
    if not rows or not _is_list(rows[0][1]):
        return None
    rally: list[Rally] = []
    places: list[LatLon] = []
    for number, row in rows:
        is_rally = row[0].lower() == _RALLY
        try:
            lat_deg, lon_deg, *rest = map(float, row[1:] if is_rally else row)
            place = LatLon(lat_deg, lon_deg)
        except ValueError as error:
            raise ValueError(f"line {number}: expected latitude and longitude: {error}") from None
        if is_rally:
            rally.append(Rally(place, rest[0] if rest else 0.0))
        else:
            places.append(place)
    if not places:
        return Fence(), tuple(rally)
    back, *corners = places
    if corners and corners[0] == corners[-1]:
        corners.pop()
    if len(corners) < _FEWEST_CORNERS:
        raise ValueError(f"{len(places)} lines: expected a return point and the corners of a polygon")
    return Fence((FencePolygon(tuple(corners)),), return_point=back), tuple(rally)


def _is_list(row: list[str]) -> bool:
    if row[0].lower() == _RALLY:
        return True
    try:
        return len([float(field) for field in row]) == 2
    except ValueError:
        return False
