"""States, triggers and transition table of a transfer; `transfer.py` has the rules."""

from collections.abc import Mapping
from enum import Enum, auto
from types import MappingProxyType


class State(Enum):
    """State of a transfer."""

    IDLE = auto()
    LISTING = auto()  # receiver: list requested, waiting for the count
    RECEIVING = auto()  # receiver: waiting for the requested item
    STORING = auto()  # receiver: complete, waiting for the owner
    OFFERING = auto()  # sender: count sent, waiting for the first request
    SENDING = auto()  # sender: item sent, waiting for the next request or the end
    SETTLED = auto()  # finished; the partner may not know yet


class Trigger(Enum):
    """Events."""

    ASK = auto()  # the owner requests a list
    OFFER = auto()  # the owner, or MISSION_REQUEST_LIST, offers a list
    STORED = auto()  # the owner confirms
    COUNT = auto()  # of one item or more
    EMPTY = auto()  # a count of zero, or MISSION_CLEAR_ALL
    ITEM = auto()
    LAST_ITEM = auto()
    REQUEST = auto()
    ACCEPTED = auto()
    REFUSED = auto()  # MISSION_ACK with an error
    FAULT = auto()  # we end it
    EXPIRED = auto()  # retries, or the time to remember, are used up


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
            Trigger.ITEM: State.IDLE,  # unsolicited: answered with an error
            Trigger.REQUEST: State.IDLE,
        },
        State.LISTING: {
            Trigger.COUNT: State.RECEIVING,
            Trigger.EMPTY: State.STORING,
            **_BREAK_OFF,
        },
        State.RECEIVING: {
            Trigger.COUNT: State.RECEIVING,  # restarted by the partner
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
