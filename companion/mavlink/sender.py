"""Sender of a mission transfer: the boat in a download, a station in an upload."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from companion.core.errors import LocalProtocolError
from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, dialect
from companion.mavlink.items import ItemFault, MissionItem, MissionResult
from companion.mavlink.transfer import (
    Completed,
    Failed,
    FailureCause,
    Started,
    Transfer,
    TransferState,
    TransferTrigger,
)


@dataclass(eq=False)
class Sender(Transfer):
    """Offers a list and answers requests for its items with MISSION_ITEM_INT.

    source: returns the list, called once per MISSION_REQUEST_LIST, so that a download is consistent. Without
    a source only `offer` starts a transfer, as in a station's upload.

    The side that starts a transfer keeps it going: a sender that was asked for its list only waits, as
    stations treat an unsolicited count or item as an error.
    """

    source: Callable[[], Sequence[MissionItem]] | None = None
    _was_asked: bool = field(default=False, init=False)
    _items: tuple[MissionItem, ...] = field(default=(), init=False)
    _unsent: set[int] = field(default_factory=set, init=False)  # not yet requested in this transfer
    _asked: set[int] = field(default_factory=set, init=False)  # requested since the last start at item 0

    def offer(self, items: Sequence[MissionItem], partner: Address, now_s: float) -> None:
        """Start sending a list; restarts a transfer with the same partner. Raises ValueError: more items than
        max_items; LocalProtocolError: a transfer with another partner is in progress.
        """
        if len(items) > self.max_items:
            raise ValueError(f"{len(items)} items are more than the {self.max_items} that can be sent")
        if self.partner not in (None, partner):
            raise LocalProtocolError(f"a transfer with {self.partner} is under way")
        self._was_asked = False
        self._begin(TransferTrigger.OFFER, partner)
        self._items = tuple(items)
        self._unsent, self._asked = set(range(len(items))), set()
        self._events.append(Started(len(items), partner))
        count = dialect.MAVLink_mission_count_message(*partner, len(items), self.mission_type)
        self._await(count, now_s)

    def handle(self, message: Message, sender: Address, now_s: float) -> None:
        """Handle a message of the mission protocol; others are ignored."""
        name = message.get_type()
        if name not in _RECEIVED or not self._is_ours(message, sender):
            return
        if name == "MISSION_REQUEST_LIST":
            self._handle_request_list(sender, now_s)
        elif name == "MISSION_ACK":
            self._handle_ack(message, sender, now_s)
        elif self._is_free_for(sender):
            self._handle_request(message.seq, sender, now_s)

    def _handle_request_list(self, sender: Address, now_s: float) -> None:
        if self.source is None:
            self.ignored += 1
            return
        if self._was_asked and not self._unsent and self.partner not in (None, sender):
            self._expire(now_s)  # not every station acknowledges
        if self._is_free_for(sender):
            if self.state is TransferState.OFFERING:
                self._repeat()  # repeated request: our count was lost
            else:
                self.offer(self.source(), sender, now_s)
                self._was_asked = True

    def _handle_request(self, seq: int, sender: Address, now_s: float) -> None:
        if self.state is TransferState.IDLE or sender != self._partner:
            self.ignored += 1
            self._acknowledge(sender, MissionResult.ERROR)
        elif seq >= len(self._items):
            if self.state is TransferState.SETTLED:
                self.ignored += 1
            else:
                text = f"item {seq} was asked for, the list has {len(self._items)}"
                self._fail(ItemFault(MissionResult.INVALID_SEQUENCE, text), sender, now_s)
        else:
            self._send_item(seq, sender, now_s)

    def _send_item(self, seq: int, partner: Address, now_s: float) -> None:
        """Answer a request. A restart at item 0 is progress, too."""
        item = self._items[seq].to_message(seq, partner, self.mission_type)
        begins_again = seq == 0 and len(self._asked) > 1
        is_progress = seq not in self._asked or begins_again
        if begins_again:
            self._asked.clear()
        self._asked.add(seq)
        self._unsent.discard(seq)
        settled = self.state is TransferState.SETTLED
        self._move(TransferTrigger.REQUEST)
        if (is_progress or self._was_asked) and not settled:  # still alive
            self._await(item, now_s)
        else:
            self._outbox.append(item)

    def _handle_ack(self, message: Message, sender: Address, now_s: float) -> None:
        if sender != self._partner:
            self.ignored += 1
        elif message.type != MissionResult.ACCEPTED:
            self._handle_refusal(MissionResult(message.type), sender, now_s)
        elif self._unsent:
            self.ignored += 1  # answers an earlier transfer
        elif self._may(TransferTrigger.ACCEPTED):
            self._settle(TransferTrigger.ACCEPTED, None, now_s)
            self._events.append(Completed(self._items, sender))

    def _remind(self) -> None:
        if not self._was_asked:
            super()._remind()

    def _expire(self, now_s: float) -> None:
        """No message to a partner that asked for the list or has all items."""
        if self._unsent and not self._was_asked:
            super()._expire(now_s)
            return
        self._settle(TransferTrigger.EXPIRED, None, now_s)
        text = "the partner does not answer" if self._unsent else "all items were sent, but not acknowledged"
        failed = Failed(MissionResult.OPERATION_CANCELLED, text, self._partner, FailureCause.SILENT)
        self._events.append(failed)


_RECEIVED = frozenset(("MISSION_REQUEST_LIST", "MISSION_REQUEST_INT", "MISSION_REQUEST", "MISSION_ACK"))
