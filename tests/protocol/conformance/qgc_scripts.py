"""QGroundControl's connection sequences as data: one entry a step, in the order in which it takes them.

After the public sources of 4.4, 5.0 and master, checked against recordings of 4.4. What it does not wait for
(heartbeats, stream requests) is `Tell`; the rest must be answered before it goes on.
"""

from dataclasses import dataclass
from typing import Any

from client_habits import QGC_44, QGC_50, QGC_MASTER, Habits
from pymavlink.dialects.v20 import all as dialect

_ID = dialect
_COMPONENT_INFORMATION, _COMPONENT_METADATA = 395, 397  # pymavlink has dropped one and lacks the other


@dataclass(frozen=True, slots=True)
class Tell:
    """Messages that nothing answers directly, by class name and fields after the target."""

    what: str
    message: str
    rows: tuple[tuple[Any, ...], ...]
    is_targeted: bool = True


@dataclass(frozen=True, slots=True)
class Command:
    """A COMMAND_LONG; brings: the message that must follow an acceptance. A refusal is an answer."""

    number: int
    params: tuple[float, ...] = ()
    brings: int | None = None
    times: int = 1  # asked again by the version itself while refused


@dataclass(frozen=True, slots=True)
class Modes:
    """AVAILABLE_MODES one by one until the last, or a refusal."""


@dataclass(frozen=True, slots=True)
class ReadParameters:
    """The packed file; the list where there is no such file."""

    path: str


@dataclass(frozen=True, slots=True)
class ReadPlan:
    """One list: 0 mission, 1 fence, 2 rally."""

    mission_type: int


Step = Tell | Command | Modes | ReadParameters | ReadPlan


@dataclass(frozen=True, slots=True)
class Script:
    """One version's way to connect."""

    habits: Habits
    steps: tuple[Step, ...]


_STREAMS = Tell(
    "streams",
    "request_data_stream",
    tuple(
        (stream, rate_hz, 1)
        for stream, rate_hz in ((1, 2), (2, 2), (3, 2), (6, 3), (10, 10), (11, 10), (12, 3))
    ),
)
_CLOCK = Tell("clock", "system_time", ((1795267087211000, 0), (1795267087211000, 0)), is_targeted=False)


def _message(message_id: int) -> Command:
    return Command(_ID.MAV_CMD_REQUEST_MESSAGE, (float(message_id),), message_id)


def _interval(message_id: int, interval_us: float) -> Command:
    return Command(_ID.MAV_CMD_SET_MESSAGE_INTERVAL, (float(message_id), interval_us))


_PLANS = (ReadPlan(0), ReadPlan(1), ReadPlan(2))
_GIMBAL = _message(_ID.MAVLINK_MSG_ID_GIMBAL_MANAGER_INFORMATION)
_METADATA = (
    _message(_COMPONENT_METADATA),
    _message(_COMPONENT_INFORMATION),
)


def _newer(habits: Habits, parameters: str) -> Script:
    return Script(
        habits,
        (
            _STREAMS,
            _interval(_ID.MAVLINK_MSG_ID_HOME_POSITION, 1e6),
            _interval(_ID.MAVLINK_MSG_ID_EXTENDED_SYS_STATE, 1e6),
            _message(_ID.MAVLINK_MSG_ID_AUTOPILOT_VERSION),
            Modes(),
            *_METADATA,
            ReadParameters(parameters),
            _CLOCK,
            *_PLANS,
            _GIMBAL,
        ),
    )


SCRIPTS = (
    Script(
        QGC_44,
        (
            _message(_ID.MAVLINK_MSG_ID_AUTOPILOT_VERSION),
            _interval(_ID.MAVLINK_MSG_ID_HOME_POSITION, 1e6),
            *_METADATA,
            _STREAMS,
            ReadParameters("@PARAM/param.pck"),
            _CLOCK,
            *_PLANS,
            _GIMBAL,
            Command(_ID.MAV_CMD_REQUEST_CAMERA_INFORMATION, (1.0,)),
            _message(_ID.MAVLINK_MSG_ID_CAMERA_INFORMATION),
        ),
    ),
    _newer(QGC_50, "@PARAM/param.pck"),
    _newer(QGC_MASTER, "@PARAM/param.pck?withdefaults=1"),
)
