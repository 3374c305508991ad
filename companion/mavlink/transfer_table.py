"""States, triggers and transition table of a transfer; `transfer.py` has the rules."""

from collections.abc import Mapping
from enum import Enum, auto
from types import MappingProxyType


class TransferState(Enum):
    """State of a transfer."""

    IDLE = auto()
    LISTING = auto()  # receiver: list requested, waiting for the count
    RECEIVING = auto()  # receiver: waiting for the requested item
    STORING = auto()  # receiver: complete, waiting for the owner
    OFFERING = auto()  # sender: count sent, waiting for the first request
    SENDING = auto()  # sender: item sent, waiting for the next request or the end
    SETTLED = auto()  # finished; the partner may not know yet


class TransferTrigger(Enum):
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


_BEGIN = {
    TransferTrigger.ASK: TransferState.LISTING,
    TransferTrigger.COUNT: TransferState.RECEIVING,
    TransferTrigger.EMPTY: TransferState.STORING,
}
_BREAK_OFF = dict.fromkeys(
    (TransferTrigger.REFUSED, TransferTrigger.FAULT, TransferTrigger.EXPIRED), TransferState.SETTLED
)
_OFFERED = {
    TransferTrigger.OFFER: TransferState.OFFERING,
    TransferTrigger.REQUEST: TransferState.SENDING,
    TransferTrigger.ACCEPTED: TransferState.SETTLED,
    **_BREAK_OFF,
}

TRANSITIONS: Mapping[TransferState, Mapping[TransferTrigger, TransferState]] = MappingProxyType(
    {
        TransferState.IDLE: {
            **_BEGIN,
            TransferTrigger.OFFER: TransferState.OFFERING,
            TransferTrigger.ITEM: TransferState.IDLE,  # unsolicited: answered with an error
            TransferTrigger.REQUEST: TransferState.IDLE,
        },
        TransferState.LISTING: {
            TransferTrigger.COUNT: TransferState.RECEIVING,
            TransferTrigger.EMPTY: TransferState.STORING,
            **_BREAK_OFF,
        },
        TransferState.RECEIVING: {
            TransferTrigger.COUNT: TransferState.RECEIVING,  # restarted by the partner
            TransferTrigger.EMPTY: TransferState.STORING,
            TransferTrigger.ITEM: TransferState.RECEIVING,
            TransferTrigger.LAST_ITEM: TransferState.STORING,
            **_BREAK_OFF,
        },
        TransferState.STORING: {TransferTrigger.STORED: TransferState.SETTLED},
        TransferState.OFFERING: _OFFERED,
        TransferState.SENDING: _OFFERED,
        TransferState.SETTLED: {
            **_BEGIN,
            TransferTrigger.OFFER: TransferState.OFFERING,
            TransferTrigger.ITEM: TransferState.SETTLED,  # our answer was lost
            TransferTrigger.REQUEST: TransferState.SETTLED,
            TransferTrigger.EXPIRED: TransferState.IDLE,
        },
    }
)
