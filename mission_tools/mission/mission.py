"""A mission as every part of the planner sees it: items, home, fence and rally points.

Items carry the fields of MAVLink's MISSION_ITEM_INT. In a global frame x and y are latitude and longitude
in 1e-7 degrees; in frame MISSION they are the command's fifth and sixth parameter.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import IntEnum

from companion.core.geo import LatLon
from companion.core.units import deg_to_e7, e7_to_deg


class Frame(IntEnum):
    """The MAV_FRAME values that a boat's mission uses."""

    GLOBAL = 0
    MISSION = 2
    GLOBAL_RELATIVE_ALT = 3  # what ground stations send for a waypoint
    GLOBAL_INT = 5
    GLOBAL_RELATIVE_ALT_INT = 6
    GLOBAL_TERRAIN_ALT = 10
    GLOBAL_TERRAIN_ALT_INT = 11


class Command(IntEnum):
    """The MAV_CMD values that this package handles by name."""

    NAV_WAYPOINT = 16
    NAV_LOITER_UNLIM = 17
    NAV_LOITER_TURNS = 18
    NAV_LOITER_TIME = 19
    NAV_RETURN_TO_LAUNCH = 20
    NAV_GUIDED_ENABLE = 92
    NAV_DELAY = 93
    CONDITION_YAW = 115
    DO_SET_MODE = 176
    DO_JUMP = 177
    DO_CHANGE_SPEED = 178
    DO_SET_HOME = 179
    DO_SET_RELAY = 181
    DO_SET_CAM_TRIGG_DIST = 206
    NAV_SET_YAW_SPEED = 213
    MISSION_START = 300
    COMPONENT_ARM_DISARM = 400
    SET_MESSAGE_INTERVAL = 511
    NAV_FENCE_RETURN_POINT = 5000
    NAV_FENCE_POLYGON_VERTEX_INCLUSION = 5001
    NAV_FENCE_POLYGON_VERTEX_EXCLUSION = 5002
    NAV_FENCE_CIRCLE_INCLUSION = 5003
    NAV_FENCE_CIRCLE_EXCLUSION = 5004
    NAV_RALLY_POINT = 5100


POSITION_COMMANDS = frozenset(
    {Command.NAV_WAYPOINT, Command.NAV_LOITER_UNLIM, Command.NAV_LOITER_TURNS, Command.NAV_LOITER_TIME}
)
"""Commands that send the boat to a place."""
VERTICES = {
    True: Command.NAV_FENCE_POLYGON_VERTEX_INCLUSION,
    False: Command.NAV_FENCE_POLYGON_VERTEX_EXCLUSION,
}
CIRCLES = {True: Command.NAV_FENCE_CIRCLE_INCLUSION, False: Command.NAV_FENCE_CIRCLE_EXCLUSION}
"""By whether the boat stays inside."""

_SAME_AS_INT = {
    Frame.GLOBAL_INT: Frame.GLOBAL,
    Frame.GLOBAL_RELATIVE_ALT_INT: Frame.GLOBAL_RELATIVE_ALT,
    Frame.GLOBAL_TERRAIN_ALT_INT: Frame.GLOBAL_TERRAIN_ALT,
}


GROUND_SPEED = 1.0  # MAV_CMD_DO_CHANGE_SPEED: which speed
KEEP_THROTTLE = -1.0


def command_name(command: int) -> str:
    """A command's name for people; its number where this package has no name for it."""
    return Command(command).name if command in set(Command) else f"MAV_CMD {command}"


MOST_ITEMS = 65_535  # that MISSION_COUNT can carry
LARGEST = (2.0 - 2.0**-23) * 2.0**127  # that a 32-bit float holds
_WIDEST_M = 1e7  # a quarter of the way round the Earth


def check_count(count: int) -> None:
    """See early whether a file's items fit into a mission. Raises ValueError: they do not."""
    if count > MOST_ITEMS:
        raise ValueError(f"{count} items: a mission holds {MOST_ITEMS} at most; cut it into parts")


def plain_frame(frame: int) -> int:
    """The frame without its _INT variant, which means the same in MISSION_ITEM_INT."""
    return _SAME_AS_INT.get(Frame(frame), frame) if frame in set(Frame) else frame


