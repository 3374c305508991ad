"""The states of a recovery, what changes them, and the one table of their transitions."""

from collections.abc import Mapping
from enum import Enum, auto
from types import MappingProxyType


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
