"""Links within the process, for lockstep runs and tests."""

from collections import deque

from companion.links.interfaces import Link

_QUEUE_FRAMES = 4096


class MemoryLink:
    """One end of a pair. Chunks sent at one end are received at the other, in order.

    A full end drops further chunks, like a UDP socket. Closing one end closes the other once it is drained.
    """

    def __init__(
        self, name: str, is_datagram: bool = True, queue_frames: int = _QUEUE_FRAMES, host: str = ""
    ) -> None:
        self.name = name
        self.host = host
        self.is_datagram = is_datagram
        self._queue_frames = queue_frames
        self._arrived: deque[bytes] = deque()
        self._peer: MemoryLink | None = None
        self._has_ended = False
        self._is_closed = False

    @property
    def is_closed(self) -> bool:
        """True once either end was closed and nothing is left to receive."""
        return self._is_closed or (self._has_ended and not self._arrived)

    def receive(self) -> list[bytes]:
        """Chunks sent by the other end since the last call."""
        if not self._arrived:
            return []
        chunks = list(self._arrived)
        self._arrived.clear()
        return chunks

    def send(self, data: bytes) -> bool:
        """Send a frame to the other end; False if that is closed or full."""
        peer = self._peer
        if peer is None or peer._is_closed or self._is_closed or len(peer._arrived) >= peer._queue_frames:
            return False
        peer._arrived.append(bytes(data))
        return True

    def fileno(self) -> int:
        """−1: nothing to wait on."""
        return -1

    def close(self) -> None:
        """Close this end and, once drained, the other. May be called twice."""
        self._is_closed = True
        self._arrived.clear()
        if self._peer is not None:
            self._peer._has_ended = True


def memory_pair(
    name: str = "memory", is_datagram: bool = True, queue_frames: int = _QUEUE_FRAMES, host: str = ""
) -> tuple[MemoryLink, MemoryLink]:
    """Two connected ends. host: reported by the near end as the far address."""
    near = MemoryLink(f"{name}:a", is_datagram, queue_frames, host)
    far = MemoryLink(f"{name}:b", is_datagram, queue_frames)
    near._peer, far._peer = far, near
    return near, far


class MemoryPort:
    """Satisfies `companion.links.interfaces.Port` for links added with `offer`."""

    def __init__(self, *links: Link, name: str = "memory") -> None:
        self.name = name
        self._is_closed = False
        self._offered: list[Link] = list(links)
        self._links: list[Link] = []

    def offer(self, link: Link) -> None:
        """Add a link for the next `accept`; a closed port closes it."""
        if self._is_closed:
            link.close()
        else:
            self._offered.append(link)

    def accept(self) -> list[Link]:
        """Links added since the last call."""
        fresh, self._offered = self._offered, []
        self._links += fresh
        return fresh

    def fileno(self) -> int:
        """−1: nothing to wait on."""
        return -1

    def close(self) -> None:
        self._is_closed = True
        for link in (*self._links, *self._offered):
            link.close()
