"""What services send, to one channel or to all. The endpoint empties it after every message and tick."""

from collections.abc import Callable
from typing import NamedTuple

from companion.mavlink.address import Address
from companion.mavlink.dialect import Message

_UNLIMITED_BYTES = 1 << 30


class Origin(NamedTuple):
    """Where a message came from: the channel it came in on, and who sent it."""

    channel: int
    address: Address


class Outgoing(NamedTuple):
    """A message and the channel it leaves by; None: by every channel."""

    message: Message
    channel: int | None


class Outbox:
    """Messages on their way out, oldest first."""

    def __init__(self) -> None:
        self._queue: list[Outgoing] = []
        self._bulk_bytes: dict[int, int] = {}  # by channel, since the box was last emptied
        self.room: Callable[[int], int] = lambda _: _UNLIMITED_BYTES
        """How many bytes of lists and files a channel takes at the moment; the links' to say."""

    @property
    def is_empty(self) -> bool:
        """Whether there is nothing to take."""
        return not self._queue

    def send(self, channel: int, message: Message) -> None:
        """To whoever listens on one channel."""
        self._queue.append(Outgoing(message, channel))

    def broadcast(self, message: Message) -> None:
        """To everyone."""
        self._queue.append(Outgoing(message, None))

    def has_room(self, channel: int) -> bool:
        """Whether a channel takes more of a list or file; what has to go out at once need not ask."""
        return self._bulk_bytes.get(channel, 0) < self.room(channel)

    def send_bulk(self, channel: int, message: Message, size_bytes: int) -> None:
        """A part of a list or file; size_bytes is about what it takes on the line."""
        self._bulk_bytes[channel] = self._bulk_bytes.get(channel, 0) + size_bytes
        self.send(channel, message)

    def drain(self) -> list[Outgoing]:
        """Empty the box."""
        if self._bulk_bytes:
            self._bulk_bytes = {}
        queue, self._queue = self._queue, []
        return queue
