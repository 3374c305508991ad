"""A transfer's states, what moves it, and the one table of its transitions; `transfer.py` has the rules."""

from collections.abc import Mapping
from enum import Enum, auto
from types import MappingProxyType


class State(Enum):
    """Where a transfer stands."""

    IDLE = auto()
    LISTING = auto()  # receiver: has asked for the list, waits for its count
    RECEIVING = auto()  # receiver: waits for the item asked for
    STORING = auto()  # receiver: has all, waits for its owner
    OFFERING = auto()  # sender: has sent the count, waits for the first request
    SENDING = auto()  # sender: has sent an item, waits for the next request or the end
    SETTLED = auto()  # it is over; the partner may not know yet


class Trigger(Enum):
    """What moves it."""

    ASK = auto()  # our owner asks for a list
    OFFER = auto()  # our owner, or the partner's MISSION_REQUEST_LIST, has us offer one
    STORED = auto()  # our owner confirms
    COUNT = auto()  # of one item or more
    EMPTY = auto()  # a count of none, or MISSION_CLEAR_ALL
    ITEM = auto()
    LAST_ITEM = auto()
    REQUEST = auto()
    ACCEPTED = auto()
    REFUSED = auto()  # the partner's MISSION_ACK with an error, or its cancel
    FAULT = auto()  # we end it
    EXPIRED = auto()  # the retries, or the time to remember, are used up


_BEGIN = {Trigger.ASK: State.LISTING, Trigger.COUNT: State.RECEIVING, Trigger.EMPTY: State.STORING}
_BREAK_OFF = dict.fromkeys((Trigger.REFUSED, Trigger.FAULT, Trigger.EXPIRED), State.SETTLED)
_OFFERED = {
    Trigger.OFFER: State.OFFERING,
    Trigger.REQUEST: State.SENDING,
    Trigger.ACCEPTED: State.SETTLED,
    **_BREAK_OFF,
}

TRANSITIONS: Mapping[State, Mapping[Trigger, State]] = MappingProxyType(
    {
        State.IDLE: {
            **_BEGIN,
            Trigger.OFFER: State.OFFERING,
            Trigger.ITEM: State.IDLE,  # out of the blue: answered with an error
            Trigger.REQUEST: State.IDLE,
        },
        State.LISTING: {
            Trigger.COUNT: State.RECEIVING,
            Trigger.EMPTY: State.STORING,
            **_BREAK_OFF,
        },
        State.RECEIVING: {
            Trigger.COUNT: State.RECEIVING,  # the partner begins again
            Trigger.EMPTY: State.STORING,
            Trigger.ITEM: State.RECEIVING,
            Trigger.LAST_ITEM: State.STORING,
            **_BREAK_OFF,
        },
        State.STORING: {Trigger.STORED: State.SETTLED},
        State.OFFERING: _OFFERED,
        State.SENDING: _OFFERED,
        State.SETTLED: {
            **_BEGIN,
            Trigger.OFFER: State.OFFERING,
            Trigger.ITEM: State.SETTLED,  # our answer was lost
            Trigger.REQUEST: State.SETTLED,
            Trigger.EXPIRED: State.IDLE,
        },
    }
)
