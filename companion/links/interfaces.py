"""What the boat and its stations ask of a link and its port. A module of its own: a station needs no more."""

from typing import Protocol, runtime_checkable


@runtime_checkable
class Closable(Protocol):
    """A link, port or part to release."""

    def close(self) -> None:
        """Release it. May be called twice."""


class Link(Closable, Protocol):
    """A byte pipe to one station or radio. Never blocks, never raises once open.

    A datagram link returns whole datagrams, a stream link any chunks.
    """

    @property
    def name(self) -> str:
        """For logs, such as `tcp:127.0.0.1:52114`."""

    @property
    def host(self) -> str:
        """Numeric address of the far side, empty if there is none (serial line, memory)."""

    @property
    def is_datagram(self) -> bool:
        """Whether a received chunk is a datagram."""

    @property
    def is_closed(self) -> bool:
        """True once the far side is gone for good; the boat then removes the link."""

    def receive(self) -> list[bytes]:
        """All received chunks, oldest first; may be empty."""

    def send(self, data: bytes) -> bool:
        """Send a frame whole, or drop it whole and return False (queue full, no peer)."""

    def fileno(self) -> int:
        """A descriptor to wait on for received bytes, −1 without one."""


class Port(Closable, Protocol):
    """A source of links: a listening socket, or a device. Closing closes its links too."""

    @property
    def name(self) -> str:
        """As in the configuration, such as `tcpin:0.0.0.0:5760`."""

    def accept(self) -> list[Link]:
        """New links since the last call. Never blocks, never raises."""

    def fileno(self) -> int:
        """A descriptor to wait on for new links, −1 without one."""