def is_global_frame(frame: int) -> bool:
    """Whether x and y are a latitude and a longitude in this frame."""
    return plain_frame(frame) in {Frame.GLOBAL, Frame.GLOBAL_RELATIVE_ALT, Frame.GLOBAL_TERRAIN_ALT}


@dataclass(frozen=True, slots=True)
class MissionItem:
    """One item: what to do and where. A NaN parameter means "as the vehicle likes". Raises ValueError: a
    field outside what MISSION_ITEM_INT can carry, or a place that is not on Earth.
    """

    command: int
    frame: int = Frame.GLOBAL_RELATIVE_ALT
    params: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    x: int = 0
    y: int = 0
    z: float = 0.0
    autocontinue: bool = True

    def __post_init__(self) -> None:
        if not 0 <= self.command <= 65535:
            raise ValueError(f"command {self.command} is outside 0..65535")
        if not 0 <= self.frame <= 255:
            raise ValueError(f"frame {self.frame} is outside 0..255")
        if not all(-(2**31) <= value < 2**31 for value in (self.x, self.y)):
            raise ValueError("x and y must fit 32 bits")
        for value in (*self.params, self.z):
            if math.isfinite(value) and abs(value) > LARGEST:
                raise ValueError(f"{value:g} does not fit the 32 bits that a parameter has")
        if self.is_global:
            _ = self.lat_lon

    @classmethod
    def at(
        cls,
        place: LatLon,
        command: int = Command.NAV_WAYPOINT,
        params: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0),
        *,
        frame: int = Frame.GLOBAL_RELATIVE_ALT,
        z: float = 0.0,
    ) -> "MissionItem":
        """An item at a place, rounded to the 1e-7 degrees (about 1 cm) of the wire."""
        return cls(command, frame, params, deg_to_e7(place.lat_deg), deg_to_e7(place.lon_deg), z)

    @classmethod
    def from_numbers(
        cls, command: int, frame: int, values: Sequence[float], *, autocontinue: bool
    ) -> "MissionItem":
        """An item from the seven numbers of a file: degrees in a global frame, NaN where nothing is said."""
        p1, p2, p3, p4, x, y, z = values
        for value in values:
            if abs(value) > LARGEST:
                raise ValueError(f"{value:g} does not fit the 32 bits that a parameter has")
        if command in POSITION_COMMANDS and (math.isnan(x) or math.isnan(y)):
            raise ValueError(f"{command_name(command)} needs a latitude and a longitude")
        scale = 1e7 if is_global_frame(frame) else 1.0
        x_int, y_int = (0 if math.isnan(value) else round(value * scale) for value in (x, y))
        return cls(command, frame, (p1, p2, p3, p4), x_int, y_int, 0.0 if math.isnan(z) else z, autocontinue)

    @property
    def is_global(self) -> bool:
        """Whether x and y are a latitude and a longitude."""
        return is_global_frame(self.frame)

    @property
    def place(self) -> LatLon | None:
        """Where the item sends the boat; None for items that send it nowhere."""
        if not self.is_global or self.command not in POSITION_COMMANDS:
            return None
        return self.lat_lon

    @property
    def lat_lon(self) -> LatLon:
        """x and y in a global frame."""
        return LatLon(e7_to_deg(self.x), e7_to_deg(self.y))

    @property
    def hold_s(self) -> float:
        """How long the boat is to wait at this item."""
        waits = {Command.NAV_WAYPOINT, Command.NAV_LOITER_TIME, Command.NAV_DELAY}
        return self.params[0] if self.command in waits and self.params[0] > 0.0 else 0.0


def speed_item(speed_m_s: float) -> MissionItem:
    """From here on at this speed over ground."""
    return MissionItem(Command.DO_CHANGE_SPEED, Frame.MISSION, (GROUND_SPEED, speed_m_s, KEEP_THROTTLE, 0.0))


def shifted_jump(item: MissionItem, by: int) -> MissionItem:
    """The item, its target moved by that many sequence numbers if it is a DO_JUMP."""
    if item.command != Command.DO_JUMP:
        return item
    return replace(item, params=(item.params[0] + by, *item.params[1:]))


