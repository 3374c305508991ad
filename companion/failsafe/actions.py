"""What a failsafe can do, and the decisions that it comes down to; the vehicle carries these out."""

from collections.abc import Mapping
from enum import Enum, IntEnum, auto
from types import MappingProxyType
from typing import Final, NamedTuple

from companion.core.modes import Mode


class State(Enum):
    """What runs in place of the mode. The last three are the parts of one manoeuvre, ungrounding."""

    IDLE = auto()  # nothing: the mode steers
    CLEARING = auto()  # pulses astern clear the propellers
    CHECKING = auto()  # each motor is tested alone
    COMPARING = auto()  # each motor drives alone for a moment, and the motors go on being judged
    RESTING = auto()  # ungrounding: motors off between two tries
    PUSHING = auto()  # ungrounding: a try
    STANDING_OFF = auto()  # ungrounding: afloat again, under way to open water


class Trigger(Enum):
    """What changes the state."""

    CLEAR = auto()  # a failsafe asks for clear propellers
    CHECK = auto()  # a failsafe, or the schedule of a failed motor, asks for a motor check
    COMPARE = auto()  # a propeller seems fouled
    UNGROUND = auto()  # a failsafe asks to get off the shore
    RETREAT = auto()  # a failsafe changes the mode, to another than HOLD
    ABORT = auto()  # HOLD, disarming, or the operator's choice of a mode
    DONE = auto()  # the manoeuvre has ended by itself
    RESTED = auto()
    HELD = auto()  # the try makes no way
    FREED = auto()
    CARRIED_BACK = auto()


UNGROUNDING = (State.RESTING, State.PUSHING, State.STANDING_OFF)

_START = {Trigger.CLEAR: State.CLEARING, Trigger.CHECK: State.CHECKING, Trigger.UNGROUND: State.RESTING}
_END = {Trigger.ABORT: State.IDLE, Trigger.DONE: State.IDLE}
# A boat that lies ashore floats first: it neither clears its propellers nor checks its motors, and a
# failsafe's new mode begins once it is off.
_ASHORE = {**_END, Trigger.UNGROUND: State.RESTING, Trigger.FREED: State.STANDING_OFF}

TRANSITIONS: Mapping[State, Mapping[Trigger, State]] = MappingProxyType(
    {
        State.IDLE: {**_START, Trigger.COMPARE: State.COMPARING},
        State.CLEARING: {**_START, **_END, Trigger.RETREAT: State.IDLE},
        State.CHECKING: {**_START, **_END, Trigger.RETREAT: State.IDLE},
        State.COMPARING: {**_START, **_END, Trigger.RETREAT: State.IDLE},
        State.RESTING: {**_ASHORE, Trigger.RESTED: State.PUSHING},
        State.PUSHING: {**_ASHORE, Trigger.HELD: State.RESTING},
        State.STANDING_OFF: {**_END, Trigger.UNGROUND: State.RESTING, Trigger.CARRIED_BACK: State.RESTING},
    }
)
"""A trigger that a state does not list changes nothing."""


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
