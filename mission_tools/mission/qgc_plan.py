"""QGroundControl's `.plan`: JSON with mission, fence and rally points.

Format: the QGroundControl developer guide, "Plan File Format". Of the complex items, surveys and corridors
are expanded into the simple items that they carry; others are refused. Every parse error is a ValueError
that names the item.
"""

import json
import math
from collections.abc import Callable
from typing import Annotated, Any, Literal, TypeVar

import msgspec
from msgspec import Meta

from companion.core.geo import LatLon
from companion.core.units import e7_to_deg
from mission_tools.mission.mission import (
    LARGEST,
    Command,
    Fence,
    FenceCircle,
    FencePolygon,
    Mission,
    MissionItem,
    Rally,
    check_count,
)
from mission_tools.overwrite_guard import CREATOR

MAV_AUTOPILOT_ARDUPILOTMEGA = 3
MAV_TYPE_SURFACE_BOAT = 11
DEFAULT_SPEED_M_S = 2.0
_PARAMETERS = 7

Number = Annotated[float, Meta(ge=-LARGEST, le=LARGEST)]
Coordinates = Annotated[list[Number], Meta(min_length=2, max_length=3)]  # degrees, degrees, perhaps metres
Parameters = Annotated[
    list[Number | None], Meta(max_length=_PARAMETERS)
]  # QGroundControl leaves out the last
T = TypeVar("T")


class _Simple(msgspec.Struct, frozen=True, tag_field="type", tag="SimpleItem", rename="camel"):
    command: int
    frame: int
    params: Parameters
    auto_continue: bool = True
    do_jump_id: int | None = None


class _Transect(msgspec.Struct, frozen=True):
    Items: list[Any]


class _Complex(msgspec.Struct, frozen=True, tag_field="type", tag="ComplexItem"):
    complexItemType: str = "without a type"  # noqa: N815 - the file's own name
    TransectStyleComplexItem: _Transect | None = None


class _Mission(msgspec.Struct, frozen=True, rename="camel"):
    version: Literal[2]
    items: list[Any]
    planned_home_position: Coordinates | None = None
    cruise_speed: Number | None = None


class _Polygon(msgspec.Struct, frozen=True):
    polygon: list[Coordinates]
    inclusion: bool = True


class _Disc(msgspec.Struct, frozen=True):
    center: Coordinates
    radius: float


class _FenceCircle(msgspec.Struct, frozen=True):
    circle: _Disc
    inclusion: bool = True


class _Fence(msgspec.Struct, frozen=True, rename="camel"):
    polygons: tuple[_Polygon, ...] = ()
    circles: tuple[_FenceCircle, ...] = ()
    breach_return: Coordinates | None = None


class _Rally(msgspec.Struct, frozen=True):
    points: tuple[Coordinates, ...] = ()


class _Plan(msgspec.Struct, frozen=True, rename="camel"):
    file_type: Literal["Plan"]
    mission: _Mission
    geo_fence: _Fence = _Fence()
    rally_points: _Rally = _Rally()


def parse(text: str) -> Mission:
    """Read a `.plan`. Raises ValueError: not such a file, or names the item and what was expected there."""
    try:
        plan = msgspec.json.decode(text.removeprefix("\ufeff"), type=_Plan)
    except msgspec.ValidationError as error:
        raise ValueError(f"not a QGroundControl plan: {error}") from None
    except (msgspec.DecodeError, RecursionError) as error:
        raise ValueError(f"neither QGC WPL 110 nor JSON: {error}") from None
    home = plan.mission.planned_home_position
    rally = enumerate(plan.rally_points.points, start=1)
    return Mission(
        items=_items(plan.mission.items),
        home=_named("planned home", _place, home) if home else None,
        home_altitude_m=_altitude_m(home),
        fence=_fence(plan.geo_fence),
        rally=tuple(Rally(_named(f"rally point {n}", _place, at), _altitude_m(at)) for n, at in rally),
        speed_m_s=plan.mission.cruise_speed,
    )


def compose(mission: Mission) -> str:
    """A mission as a `.plan` for ArduPilot Rover as a boat."""
    home = mission.home or next(iter(mission.places), LatLon(0.0, 0.0))
    speed_m_s = DEFAULT_SPEED_M_S if mission.speed_m_s is None else mission.speed_m_s
    tree = {
        "fileType": "Plan",
        "version": 1,
        "groundStation": CREATOR,
        "mission": {
            "version": 2,
            "firmwareType": MAV_AUTOPILOT_ARDUPILOTMEGA,
            "vehicleType": MAV_TYPE_SURFACE_BOAT,
            "cruiseSpeed": speed_m_s,
            "hoverSpeed": speed_m_s,
            "plannedHomePosition": [home.lat_deg, home.lon_deg, mission.home_altitude_m],
            "items": [_simple_tree(item, number) for number, item in enumerate(mission.items, start=1)],
        },
        "geoFence": _fence_tree(mission.fence),
        "rallyPoints": {"version": 2, "points": [[*_pair(r.place), r.altitude_m] for r in mission.rally]},
    }
    return json.dumps(tree, indent=4, allow_nan=False) + "\n"


