"""What a payload can be told to do: values that commands, mission items and the boat's own rules share."""

from dataclasses import dataclass
from enum import IntEnum
from typing import ClassVar, NamedTuple

ALL = 0  # number of all grippers, winches or lights


class ActionFault(NamedTuple):
    """Why an action is impossible. parameter: the command's parameter at fault, 1 to 7; 0: this boat has no
    payload of the kind. is_absent: the payload is not fitted.
    """

    parameter: int
    text: str
    is_absent: bool = False


@dataclass(frozen=True, slots=True)
class SetServo:
    """Set the pulse width of a servo channel."""

    kind: ClassVar = "servo"
    number: int
    width_us: int


@dataclass(frozen=True, slots=True)
class RepeatServo:
    """Set a width for half a period and the trim for the other half, count times."""

    kind: ClassVar = "servo"
    number: int
    width_us: int
    count: int
    period_s: float


@dataclass(frozen=True, slots=True)
class SetRelay:
    """Switch a relay, light or horn."""

    kind: ClassVar = "relay"
    number: int
    is_on: bool


@dataclass(frozen=True, slots=True)
class SetLights:
    """Switch all lights on or off."""

    kind: ClassVar = "light"
    number: ClassVar = ALL
    is_on: bool


@dataclass(frozen=True, slots=True)
class RepeatRelay:
    """Toggle a relay and toggle it back, half a period each, count times."""

    kind: ClassVar = "relay"
    number: int
    count: int
    period_s: float


@dataclass(frozen=True, slots=True)
class MoveGripper:
    """Close or open a gripper. Number 0: all."""

    kind: ClassVar = "gripper"
    number: int
    closes: bool


class WinchMotion(IntEnum):
    """What a winch can do, with the numbers of MAVLink's WINCH_ACTIONS."""

    RELAX = 0
    LENGTH = 1
    RATE = 2
    LOCK = 3
    HOLD = 5
    RETRACT = 6


@dataclass(frozen=True, slots=True)
class MoveWinch:
    """Move a winch. Length and rate are positive for line going out. Number 0: all.

    rate_m_s of a length is without a sign; 0: the winch's own.
    """

    kind: ClassVar = "winch"
    number: int
    motion: WinchMotion
    length_m: float = 0.0
    rate_m_s: float = 0.0


@dataclass(frozen=True, slots=True)
class RunCommand:
    """Start a configured command of the owner's."""

    kind: ClassVar = "command"
    number: int


@dataclass(frozen=True, slots=True)
class StartCapture:
    """Take images, count in all; count 0: until stopped."""

    count: int = 1
    interval_s: float = 0.0


@dataclass(frozen=True, slots=True)
class StopCapture:
    """Take no more images."""


@dataclass(frozen=True, slots=True)
class CaptureByDistance:
    """Take an image each time the boat has moved this far; 0 stops that. now: take one at once."""

    distance_m: float
    now: bool = False


# kind: the payload's, by its noun in messages; number: of the payload
UnitAction = (
    SetServo | RepeatServo | SetRelay | SetLights | RepeatRelay | MoveGripper | MoveWinch | RunCommand
)
CameraAction = StartCapture | StopCapture | CaptureByDistance
PayloadAction = UnitAction | CameraAction
