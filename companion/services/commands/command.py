"""A command from a station, from either of the two messages."""

import math
from collections.abc import Callable
from enum import IntEnum

from msgspec import Struct

from companion.core.geo import LatLon
from companion.core.units import e7_to_deg
from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, build_message, constants, dialect
from companion.services.missions.items import HIGHEST_M
from companion.services.outbox import Origin


class Result(IntEnum):
    """MAV_RESULT."""

    ACCEPTED = dialect.MAV_RESULT_ACCEPTED
    REJECTED_FOR_NOW = dialect.MAV_RESULT_TEMPORARILY_REJECTED
    DENIED = dialect.MAV_RESULT_DENIED
    UNSUPPORTED = dialect.MAV_RESULT_UNSUPPORTED
    FAILED = dialect.MAV_RESULT_FAILED
    IN_PROGRESS = dialect.MAV_RESULT_IN_PROGRESS
    CANCELLED = 6  # newer than the dialect


_GLOBAL_FRAMES = constants(
    "MAV_FRAME", "GLOBAL", "GLOBAL_INT", "GLOBAL_RELATIVE_ALT", "GLOBAL_RELATIVE_ALT_INT"
)


FollowUps = list[tuple[int, Message]]
"""Channels and messages that follow the command's COMMAND_ACK."""


class Command(Struct, frozen=True):
    """p: param1..4; x, y: degrees, NaN if not given; `fifth`, `sixth`: the raw param5 and param6."""

    number: int
    p: tuple[float, float, float, float]
    x: float
    y: float
    frame: int
    origin: Origin
    now_s: float
    fifth: float = 0.0
    sixth: float = 0.0
    altitude_m: float = math.nan  # NaN if not given; not used
    repetition: int = 0  # COMMAND_LONG's confirmation: how often it was sent before

    def whole(self, index: int) -> int | None:
        """A parameter as an integer, None if it is not one."""
        value = self.p[index]
        return int(value) if math.isfinite(value) and value == int(value) else None

    def position(self) -> LatLon | None:
        """The position, None if there is none in a global frame."""
        if self.frame not in _GLOBAL_FRAMES or (self.x == 0.0 and self.y == 0.0):
            return None
        if abs(self.altitude_m) > HIGHEST_M:
            return None
        try:
            return LatLon(self.x, self.y)
        except ValueError:
            return None

    def shares_answer_with(self, other: "Command") -> bool:
        """Whether one COMMAND_ACK would do for both: same number and sender."""
        return self.number == other.number and self.origin.address == other.origin.address

    def is_same_as(self, other: "Command") -> bool:
        """Whether the same sender repeats the command; NaN equals NaN."""
        return (
            self.shares_answer_with(other)
            and self.frame == other.frame
            and all(map(_alike, (*self.p, self.x, self.y), (*other.p, other.x, other.y)))
        )


CommandTable = dict[int, Callable[[Command], Result]]
"""Carries out a command, by its number."""


def acknowledgement(number: int, result: Result, asker: Address, progress_percent: int = 0) -> Message:
    """COMMAND_ACK to the sender of a command."""
    return build_message(
        "COMMAND_ACK",
        command=number,
        result=result,
        progress=progress_percent,
        target_system=asker.system,
        target_component=asker.component,
    )


def _alike(a: float, b: float) -> bool:
    return a == b or (math.isnan(a) and math.isnan(b))


def command_of(message: Message, origin: Origin, now_s: float) -> Command:
    """COMMAND_LONG has a position as floats in param5 and param6, COMMAND_INT as 1e7 integers."""
    number, p = message.command, (message.param1, message.param2, message.param3, message.param4)
    if message.get_msgId() == dialect.MAVLINK_MSG_ID_COMMAND_INT:
        raw, place = (float(message.x), float(message.y)), (e7_to_deg(message.x), e7_to_deg(message.y))
        return Command(number, p, *place, message.frame, origin, now_s, *raw, message.z)
    place, frame = (message.param5, message.param6), dialect.MAV_FRAME_GLOBAL
    return Command(number, p, *place, frame, origin, now_s, *place, message.param7, message.confirmation)
