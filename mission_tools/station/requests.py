"""The requests of the page as commands of MAVLink: a table, with a function where a request has arguments."""

import math
from collections.abc import Callable, Mapping
from typing import Any, Final, NamedTuple

from companion.core.modes import Mode
from companion.core.units import deg_to_e7
from companion.mavlink.dialect import dialect
from mission_tools.station.words import say

_DISARM_NOW: Final = 21196.0  # param2 of COMPONENT_ARM_DISARM: without any check, the emergency stop
_CHANGE_MODE: Final = 1.0  # param2 of DO_REPOSITION
_CUSTOM_MODE: Final = 1.0  # param1 of DO_SET_MODE
_GROUND_SPEED: Final = 1.0
_FASTEST_M_S: Final = 50.0
_MOST_POINTS: Final = 1000


class BadRequestError(Exception):
    """A request that cannot be sent. Its one argument is the text for people."""


class BoatCommand(NamedTuple):
    """A COMMAND_LONG, or with a place (1e-7 degrees) a COMMAND_INT.

    done: what the page says when the boat accepts. once: not to be repeated late, as the boat may carry it
    out again. steers: says where the boat is to go, and so replaces older requests that do. disarmed: only
    then.
    """

    number: int
    params: tuple[float, ...]
    done: str
    place: tuple[int, int] | None = None
    once: bool = False
    steers: bool = True
    disarmed: bool = False


Arguments = Mapping[str, Any]
ModeNumbers = Mapping[str, int]


def number_of(arguments: Arguments, name: str) -> float:
    """A number of a request; BadRequestError without one."""
    value = arguments.get(name)
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise BadRequestError(say("answer.no_number", name=name))
    return float(value)


def _position(lat: float, lon: float) -> tuple[int, int]:
    if not (-90.0 <= lat <= 90.0 and -180.0 <= lon <= 180.0) or (lat == 0.0 and lon == 0.0):
        raise BadRequestError(say("answer.no_place", lat=str(lat), lon=str(lon)))
    return deg_to_e7(lat), deg_to_e7(lon)


def _set_mode(number: int, done: str) -> BoatCommand:
    return BoatCommand(dialect.MAV_CMD_DO_SET_MODE, (_CUSTOM_MODE, float(number)), done)


def _arming(params: tuple[float, float], done: str, *, steers: bool = False) -> BoatCommand:
    return BoatCommand(dialect.MAV_CMD_COMPONENT_ARM_DISARM, params, done, steers=steers)


def _once(number: int, params: tuple[float, ...], done: str) -> BoatCommand:
    return BoatCommand(number, params, done, once=True)


def _go(arguments: Arguments, modes: ModeNumbers) -> BoatCommand:  # noqa: ARG001
    place = _position(number_of(arguments, "lat"), number_of(arguments, "lon"))
    params = (-1.0, _CHANGE_MODE, 0.0, math.nan)
    return BoatCommand(dialect.MAV_CMD_DO_REPOSITION, params, say("answer.go"), place)


def _speed(arguments: Arguments, modes: ModeNumbers) -> BoatCommand:  # noqa: ARG001
    speed_m_s = number_of(arguments, "m_s")
    if not 0.0 < speed_m_s <= _FASTEST_M_S:
        raise BadRequestError(say("answer.no_speed", n=speed_m_s))
    done = say("answer.speed", n=speed_m_s)
    return BoatCommand(dialect.MAV_CMD_DO_CHANGE_SPEED, (_GROUND_SPEED, speed_m_s, -1.0), done, steers=False)


def _mode(arguments: Arguments, modes: ModeNumbers) -> BoatCommand:
    name = arguments.get("mode")
    if not isinstance(name, str) or name not in modes:
        raise BadRequestError(say("answer.no_mode", modes=", ".join(modes)))
    return _set_mode(modes[name], say("answer.mode", mode=name))


_FIXED: Final = {
    "arm": _arming((1.0, 0.0), say("answer.arm")),
    "check": BoatCommand(dialect.MAV_CMD_RUN_PREARM_CHECKS, (), say("answer.check"), steers=False),
    "continue": _once(dialect.MAV_CMD_DO_PAUSE_CONTINUE, (1.0,), say("answer.continue")),
    "disarm": _arming((0.0, 0.0), say("answer.disarm")),
    "hold": _set_mode(Mode.LOITER, say("answer.hold")),  # in HOLD it would drift
    "pause": _once(dialect.MAV_CMD_DO_PAUSE_CONTINUE, (0.0,), say("answer.pause")),
    "restart": BoatCommand(
        dialect.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, (1.0,), say("answer.restart"),
        once=True, steers=False, disarmed=True,
    ),
    "return": _set_mode(Mode.RTL, say("answer.return")),
    "start": _once(dialect.MAV_CMD_MISSION_START, (), say("answer.start")),
    "stop": _arming((0.0, _DISARM_NOW), say("answer.stop"), steers=True),
}  # fmt: skip
_BUILT: Final[dict[str, Callable[[Arguments, ModeNumbers], BoatCommand]]] = {
    "go": _go, "set_mode": _mode, "speed": _speed,
}  # fmt: skip


def build_command(what: str, arguments: Arguments, modes: ModeNumbers) -> BoatCommand:
    """The command of a request; BadRequestError says what is wrong with it."""
    if (fixed := _FIXED.get(what)) is not None:
        return fixed
    if (build := _BUILT.get(what)) is None:
        known = ", ".join(["sail", *sorted([*_FIXED, *_BUILT])])
        raise BadRequestError(say("answer.unknown", what=repr(what), known=known))
    return build(arguments, modes)


def way_points(arguments: Arguments) -> list[tuple[int, int]]:
    """The points of a way to sail, 1e-7 degrees latitude and longitude; BadRequestError without a way."""
    points = arguments.get("points")
    if not isinstance(points, list) or not 1 <= len(points) <= _MOST_POINTS:
        raise BadRequestError(say("answer.no_way_points", most=_MOST_POINTS))
    way = []
    for point in points:
        if not isinstance(point, list | tuple) or len(point) != 2:
            raise BadRequestError(say("answer.no_way_point"))
        lon, lat = (number_of({"a coordinate": value}, "a coordinate") for value in point)
        way.append(_position(lat, lon))
    return way
