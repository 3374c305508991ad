"""What a failsafe can do, and the decisions that it comes down to; the vehicle carries these out."""

from enum import IntEnum
from typing import Final, NamedTuple

from companion.core.modes import Mode
from companion.failsafe.recovery.transition_table import Trigger


class Action(IntEnum):
    """ArduPilot Rover's FS_ACTION numbers, and three of the boat's own."""

    NONE = 0
    RTL = 1
    HOLD = 2
    SMART_RTL_OR_RTL = 3
    SMART_RTL_OR_HOLD = 4
    DISARM = 5
    LOITER_OR_HOLD = 6
    CLEAR_PROPELLERS = 7
    CHECK_MOTORS = 8
    UNGROUND = 9


MODES: Final[dict[Action, tuple[Mode, ...]]] = {
    Action.RTL: (Mode.RTL, Mode.LOITER),
    Action.HOLD: (),
    Action.SMART_RTL_OR_RTL: (Mode.SMART_RTL, Mode.RTL, Mode.LOITER),
    Action.SMART_RTL_OR_HOLD: (Mode.SMART_RTL,),
    Action.LOITER_OR_HOLD: (Mode.LOITER,),
}
"""The modes of an action: the first that can be entered, else HOLD, in which the boat drifts."""

RECOVERIES: Final[dict[Action, tuple[Trigger, str]]] = {
    Action.CLEAR_PROPELLERS: (Trigger.CLEAR, "Clearing the propellers"),
    Action.CHECK_MOTORS: (Trigger.CHECK, "Checking the motors"),
    Action.UNGROUND: (Trigger.UNGROUND, ""),
}
"""The recovery of an action, and what the operator is told. The mode goes on afterwards."""


class Notify(NamedTuple):
    """Tell the operator."""

    severity: int
    text: str


class StopMotors(NamedTuple):
    """Motors off."""


class Retreat(NamedTuple):
    """Enter the first of these modes that can be entered, else HOLD."""

    modes: tuple[Mode, ...]


class LimitSpeed(NamedTuple):
    """Sail no faster than this share of cruise speed."""

    share: float


class Recover(NamedTuple):
    """Start a recovery manoeuvre."""

    trigger: Trigger
    severity: int
    text: str


class AssumeFailed(NamedTuple):
    """Sail on with one motor."""

    is_left: bool


Decision = Notify | StopMotors | Retreat | LimitSpeed | Recover | AssumeFailed
