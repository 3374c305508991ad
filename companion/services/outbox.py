"""What services send, to one channel or to all. The endpoint empties it after every message and tick."""

from typing import NamedTuple

from companion.mavlink.address import Address
from companion.mavlink.dialect import Message


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

    def send(self, channel: int, message: Message) -> None:
        """To whoever listens on one channel."""
        self._queue.append(Outgoing(message, channel))

    def broadcast(self, message: Message) -> None:
        """To everyone."""
        self._queue.append(Outgoing(message, None))

    def take(self) -> list[Outgoing]:
        """Empty the box."""
        queue, self._queue = self._queue, []
        return queue