@dataclass(frozen=True, slots=True)
class FencePolygon:
    """An area to stay inside of (inclusion) or to keep out of. At least three corners."""

    corners: tuple[LatLon, ...]
    inclusion: bool = True

    def __post_init__(self) -> None:
        if len(self.corners) < 3:
            raise ValueError(f"a polygon needs at least 3 corners, got {len(self.corners)}")


@dataclass(frozen=True, slots=True)
class FenceCircle:
    """A disc to stay inside of (inclusion) or to keep out of."""

    centre: LatLon
    radius_m: float
    inclusion: bool = True

    def __post_init__(self) -> None:
        if not 0.0 < self.radius_m <= _WIDEST_M:
            raise ValueError(
                f"radius {self.radius_m} must be a positive number of metres, {_WIDEST_M:g} at most"
            )


@dataclass(frozen=True, slots=True)
class Fence:
    """All areas, and where to go after a breach."""

    polygons: tuple[FencePolygon, ...] = ()
    circles: tuple[FenceCircle, ...] = ()
    return_point: LatLon | None = None
    return_altitude_m: float = 0.0

    def items(self) -> tuple[MissionItem, ...]:
        """As MAVLink fence items: every corner carries its polygon's number of corners."""
        found: list[MissionItem] = []
        if self.return_point is not None:
            command = Command.NAV_FENCE_RETURN_POINT
            found.append(MissionItem.at(self.return_point, command, z=self.return_altitude_m))
        for polygon in self.polygons:
            command, params = VERTICES[polygon.inclusion], (float(len(polygon.corners)), 0.0, 0.0, 0.0)
            found += [
                MissionItem.at(corner, command, params, frame=Frame.GLOBAL) for corner in polygon.corners
            ]
        for circle in self.circles:
            params = (circle.radius_m, 0.0, 0.0, 0.0)
            found.append(MissionItem.at(circle.centre, CIRCLES[circle.inclusion], params, frame=Frame.GLOBAL))
        return tuple(found)


@dataclass(frozen=True, slots=True)
class Rally:
    """A safe place to return to."""

    place: LatLon
    altitude_m: float = 0.0

    def item(self) -> MissionItem:
        """As a MAVLink rally item."""
        return MissionItem.at(self.place, Command.NAV_RALLY_POINT, z=self.altitude_m)


class MissionType(IntEnum):
    """MAV_MISSION_TYPE: the three lists that a vehicle keeps."""

    MISSION = 0
    FENCE = 1
    RALLY = 2


LIST_NAMES = {
    MissionType.MISSION: "mission",
    MissionType.FENCE: "fence",
    MissionType.RALLY: "rally points",
}


@dataclass(frozen=True, slots=True)
class Mission:
    """Everything that an upload carries. `items` is without home: items[0] has sequence number 1.

    DO_JUMP items name their target by sequence number, home being 0, as on the wire.
    """

    items: tuple[MissionItem, ...]
    home: LatLon | None = None
    home_altitude_m: float = 0.0
    fence: Fence = Fence()
    rally: tuple[Rally, ...] = ()
    speed_m_s: float | None = None  # what the planner's file says the boat cruises at

    def wire_lists(self, *, home_first: bool) -> dict[MissionType, tuple[MissionItem, ...]]:
        """What is sent, list by list; fence and rally points only where there are any.

        home_first: home is item 0 of the mission, as ArduPilot keeps it. Without a home the mission's first
        place stands in; the vehicle puts its own there.
        """
        lists = {
            MissionType.MISSION: (self._home_item(), *self.items) if home_first else self.items,
            MissionType.FENCE: self.fence.items(),
            MissionType.RALLY: tuple(point.item() for point in self.rally),
        }
        return {kind: items for kind, items in lists.items() if items or kind is MissionType.MISSION}

    def _home_item(self) -> MissionItem:
        home = self.home or next(iter(self.places), LatLon(0.0, 0.0))
        return MissionItem.at(home, frame=Frame.GLOBAL, z=self.home_altitude_m)

    def at_speed(self, speed_m_s: float) -> "Mission":
        """The same mission, sailed at this speed over ground (must be positive)."""
        items = (speed_item(speed_m_s), *(shifted_jump(item, 1) for item in self.items))
        return replace(self, items=items, speed_m_s=speed_m_s)

    @property
    def places(self) -> tuple[LatLon, ...]:
        """Where the mission leads, in order."""
        return tuple(item.place for item in self.items if item.place is not None)
