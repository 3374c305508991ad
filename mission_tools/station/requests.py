"""The requests of the page as commands of MAVLink: one small function each, and the table of them."""

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
    """A number of a request.

    Raises:
        BadRequestError: there is none.
    """
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


def _hold(arguments: Arguments, modes: ModeNumbers) -> BoatCommand:  # noqa: ARG001
    return _set_mode(Mode.LOITER, say("answer.hold"))  # in HOLD it would drift


def _return(arguments: Arguments, modes: ModeNumbers) -> BoatCommand:  # noqa: ARG001
    return _set_mode(Mode.RTL, say("answer.return"))


def _start(arguments: Arguments, modes: ModeNumbers) -> BoatCommand:  # noqa: ARG001
    return BoatCommand(dialect.MAV_CMD_MISSION_START, (), say("answer.start"), once=True)


def _pause(arguments: Arguments, modes: ModeNumbers) -> BoatCommand:  # noqa: ARG001
    return BoatCommand(dialect.MAV_CMD_DO_PAUSE_CONTINUE, (0.0,), say("answer.pause"), once=True)


def _continue(arguments: Arguments, modes: ModeNumbers) -> BoatCommand:  # noqa: ARG001
    return BoatCommand(dialect.MAV_CMD_DO_PAUSE_CONTINUE, (1.0,), say("answer.continue"), once=True)


def _go(arguments: Arguments, modes: ModeNumbers) -> BoatCommand:  # noqa: ARG001
    place = _position(number_of(arguments, "lat"), number_of(arguments, "lon"))
    params = (-1.0, _CHANGE_MODE, 0.0, math.nan)
    return BoatCommand(dialect.MAV_CMD_DO_REPOSITION, params, say("answer.go"), place)


def _speed(arguments: Arguments, modes: ModeNumbers) -> BoatCommand:  # noqa: ARG001
    speed_m_s = number_of(arguments, "m_s")
    if not 0.0 < speed_m_s <= _FASTEST_M_S:
        raise BadRequestError(say("answer.no_speed", n=speed_m_s))
    params = (_GROUND_SPEED, speed_m_s, -1.0)
    return BoatCommand(
        dialect.MAV_CMD_DO_CHANGE_SPEED, params, say("answer.speed", n=speed_m_s), steers=False
    )


def _stop(arguments: Arguments, modes: ModeNumbers) -> BoatCommand:  # noqa: ARG001
    params = (0.0, _DISARM_NOW)
    return BoatCommand(dialect.MAV_CMD_COMPONENT_ARM_DISARM, params, say("answer.stop"))


def _arm(arguments: Arguments, modes: ModeNumbers) -> BoatCommand:  # noqa: ARG001
    return BoatCommand(dialect.MAV_CMD_COMPONENT_ARM_DISARM, (1.0, 0.0), say("answer.arm"), steers=False)


def _disarm(arguments: Arguments, modes: ModeNumbers) -> BoatCommand:  # noqa: ARG001
    return BoatCommand(dialect.MAV_CMD_COMPONENT_ARM_DISARM, (0.0, 0.0), say("answer.disarm"))


def _mode(arguments: Arguments, modes: ModeNumbers) -> BoatCommand:
    name = arguments.get("mode")
    if not isinstance(name, str) or name not in modes:
        raise BadRequestError(say("answer.no_mode", modes=", ".join(modes)))
    return _set_mode(modes[name], say("answer.mode", mode=name))


def _check(arguments: Arguments, modes: ModeNumbers) -> BoatCommand:  # noqa: ARG001
    return BoatCommand(dialect.MAV_CMD_RUN_PREARM_CHECKS, (), say("answer.check"), steers=False)


def _restart(arguments: Arguments, modes: ModeNumbers) -> BoatCommand:  # noqa: ARG001
    number = dialect.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN
    return BoatCommand(number, (1.0,), say("answer.restart"), once=True, steers=False, disarmed=True)


COMMANDS: Final[dict[str, Callable[[Arguments, ModeNumbers], BoatCommand]]] = {
    "arm": _arm,
    "check": _check,
    "continue": _continue,
    "disarm": _disarm,
    "go": _go,
    "hold": _hold,
    "pause": _pause,
    "restart": _restart,
    "return": _return,
    "set_mode": _mode,
    "speed": _speed,
    "start": _start,
    "stop": _stop,
}


def build_command(what: str, arguments: Arguments, modes: ModeNumbers) -> BoatCommand:
    """The command of a request.

    Raises:
        BadRequestError: says what is wrong.
    """
    build = COMMANDS.get(what)
    if build is None:
        raise BadRequestError(say("answer.unknown", what=repr(what), known=", ".join(["sail", *COMMANDS])))
    return build(arguments, modes)


def way_points(arguments: Arguments) -> list[tuple[int, int]]:
    """The points of a way to sail, 1e-7 degrees latitude and longitude.

    Raises:
        BadRequestError: says what is wrong.
    """
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
