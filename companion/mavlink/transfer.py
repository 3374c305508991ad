"""The mission transfer protocol: common part of `Sender` and `Receiver`.

Theory of operation
-------------------
A sender transfers a list (mission, fence or rally) to a receiver, which requests each item:

    sender                      receiver
                   ◄─ MISSION_REQUEST_LIST   only if the receiver starts, as in a download
    MISSION_COUNT ─►
                   ◄─ MISSION_REQUEST_INT 0
    ITEM_INT 0 ───►
                   ◄─ MISSION_REQUEST_INT 1, and so on
                   ◄─ MISSION_ACK

A boat receives uploads and sends downloads, a station the reverse, with the same machines.

- Each side repeats its last message after `retry_s` without an answer, `retries` times, then gives up. Only
  progress (a new item, or a request for a new item) resets the count. A receiver repeats less often where
  round trips are long (`repeat_interval.py`).
- Input is untrusted. A message is processed only if it addresses our system and component and has our mission
  type. A transfer has one partner; another station that starts meanwhile gets MAV_MISSION_DENIED ("not
  accepting any mission commands from this communication partner").
- A MISSION_ACK that is not ACCEPTED ends a transfer on either side. Errors are final (MAVLink guide,
  "Errors/Completion"); repeated and skipped items are not errors.
- Transfers are atomic: a receiver delivers the complete list as `Completed`, and stays in STORING until its
  owner confirms that the list is stored. Only then it sends ACCEPTED. A sender ignores an ACCEPTED that comes
  before every item was requested: it belongs to an earlier transfer.
- MAVLink does not number transfers. An item that the network duplicates and delivers into a later transfer of
  the same partner is not recognised; only reading the list back shows it.
- The last MISSION_ACK may be lost. A finished machine is SETTLED for a while: it remembers its partner and
  repeats its answer to a repeated last message. Common stations do not repeat theirs (QGroundControl gives up
  after 1.5 s, MAVSDK after 2.5 s). If the line has lost a message in this transfer, a receiver repeats its
  MISSION_ACK twice, half a second apart, unless the partner's next message shows that it arrived. On a good
  line it does not: a station that starts again at once could take it for the next transfer's.

The machines do no I/O and read no clock: `handle`, `tick`, `take_outbox`, `take_events`. A message
without a row in the table is counted as `ignored`; a call without one raises LocalProtocolError.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum, auto
from types import MappingProxyType

from companion.core.errors import LocalProtocolError
from companion.mavlink.address import Address, is_named
from companion.mavlink.dialect import Message, dialect
from companion.mavlink.items import ItemFault, MissionItem, MissionResult, MissionType

NOBODY = Address(0, 0)
MOST_ITEMS = 65535  # MISSION_COUNT counts in 16 bits


class TransferState(Enum):
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
            TransferTrigger.REQUEST: TransferState.SETTLED,
            TransferTrigger.EXPIRED: TransferState.IDLE,
        },
    }
)


@dataclass(frozen=True, slots=True)
class Started:
    """A transfer of `count` items has started."""

    count: int
    partner: Address


@dataclass(frozen=True, slots=True)
class Completed:
    """The list is complete: at a receiver, to be stored and confirmed; at a sender, acknowledged.

    first: position of a partial list; None for a whole one.
    """

    items: tuple[MissionItem, ...]
    partner: Address
    first: int | None = None


class FailureCause(Enum):
    """What has ended a transfer."""

    FAULT = "the partner's messages do not fit"
    REFUSED = "the partner does not take or give the list"
    SILENT = "the partner does not answer: its list may be the old or the new one"
    CANCELLED = "our own side has ended it"


@dataclass(frozen=True, slots=True)
class Failed:
    """The transfer has failed; without effect unless SILENT. text: one sentence for the operator."""

    result: MissionResult
    text: str
    partner: Address
    cause: FailureCause = FailureCause.FAULT


Event = Started | Completed | Failed


@dataclass(eq=False)
class Transfer:
    """Common part of both machines: partner, retries, outbox and events.

    retry_s: time-out of an answer. retries: number of repetitions. max_items: per list.
    """

    own: Address
    mission_type: MissionType
    retry_s: float = 0.5
    retries: int = 10
    max_items: int = MOST_ITEMS
    ignored: int = field(default=0, init=False)
    state: TransferState = field(default=TransferState.IDLE, init=False)
    _retries_left: int = field(default=0, init=False)
    _deadline_s: float = field(default=0.0, init=False)
    _awaited_s: float = field(default=0.0, init=False)  # when the latest message was first sent
    _partner: Address = field(default=NOBODY, init=False)
    _latest: Message | None = field(default=None, init=False)  # repeated until answered
    _outbox: list[Message] = field(default_factory=list, init=False)
    _events: list[Event] = field(default_factory=list, init=False)

    @property
    def is_idle(self) -> bool:
        """Whether `tick` has nothing to do."""
        return self.state is TransferState.IDLE

    @property
    def partner(self) -> Address | None:
        """The partner of a transfer in progress, or None."""
        return None if self.state in (TransferState.IDLE, TransferState.SETTLED) else self._partner

    def tick(self, now_s: float) -> None:
        """Repeat unanswered messages, give up after the last retry."""
        if self.state in (TransferState.IDLE, TransferState.STORING) or now_s < self._deadline_s:
            return
        if self.state is TransferState.SETTLED:
            self._move(TransferTrigger.EXPIRED)
            self._partner = NOBODY
        elif self._retries_left == 0:
            self._expire(now_s)
        else:
            self._retries_left -= 1
            self._deadline_s = now_s + self._interval_s
            self._remind()

    @property
    def _interval_s(self) -> float:
        """Until the last message is repeated."""
        return self.retry_s

    def cancel(self, now_s: float) -> None:
        """Cancel a transfer in progress and tell the partner."""
        if TransferTrigger.FAULT in TRANSITIONS[self.state]:
            fault = ItemFault(MissionResult.OPERATION_CANCELLED, "cancelled")
            self._fail(fault, self._partner, now_s, cause=FailureCause.CANCELLED)

    def take_outbox(self) -> list[Message]:
        """The messages to send, in order, with their targets."""
        outbox, self._outbox = self._outbox, []
        return outbox

    def take_events(self) -> list[Event]:
        """The events since the last call, in order."""
        events, self._events = self._events, []
        return events

    def _move(self, trigger: TransferTrigger) -> None:
        """Follow a row of the table.
        Raises LocalProtocolError: there is none: our own error, as messages are checked before.
        """
        try:
            self.state = TRANSITIONS[self.state][trigger]
        except KeyError:
            raise LocalProtocolError(
                f"{trigger.name} is not possible in a {self.mission_type.name} transfer: {self.state.name}"
            ) from None

    def _may(self, trigger: TransferTrigger) -> bool:
        """Whether a message has a row; counted if not."""
        possible = trigger in TRANSITIONS[self.state]
        self.ignored += not possible
        return possible

    def _is_ours(self, message: Message, sender: Address) -> bool:
        """Whether a message is for us and our list, with a valid sender."""
        return (
            message.mission_type == self.mission_type
            and is_named(self.own, message.target_system, message.target_component)
            and sender.system != NOBODY.system
        )

    def _is_free_for(self, sender: Address) -> bool:
        """Whether this station may start; another than the partner is refused."""
        if self.partner in (None, sender):
            return True
        self.ignored += 1
        self._acknowledge(sender, MissionResult.DENIED)
        return False

    def _begin(self, trigger: TransferTrigger, partner: Address) -> None:
        self._move(trigger)
        self._partner = partner

    def _await(self, message: Message, now_s: float) -> None:
        """Send a message that expects an answer, with all retries."""
        self._retries_left = self.retries
        self._awaited_s, self._deadline_s = now_s, now_s + self._interval_s
        self._latest = message
        self._outbox.append(message)

    def _remind(self) -> None:
        """No answer within the time-out."""
        self._repeat()

    def _repeat(self) -> None:
        if self._latest is not None:
            self._outbox.append(self._latest)

    def _acknowledge(self, partner: Address, result: MissionResult) -> Message:
        message: Message = dialect.MAVLink_mission_ack_message(*partner, result, self.mission_type)
        self._outbox.append(message)
        return message

    def _settle(self, trigger: TransferTrigger, latest: Message | None, now_s: float) -> None:
        """End the transfer, and keep the last message for repeated requests."""
        self._move(trigger)
        self._latest = latest
        self._deadline_s = now_s + self.retry_s * (self.retries + 1)

    def _fail(
        self,
        fault: ItemFault,
        partner: Address,
        now_s: float,
        trigger: TransferTrigger = TransferTrigger.FAULT,
        cause: FailureCause = FailureCause.FAULT,
    ) -> None:
        """End or refuse the transfer, and tell the partner."""
        answer = self._acknowledge(partner, fault.result)
        if self.partner is not None:
            self._settle(trigger, answer, now_s)
        self._events.append(Failed(fault.result, fault.text, partner, cause))

    def _expire(self, now_s: float) -> None:
        waited_s = now_s - self._awaited_s
        text = f"no answer from {self._partner.system}/{self._partner.component} for {waited_s:.1f} s"
        fault = ItemFault(MissionResult.OPERATION_CANCELLED, text)
        self._fail(fault, self._partner, now_s, TransferTrigger.EXPIRED, FailureCause.SILENT)

    def _handle_refusal(self, result: MissionResult, sender: Address, now_s: float) -> None:
        """The partner has ended the transfer."""
        if self._may(TransferTrigger.REFUSED):
            self._settle(TransferTrigger.REFUSED, None, now_s)
            text = f"the other side answered {result.name}"
            self._events.append(Failed(result, text, sender, FailureCause.REFUSED))