def _items(trees: list[Any]) -> tuple[MissionItem, ...]:
    check_count(len(trees))
    simple: list[tuple[str, _Simple]] = []
    for number, tree in enumerate(trees, start=1):
        simple += _named(f"item {number}", lambda tree=tree, number=number: _expand(f"item {number}", tree))
    check_count(len(simple))
    # DO_JUMP names its target by doJumpId in the file and by sequence number on the wire.
    sequence_of = {item.do_jump_id: number for number, (_, item) in enumerate(simple, start=1)}
    return tuple(_named(label, _item, item, sequence_of) for label, item in simple)


def _expand(label: str, tree: object) -> list[tuple[str, _Simple]]:
    """One item of the file as the simple items that it stands for."""
    item = msgspec.convert(tree, _Simple | _Complex)
    if isinstance(item, _Simple):
        return [(label, item)]
    if item.TransectStyleComplexItem is None:
        raise ValueError(f"a boat cannot sail the complex item '{item.complexItemType}': use plain waypoints")
    parts = [msgspec.convert(part, _Simple) for part in item.TransectStyleComplexItem.Items]
    return [(f"{label}, part {number}", part) for number, part in enumerate(parts, start=1)]


def _item(item: _Simple, sequence_of: dict[int | None, int]) -> MissionItem:
    values = [math.nan if value is None else value for value in item.params]
    values += [math.nan] * (_PARAMETERS - len(values))
    if item.command == Command.DO_JUMP:
        if values[0] not in sequence_of:
            raise ValueError(f"DO_JUMP to item id {item.params[0]}, which no item has")
        values[0] = float(sequence_of[int(values[0])])
    return MissionItem.from_numbers(item.command, item.frame, values, autocontinue=item.auto_continue)


def _fence(fence: _Fence) -> Fence:
    back = fence.breach_return
    return Fence(
        polygons=tuple(
            _named(f"fence polygon {n}", lambda p=p: FencePolygon(tuple(map(_place, p.polygon)), p.inclusion))
            for n, p in enumerate(fence.polygons, start=1)
        ),
        circles=tuple(
            _named(
                f"fence circle {n}",
                lambda c=c: FenceCircle(_place(c.circle.center), c.circle.radius, c.inclusion),
            )
            for n, c in enumerate(fence.circles, start=1)
        ),
        return_point=_named("fence return point", _place, back) if back else None,
        return_altitude_m=_altitude_m(back),
    )


def _named(label: str, build: Callable[..., T], *arguments: object) -> T:
    """Build a value of the file; its error says where."""
    try:
        return build(*arguments)
    except ValueError as error:  # msgspec's ValidationError is one too
        raise ValueError(f"{label}: {error}") from None


def _place(coordinates: list[float]) -> LatLon:
    return LatLon(coordinates[0], coordinates[1])


def _altitude_m(coordinates: list[float] | None) -> float:
    return coordinates[2] if coordinates is not None and len(coordinates) == 3 else 0.0


def _pair(place: LatLon) -> list[float]:
    return [place.lat_deg, place.lon_deg]


def _simple_tree(item: MissionItem, number: int) -> dict[str, Any]:
    place = (e7_to_deg(item.x), e7_to_deg(item.y)) if item.is_global else (item.x, item.y)
    return {
        "type": "SimpleItem",
        "autoContinue": item.autocontinue,
        "command": int(item.command),
        "doJumpId": number,
        "frame": int(item.frame),
        "params": [*(None if math.isnan(value) else value for value in item.params), *place, item.z],
    }


def _fence_tree(fence: Fence) -> dict[str, Any]:
    tree: dict[str, Any] = {
        "version": 2,
        "polygons": [
            {"version": 1, "inclusion": p.inclusion, "polygon": [_pair(corner) for corner in p.corners]}
            for p in fence.polygons
        ],
        "circles": [
            {
                "version": 1,
                "inclusion": c.inclusion,
                "circle": {"center": _pair(c.centre), "radius": c.radius_m},
            }
            for c in fence.circles
        ],
    }
    if fence.return_point is not None:
        tree["breachReturn"] = [*_pair(fence.return_point), fence.return_altitude_m]
    return tree
