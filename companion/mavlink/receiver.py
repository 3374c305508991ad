"""Receiver of a mission transfer: the boat in an upload, a station in a download."""

from collections.abc import Callable
from dataclasses import dataclass, field

from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, dialect
from companion.mavlink.items import ItemFault, MissionItem, MissionResult
from companion.mavlink.repeat_interval import RepeatInterval
from companion.mavlink.transfer import (
    NOBODY,
    Completed,
    Started,
    Transfer,
    TransferState,
    TransferTrigger,
)

AGAIN_S = 0.5  # between repetitions of the last message
REPETITIONS = 2  # within QGroundControl's time-out of 1.5 s


@dataclass(eq=False)
class Receiver(Transfer):
    """Requests each item, and returns the complete list as `Completed`.

    check: checks each item on arrival; an ItemFault ends the transfer with its result. The owner answers
    `Completed` with `confirm` once the list is stored.
    """

    check: Callable[[int, MissionItem], ItemFault | None] | None = None
    first: int = field(default=0, init=False)  # sequence number of the first item: 0 unless a partial list
    _is_part: bool = field(default=False, init=False)
    _count: int = field(default=0, init=False)
    _items: list[MissionItem] = field(default_factory=list, init=False)
    _nudged_s: float = field(default=float("-inf"), init=False)
    _has_lost: bool = field(default=False, init=False)  # a message of this transfer was repeated
    _is_repeated: bool = field(default=False, init=False)  # so was the last one
    _repetitions: int = field(default=0, init=False)  # of the last message, remaining
    _again_s: float = field(default=0.0, init=False)

    def __post_init__(self) -> None:
        self._interval = RepeatInterval(self.retry_s)

    def request_list(self, partner: Address, now_s: float) -> None:
        """Request a partner's list. Raises LocalProtocolError: a transfer is in progress."""
        self._begin(TransferTrigger.ASK, partner)
        self._interval = RepeatInterval(self.retry_s)
        request = dialect.MAVLink_mission_request_list_message(*partner, self.mission_type)
        self._await(request, now_s)

    def take_part(self, first: int, count: int, sender: Address, now_s: float) -> None:
        """A station sends a checked MISSION_WRITE_PARTIAL_LIST."""
        if not self._is_free_for(sender) or not self._may(TransferTrigger.COUNT):
            return
        is_same = (first, count) == (self.first, self._count) and not self._items
        if self.state is TransferState.RECEIVING and is_same:
            self._repeat()
            return
        self._collect(first, count, sender, now_s, is_part=True)

    def _collect(self, first: int, count: int, sender: Address, now_s: float, *, is_part: bool) -> None:
        if self.state is TransferState.LISTING:
            self._measure(now_s)
        else:
            self._interval = RepeatInterval(self.retry_s)
        self._begin(TransferTrigger.COUNT if count else TransferTrigger.EMPTY, sender)
        self.first, self._is_part = first, is_part
        self._count, self._items, self._has_lost = count, [], False
        self._events.append(Started(count, sender))
        if count:
            self._request_next(sender, now_s)
        else:
            self._events.append(Completed((), sender))

    def confirm(self, now_s: float, result: MissionResult = MissionResult.ACCEPTED) -> None:
        """Answer to `Completed`: the list is stored, or `result` says why not.
        Raises LocalProtocolError: nothing to confirm.
        """
        self._settle(TransferTrigger.STORED, None, now_s)
        self._latest = self._acknowledge(self._partner, result)
        self._repetitions = REPETITIONS if self._has_lost else 0
        self._again_s = now_s + AGAIN_S

    def rest(self, sender: Address) -> None:
        """Another message of the partner: it has received our last message."""
        if sender == self._partner:
            self._repetitions = 0

    def tick(self, now_s: float) -> None:
        """Repeat unanswered messages and the last message; give up after the last retry."""
        if self._repetitions and now_s >= self._again_s and self.state is TransferState.SETTLED:
            self._repetitions -= 1
            self._again_s = now_s + AGAIN_S
            self._repeat()
        super().tick(now_s)

    def handle(self, message: Message, sender: Address, now_s: float) -> None:
        """Handle a message of the mission protocol; others are ignored."""
        name = message.get_type()
        if name not in _RECEIVED or not self._is_ours(message, sender):
            return
        self.rest(sender)
        if name == "MISSION_COUNT":
            self._handle_count(message.count, sender, now_s)
        elif name == "MISSION_CLEAR_ALL":
            self._handle_count(0, sender, now_s)
        elif self._partner not in (NOBODY, sender):
            self.ignored += 1
        elif name == "MISSION_ACK":
            self._handle_ack(message, sender, now_s)
        else:
            self._handle_item(message, sender, now_s)

    def _handle_count(self, count: int, sender: Address, now_s: float) -> None:
        trigger = TransferTrigger.COUNT if count else TransferTrigger.EMPTY
        if not self._is_free_for(sender) or not self._may(trigger):
            return
        if count > self.max_items:
            text = f"{count} items offered, there is room for {self.max_items}"
            self._fail(ItemFault(MissionResult.NO_SPACE, text), sender, now_s)
            return
        is_same = count == self._count and not self._items and not self._is_part
        if self.state is TransferState.RECEIVING and is_same:
            self._repeat()  # repeated offer: our first request was lost
            return
        self._collect(0, count, sender, now_s, is_part=False)

    def _handle_ack(self, message: Message, sender: Address, now_s: float) -> None:
        if message.type == MissionResult.ACCEPTED:
            self.ignored += 1  # invalid from a sender
        else:
            self._handle_refusal(MissionResult(message.type), sender, now_s)

    def _handle_item(self, message: Message, sender: Address, now_s: float) -> None:
        is_listed = message.current <= 1  # else ArduPilot's go-to and altitude items
        if is_listed and self.state is TransferState.RECEIVING:
            self._receive_item(message, sender, now_s)
            return
        if is_listed and self.state is TransferState.SETTLED:
            if message.seq == self.first + min(len(self._items), self._count - 1):
                self._repeat()
                return  # else it was delayed: no answer needed
        elif is_listed and self.state is TransferState.IDLE:
            self._acknowledge(sender, MissionResult.ERROR)
        self.ignored += 1

    def _receive_item(self, message: Message, sender: Address, now_s: float) -> None:
        expected = self.first + len(self._items)
        if message.seq != expected:
            self.ignored += 1
            if message.seq > expected and now_s - self._nudged_s >= self.retry_s:
                self._nudged_s = now_s
                self._repeat()
            return
        item = MissionItem.from_message(message)
        fault = item if isinstance(item, ItemFault) else self.check and self.check(expected, item)
        if fault is not None:
            self._fail(ItemFault(fault.result, f"item {expected}: {fault.text}"), sender, now_s)
        elif isinstance(item, MissionItem):
            self._measure(now_s)
            self._items.append(item)
            if len(self._items) == self._count:
                self._move(TransferTrigger.LAST_ITEM)
                first = self.first if self._is_part else None
                self._events.append(Completed(tuple(self._items), sender, first))
            else:
                self._move(TransferTrigger.ITEM)
                self._request_next(sender, now_s)

    @property
    def _interval_s(self) -> float:
        return self._interval.seconds

    def _await(self, message: Message, now_s: float) -> None:
        self._is_repeated = False
        super()._await(message, now_s)

    def _measure(self, now_s: float) -> None:
        if self._is_repeated:
            self._interval.lengthen()
        else:
            self._interval.measure(now_s - self._awaited_s)

    def _repeat(self) -> None:
        self._has_lost = self._is_repeated = True
        super()._repeat()

    def _request_next(self, partner: Address, now_s: float) -> None:
        seq = self.first + len(self._items)
        request = dialect.MAVLink_mission_request_int_message(*partner, seq, self.mission_type)
        self._await(request, now_s)


_RECEIVED = frozenset(
    ("MISSION_COUNT", "MISSION_CLEAR_ALL", "MISSION_ACK", "MISSION_ITEM", "MISSION_ITEM_INT")
)
