"""Mission items as on the wire.

x and y are integers whose scale depends on the frame (MAVLink guide, "Mission protocol"): degrees × 1e7 in
global frames, metres × 1e4 in local ones, unscaled in MAV_FRAME_MISSION.
"""

import math
import struct
from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum
from operator import attrgetter
from typing import Any

from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, constants, dialect

GLOBAL_FRAMES = constants(
    "MAV_FRAME",
    *("GLOBAL", "GLOBAL_RELATIVE_ALT", "GLOBAL_TERRAIN_ALT"),
    *("GLOBAL_INT", "GLOBAL_RELATIVE_ALT_INT", "GLOBAL_TERRAIN_ALT_INT"),
)
LOCAL_FRAMES = constants(
    "MAV_FRAME",
    *("LOCAL_NED", "LOCAL_ENU", "LOCAL_FRD", "LOCAL_FLU", "LOCAL_OFFSET_NED"),
    *("BODY_NED", "BODY_FRD", "BODY_OFFSET_NED"),
)

_INT32_MAX = 2**31 - 1
_PARAMS = ("param1", "param2", "param3", "param4")
_CODES = {
    "frame": "B", "command": "H", "current": "B", "autocontinue": "B", **dict.fromkeys(_PARAMS, "f"),
    "x": "i", "y": "i", "z": "f",
}  # fmt: skip
_NAMES = tuple(_CODES)
_values = attrgetter(*_NAMES)
_wire = struct.Struct("<" + "".join(_CODES.values()))


class MissionType(IntEnum):
    """MAV_MISSION_TYPE of the lists of a vehicle."""

    MISSION = dialect.MAV_MISSION_TYPE_MISSION
    FENCE = dialect.MAV_MISSION_TYPE_FENCE
    RALLY = dialect.MAV_MISSION_TYPE_RALLY


class MissionResult(IntEnum):
    """MAV_MISSION_RESULT; unknown numbers become ERROR."""

    ACCEPTED = dialect.MAV_MISSION_ACCEPTED
    ERROR = dialect.MAV_MISSION_ERROR
    UNSUPPORTED_FRAME = dialect.MAV_MISSION_UNSUPPORTED_FRAME
    UNSUPPORTED = dialect.MAV_MISSION_UNSUPPORTED
    NO_SPACE = dialect.MAV_MISSION_NO_SPACE
    INVALID = dialect.MAV_MISSION_INVALID
    INVALID_PARAM1 = dialect.MAV_MISSION_INVALID_PARAM1
    INVALID_PARAM2 = dialect.MAV_MISSION_INVALID_PARAM2
    INVALID_PARAM3 = dialect.MAV_MISSION_INVALID_PARAM3
    INVALID_PARAM4 = dialect.MAV_MISSION_INVALID_PARAM4
    INVALID_PARAM5_X = dialect.MAV_MISSION_INVALID_PARAM5_X
    INVALID_PARAM6_Y = dialect.MAV_MISSION_INVALID_PARAM6_Y
    INVALID_PARAM7 = dialect.MAV_MISSION_INVALID_PARAM7
    INVALID_SEQUENCE = dialect.MAV_MISSION_INVALID_SEQUENCE
    DENIED = dialect.MAV_MISSION_DENIED
    OPERATION_CANCELLED = dialect.MAV_MISSION_OPERATION_CANCELLED

    @classmethod
    def _missing_(cls, value: object) -> "MissionResult":  # noqa: ARG003
        return cls.ERROR


@dataclass(frozen=True, slots=True)
class ItemFault:
    """Why an item or a list is refused: the result on the wire, and a text."""

    result: MissionResult
    text: str


