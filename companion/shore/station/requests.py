"""The requests of the page as commands of MAVLink: one small function each, and the table of them."""

import math
from collections.abc import Callable, Mapping
from typing import Any, Final, NamedTuple

from companion.core.modes import Mode
from companion.core.units import deg_to_e7
from companion.mavlink.dialect import dialect

_DISARM_NOW: Final = 21196.0  # param2 of COMPONENT_ARM_DISARM: without any check, the emergency stop
_CHANGE_MODE: Final = 1.0  # param2 of DO_REPOSITION
_CUSTOM_MODE: Final = 1.0  # param1 of DO_SET_MODE
_GROUND_SPEED: Final = 1.0
_FASTEST_M_S: Final = 50.0
_MOST_POINTS: Final = 1000
_PLAINLY: Final = "{} is missing or is no number"


class BadRequestError(Exception):
    """A request that cannot be sent. Its text is for people."""


class Command(NamedTuple):
    """A COMMAND_LONG, or with a place (1e-7 degrees) a COMMAND_INT.

    done: what the page says when the boat accepts. once: not to be repeated late, as the boat may carry it
    out again. steers: says where the boat is to go, and so replaces older requests that do.
    """

    number: int
    params: tuple[float, ...]
    done: str
    place: tuple[int, int] | None = None
    once: bool = False
    steers: bool = True


Arguments = Mapping[str, Any]
ModeNumbers = Mapping[str, int]


def _number(arguments: Arguments, name: str) -> float:
    value = arguments.get(name)
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise BadRequestError(_PLAINLY.format(name))
    return float(value)


def _position(lat: float, lon: float) -> tuple[int, int]:
    if not (-90.0 <= lat <= 90.0 and -180.0 <= lon <= 180.0) or (lat == 0.0 and lon == 0.0):
        raise BadRequestError(f"{lat}, {lon} is no place on the globe")
    return deg_to_e7(lat), deg_to_e7(lon)


def _set_mode(number: int, done: str) -> Command:
    return Command(dialect.MAV_CMD_DO_SET_MODE, (_CUSTOM_MODE, float(number)), done)


def _hold(arguments: Arguments, modes: ModeNumbers) -> Command:  # noqa: ARG001
    return _set_mode(Mode.LOITER, "The boat keeps its place")  # in HOLD it would drift


def _return(arguments: Arguments, modes: ModeNumbers) -> Command:  # noqa: ARG001
    return _set_mode(Mode.RTL, "The boat returns home")


def _start(arguments: Arguments, modes: ModeNumbers) -> Command:  # noqa: ARG001
    return Command(dialect.MAV_CMD_MISSION_START, (), "The boat sails the mission", once=True)


def _pause(arguments: Arguments, modes: ModeNumbers) -> Command:  # noqa: ARG001
    return Command(dialect.MAV_CMD_DO_PAUSE_CONTINUE, (0.0,), "Paused: the boat keeps its place", once=True)


def _continue(arguments: Arguments, modes: ModeNumbers) -> Command:  # noqa: ARG001
    return Command(dialect.MAV_CMD_DO_PAUSE_CONTINUE, (1.0,), "The boat goes on", once=True)


def _go(arguments: Arguments, modes: ModeNumbers) -> Command:  # noqa: ARG001
    place = _position(_number(arguments, "lat"), _number(arguments, "lon"))
    params = (-1.0, _CHANGE_MODE, 0.0, math.nan)
    return Command(dialect.MAV_CMD_DO_REPOSITION, params, "The boat goes there", place)


def _speed(arguments: Arguments, modes: ModeNumbers) -> Command:  # noqa: ARG001
    speed_m_s = _number(arguments, "m_s")
    if not 0.0 < speed_m_s <= _FASTEST_M_S:
        raise BadRequestError(f"{speed_m_s:g} m/s is no speed of a boat; expected more than 0")
    params = (_GROUND_SPEED, speed_m_s, -1.0)
    return Command(
        dialect.MAV_CMD_DO_CHANGE_SPEED, params, f"The speed is now {speed_m_s:g} m/s", steers=False
    )


def _stop(arguments: Arguments, modes: ModeNumbers) -> Command:  # noqa: ARG001
    params = (0.0, _DISARM_NOW)
    return Command(dialect.MAV_CMD_COMPONENT_ARM_DISARM, params, "Stopped: motors off, disarmed")


def _arm(arguments: Arguments, modes: ModeNumbers) -> Command:  # noqa: ARG001
    return Command(
        dialect.MAV_CMD_COMPONENT_ARM_DISARM, (1.0, 0.0), "Armed: the propellers may turn", steers=False
    )


def _disarm(arguments: Arguments, modes: ModeNumbers) -> Command:  # noqa: ARG001
    return Command(dialect.MAV_CMD_COMPONENT_ARM_DISARM, (0.0, 0.0), "Disarmed")


def _mode(arguments: Arguments, modes: ModeNumbers) -> Command:
    name = arguments.get("mode")
    if not isinstance(name, str) or name not in modes:
        raise BadRequestError("The boat has no such mode; expected one of " + ", ".join(modes))
    return _set_mode(modes[name], f"Mode {name}")


def _check(arguments: Arguments, modes: ModeNumbers) -> Command:  # noqa: ARG001
    return Command(dialect.MAV_CMD_RUN_PREARM_CHECKS, (), "The boat has checked itself", steers=False)


COMMANDS: Final[dict[str, Callable[[Arguments, ModeNumbers], Command]]] = {
    "arm": _arm,
    "check": _check,
    "continue": _continue,
    "disarm": _disarm,
    "go": _go,
    "hold": _hold,
    "pause": _pause,
    "return": _return,
    "set_mode": _mode,
    "speed": _speed,
    "start": _start,
    "stop": _stop,
}


def build_command(what: str, arguments: Arguments, modes: ModeNumbers) -> Command:
    """The command of a request.

    Raises:
        BadRequestError: says what is wrong.
    """
    build = COMMANDS.get(what)
    if build is None:
        raise BadRequestError(f"Unknown request {what!r}; expected one of sail, " + ", ".join(COMMANDS))
    return build(arguments, modes)


def way_points(arguments: Arguments) -> list[tuple[int, int]]:
    """The points of a way to sail, 1e-7 degrees latitude and longitude.

    Raises:
        BadRequestError: says what is wrong.
    """
    points = arguments.get("points")
    if not isinstance(points, list) or not 1 <= len(points) <= _MOST_POINTS:
        raise BadRequestError(f"points: expected 1 to {_MOST_POINTS} of [longitude, latitude]")
    way = []
    for point in points:
        if not isinstance(point, list | tuple) or len(point) != 2:
            raise BadRequestError("points: expected [longitude, latitude]")
        lon, lat = (_number({"a coordinate": value}, "a coordinate") for value in point)
        way.append(_position(lat, lon))
    return way
