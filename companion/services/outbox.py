"""Outgoing messages of the services. The endpoint empties it after every message and tick."""

from collections.abc import Callable
from typing import NamedTuple

from companion.mavlink.address import Address
from companion.mavlink.dialect import Message

_UNLIMITED_BYTES = 1 << 30


class Origin(NamedTuple):
    """Source of a message: channel and sender."""

    channel: int
    address: Address


class Outgoing(NamedTuple):
    """A message and its channel; None: all channels. component: its sender; 0: the autopilot."""

    message: Message
    channel: int | None
    component: int = 0


class Outbox:
    """Outgoing messages, oldest first."""

    def __init__(self) -> None:
        self._queue: list[Outgoing] = []
        self._bulk_bytes: dict[int, int] = {}  # by channel, since the last `drain`
        self.room: Callable[[int], int] = lambda _: _UNLIMITED_BYTES
        """Bytes of bulk data that a channel can take now; set by the owner."""

    @property
    def is_empty(self) -> bool:
        return not self._queue

    def send(self, channel: int, message: Message, component: int = 0) -> None:
        self._queue.append(Outgoing(message, channel, component))

    def broadcast(self, message: Message, component: int = 0) -> None:
        self._queue.append(Outgoing(message, None, component))

    def has_room(self, channel: int) -> bool:
        return self._bulk_bytes.get(channel, 0) < self.room(channel)

    def is_unlimited(self, channel: int) -> bool:
        """Whether a channel has no rate limit, and nothing waits for it."""
        return self.room(channel) >= _UNLIMITED_BYTES

    def send_bulk(self, channel: int, message: Message, size_bytes: int) -> None:
        """A part of a list or file; size_bytes: approximate size on the line."""
        self._bulk_bytes[channel] = self._bulk_bytes.get(channel, 0) + size_bytes
        self.send(channel, message)

    def drain(self) -> list[Outgoing]:
        """Remove and return all messages."""
        if self._bulk_bytes:
            self._bulk_bytes = {}
        queue, self._queue = self._queue, []
        return queue
