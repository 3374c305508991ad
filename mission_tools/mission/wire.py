"""A mission from the lists that a vehicle holds: the inverse of `Mission.wire_lists`."""

import math
import struct
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from mission_tools.mission.mission import (
    CIRCLES,
    VERTICES,
    Command,
    Fence,
    FenceCircle,
    FencePolygon,
    Mission,
    MissionItem,
    MissionType,
    Rally,
    command_name,
    plain_frame,
)

_VERTICES = {command: is_inclusion for is_inclusion, command in VERTICES.items()}
_CIRCLES = {command: is_inclusion for is_inclusion, command in CIRCLES.items()}
FENCE_COMMANDS = frozenset({*_VERTICES, *_CIRCLES, Command.NAV_FENCE_RETURN_POINT})


def mission_from(lists: Mapping[MissionType, Sequence[MissionItem]], *, home_first: bool) -> Mission:
    """The mission, fence and rally points of a vehicle. home_first: item 0 is home, as ArduPilot keeps it.
    Raises ValueError: a fence that is none; names the item.
    """
    items = tuple(lists.get(MissionType.MISSION, ()))
    home, altitude_m = None, 0.0
    if home_first and items:
        first, *rest = items
        items = tuple(rest)
        if (first.x, first.y) != (0, 0):  # what a vehicle without a home has there
            home, altitude_m = first.lat_lon, first.z
    return Mission(
        items,
        home,
        altitude_m,
        fence_from(lists.get(MissionType.FENCE, ())),
        tuple(Rally(item.lat_lon, item.z) for item in lists.get(MissionType.RALLY, ())),
    )


def fence_from(items: Sequence[MissionItem]) -> Fence:
    """The fence of a list of items; every vertex carries its polygon's number of vertices. Raises ValueError:
    names the item and what was expected there.
    """
    polygons: list[FencePolygon] = []
    circles: list[FenceCircle] = []
    return_point: MissionItem | None = None
    number = 0
    while number < len(items):
        item = items[number]
        where = f"fence, item {number}"
        if item.command in _VERTICES:
            count = int(item.params[0])
            group = items[number : number + count]
            if count < 3 or len(group) < count or {part.command for part in group} != {item.command}:
                raise ValueError(f"{where}: begins a polygon of {count} vertices that do not follow")
            corners = tuple(part.lat_lon for part in group)
            polygons.append(FencePolygon(corners, _VERTICES[Command(item.command)]))
            number += count
            continue
        if item.command in _CIRCLES:
            circles.append(FenceCircle(item.lat_lon, item.params[0], _CIRCLES[Command(item.command)]))
        elif item.command == Command.NAV_FENCE_RETURN_POINT:
            return_point = item
        else:
            raise ValueError(f"{where}: MAV_CMD {item.command} is none of a fence")
        number += 1
    back, altitude_m = (None, 0.0) if return_point is None else (return_point.lat_lon, return_point.z)
    return Fence(tuple(polygons), tuple(circles), back, altitude_m)


@dataclass(frozen=True, slots=True)
class Difference:
    """A field of an item that did not come back as it went. `item` is the sequence number, home being 0."""

    item: int
    field: str
    sent: object
    held: object

    def __str__(self) -> str:
        return f"item {self.item}: {self.field} sent {self.sent}, held {self.held}"


def differences(
    sent: Sequence[MissionItem], held: Sequence[MissionItem], *, home_is_the_vehicles: bool
) -> list[Difference]:
    """Every difference between two wire lists.

    Whole numbers must be equal; floating-point ones may differ by one unit in the last place of the wire's
    float32, and NaN equals NaN. home_is_the_vehicles: item 0 is the vehicle's own business, as on ArduPilot.
    """
    found = []
    if len(sent) != len(held):
        found.append(Difference(min(len(sent), len(held)), "number of items", len(sent), len(held)))
    for number, (ours, theirs) in enumerate(zip(sent, held, strict=False)):
        if number > 0 or not home_is_the_vehicles:
            found += _item_differences(number, ours, theirs)
    return found


def _item_differences(number: int, sent: MissionItem, held: MissionItem) -> Iterator[Difference]:
    if sent.command != held.command:
        yield Difference(number, "command", command_name(sent.command), command_name(held.command))
    if plain_frame(sent.frame) != plain_frame(held.frame):
        yield Difference(number, "frame", int(sent.frame), int(held.frame))
    for field in ("x", "y", "autocontinue"):
        if getattr(sent, field) != getattr(held, field):
            yield Difference(number, field, getattr(sent, field), getattr(held, field))
    pairs = [*zip(sent.params, held.params, strict=True), (sent.z, held.z)]
    for field, (ours, theirs) in zip(("param1", "param2", "param3", "param4", "z"), pairs, strict=True):
        if not same_float32(ours, theirs):
            yield Difference(number, field, ours, theirs)


def same_float32(a: float, b: float) -> bool:
    """Whether two numbers are at most one unit in the last place apart once both are float32."""
    if math.isnan(a) or math.isnan(b):
        return math.isnan(a) and math.isnan(b)
    return abs(_ordered_bits(a) - _ordered_bits(b)) <= 1


def _ordered_bits(value: float) -> int:
    """A float32's bits as an integer that counts up with the value; both zeros are 0."""
    try:
        bits: int = struct.unpack("<i", struct.pack("<f", value))[0]
    except OverflowError:  # beyond float32: its infinity
        bits = 0x7F800000 if value > 0 else 0x7F800000 - 2**31
    return bits if bits >= 0 else -(bits + 2**31)
