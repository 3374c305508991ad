"""QGC WPL 110: the tab-separated mission text that Mission Planner, MAVProxy and QGroundControl read.

One row an item: index, current, frame, command, four parameters, x, y, z, autocontinue. Row 0 is home in
ArduPilot's files (frame 0); 0, 0 there means that home was not known. Lines with # are comments. Format: the
MAVLink guide, "File Formats". Every parse error is a ValueError that names the line.
"""

from collections.abc import Iterable

from companion.core.geo import LatLon
from companion.core.units import e7_to_deg
from mission_tools.mission.mission import (
    Command,
    Fence,
    FencePolygon,
    Frame,
    Mission,
    MissionItem,
    Rally,
    check_count,
    shifted_jump,
)

HEADER = "QGC WPL 110"


def parse(text: str) -> Mission:
    """Read a mission. Raises ValueError: names the line and what was expected there."""
    lines = [line.strip() for line in text.removeprefix("\ufeff").splitlines()]
    rows = [(number, line) for number, line in enumerate(lines, start=1) if line and not line.startswith("#")]
    if not rows or rows[0][1].split() != HEADER.split():
        raise ValueError(f"line {rows[0][0] if rows else 1}: the first line must be '{HEADER}'")
    check_count(len(rows) - 1)
    items = tuple(_row(number, line, index) for index, (number, line) in enumerate(rows[1:]))
    if items and items[0].frame == Frame.GLOBAL and items[0].command == Command.NAV_WAYPOINT:
        first = items[0]
        home = first.lat_lon if (first.x, first.y) != (0, 0) else None
        return Mission(items[1:], home, first.z)
    return Mission(tuple(shifted_jump(item, 1) for item in items))


def compose(mission: Mission) -> str:
    """A mission as text, home in row 0."""
    home = mission.home or LatLon(0.0, 0.0)
    home_item = MissionItem.at(home, frame=Frame.GLOBAL, z=mission.home_altitude_m)
    return text_of(
        line(
            index, int(item.frame), int(item.command), item.params, (item.x, item.y, item.z), item.is_global,
            item.autocontinue,
        )
        for index, item in enumerate((home_item, *mission.items))
    )  # fmt: skip


def text_of(lines: Iterable[str]) -> str:
    """The text of a file with these rows."""
    return "\n".join([HEADER, *lines]) + "\n"


def line(
    index: int,
    frame: int,
    command: int,
    params: tuple[float, float, float, float],
    place: tuple[int, int, float],
    is_global: bool,
    autocontinue: int,
) -> str:
    """The row of one item. place: x and y as on the wire, in 1e-7 degrees if they are global, and z."""
    x, y, z = place
    shown = (f"{e7_to_deg(x):.7f}", f"{e7_to_deg(y):.7f}") if is_global else (x, y)
    fields = (index, int(index == 0), frame, command, *params, *shown, z, int(autocontinue))
    return "\t".join(map(str, fields))


def _row(number: int, line: str, index: int) -> MissionItem:
    fields = line.split()
    if len(fields) != 12:
        raise ValueError(f"line {number}: an item has 12 fields, got {len(fields)}")
    try:
        found, _, frame, command = (_whole(field) for field in fields[:4])
        values = [float(field) for field in fields[4:11]]
        autocontinue = _whole(fields[11])
    except ValueError as error:
        raise ValueError(f"line {number} (item {index}): {error}") from None
    if found != index:
        raise ValueError(f"line {number}: expected item {index}, got item {found}")
    try:
        return MissionItem.from_numbers(command, frame, values, autocontinue=autocontinue != 0)
    except ValueError as error:
        raise ValueError(f"line {number} (item {index}): {error}") from None


def _whole(field: str) -> int:
    value = float(field)
    if not value.is_integer():
        raise ValueError(f"'{field}' must be a whole number")
    return int(value)


_RALLY = "rally"
_FEWEST_CORNERS = 3


def parse_lists(text: str) -> tuple[Fence, tuple[Rally, ...]] | None:
    """Fence and rally points of a text; None if no such list. Raises ValueError: names line and fault."""
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