@dataclass(frozen=True, slots=True, eq=False)
class MissionItem:
    """One item of a mission, fence or rally list, as in MISSION_ITEM_INT.

    Floats are rounded to single precision, so an item equals itself after a transfer. NaN equals NaN.
    Raises ValueError: a value that does not fit its field; names the field.
    """

    frame: int
    command: int
    current: int = 0
    autocontinue: int = 1
    param1: float = 0.0
    param2: float = 0.0
    param3: float = 0.0
    param4: float = 0.0
    x: int = 0
    y: int = 0
    z: float = 0.0

    def __post_init__(self) -> None:
        values = _values(self)
        try:
            carried = _wire.unpack(_wire.pack(*values))
        except (struct.error, OverflowError):
            raise ValueError(self._misfit()) from None
        if carried != values:  # rounded; or NaN, which never equals itself
            for name, value in zip(_NAMES, carried, strict=True):
                object.__setattr__(self, name, value)

    def _misfit(self) -> str:
        """The field that does not fit."""
        for name, code in _CODES.items():
            value = getattr(self, name)
            try:
                struct.pack("<" + code, value)
            except (struct.error, OverflowError):
                return f"{name} {value!r} does not fit its field on the wire"
        return "every field fits"

    def _key(self) -> tuple[int | float | None, ...]:
        return tuple(None if value != value else value for value in _values(self))  # noqa: PLR0124  NaN alone differs

    def __eq__(self, other: object) -> bool:
        return self._key() == other._key() if isinstance(other, MissionItem) else NotImplemented

    def __hash__(self) -> int:
        return hash(self._key())

    @staticmethod
    def from_message(message: Message) -> "MissionItem | ItemFault":
        """Convert a MISSION_ITEM_INT, or a MISSION_ITEM with float x and y. Never raises."""
        x, y = message.x, message.y
        if message.get_type() == "MISSION_ITEM":
            scaled_x, scaled_y = _scaled(x, message.frame), _scaled(y, message.frame)
            if scaled_x is None:
                return ItemFault(MissionResult.INVALID_PARAM5_X, f"x is {x}, not a position")
            if scaled_y is None:
                return ItemFault(MissionResult.INVALID_PARAM6_Y, f"y is {y}, not a position")
            x, y = scaled_x, scaled_y
        return MissionItem(**(dict(zip(_NAMES, _values(message), strict=True)) | {"x": x, "y": y}))

    def to_message(self, seq: int, target: Address, mission_type: MissionType) -> Message:
        """As MISSION_ITEM_INT."""
        message: Message = dialect.MAVLink_mission_item_int_message(
            target.system, target.component, seq, *_values(self), mission_type
        )
        return message

    def to_dict(self) -> dict[str, int | float | str | None]:
        """Plain values for JSON: NaN as null, an infinity as "inf" or "-inf"."""
        return {name: _to_plain(getattr(self, name)) for name in _NAMES}

    @staticmethod
    def from_dict(values: Mapping[str, Any]) -> "MissionItem":
        """From `to_dict`. Raises ValueError: a missing or unknown key, or an invalid value; names the key."""
        if set(values) != set(_NAMES):
            wrong = ", ".join(sorted(set(values) ^ set(_NAMES)))
            raise ValueError(f"a mission item with missing or unknown keys: {wrong}")
        return MissionItem(**{name: _from_plain(name, values[name]) for name in _NAMES})


def _scaled(value: float, frame: int) -> int | None:
    """A coordinate of a MISSION_ITEM as the integer of a MISSION_ITEM_INT, or None."""
    scale = 1e7 if frame in GLOBAL_FRAMES else 1e4 if frame in LOCAL_FRAMES else 1.0
    scaled = value * scale
    return round(scaled) if math.isfinite(scaled) and abs(scaled) <= _INT32_MAX else None


def _to_plain(value: float) -> int | float | str | None:
    if isinstance(value, int):
        return value
    return None if math.isnan(value) else str(value) if math.isinf(value) else value


def _from_plain(name: str, value: object) -> Any:  # noqa: ANN401  an int or a float, as the field asks
    if _CODES[name] != "f":
        if type(value) is not int:
            raise ValueError(f"{name} must be a whole number, not {value!r}")
        return value
    if value is None:
        return math.nan
    if type(value) in (int, float) or value in ("inf", "-inf"):
        return float(value)  # type: ignore[arg-type]
    raise ValueError(f"{name} must be a number or null, not {value!r}")
