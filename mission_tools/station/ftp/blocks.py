"""The blocks of a file as they come: out of order, twice, and with gaps."""

from typing import Final

from companion.mavlink.ftp_frames import DATA_BYTES

WINDOW_BYTES: Final = 160 * 1024  # the boat's bursts have 122 kB
_MOST_BLOCKS: Final = 2048  # shorter blocks than usual must not cost more memory


class Blocks:
    """A window of a file that moves on with what is taken.

    done: bytes taken so far. end: of the file. high: up to here something has come or was asked for.
    limit: beyond it nothing is kept; `open` moves it.
    """

    def __init__(self, end: int, done: int = 0) -> None:
        self.done = self.high = done
        self.end = end
        self.limit = done
        self._blocks: dict[int, bytes] = {}

    @property
    def is_full(self) -> bool:
        """Whether what is missing are gaps only."""
        return self.high >= min(self.end, self.limit)

    def open(self) -> None:
        """Keep what comes from here on, up to WINDOW_BYTES."""
        self.limit = self.done + WINDOW_BYTES

    def put(self, offset: int, data: bytes) -> bool:
        """Keep a block; returns whether it is new and inside the window."""
        data = data[: max(min(self.end, self.limit) - offset, 0)]
        if not data or offset < self.done or offset in self._blocks or len(self._blocks) >= _MOST_BLOCKS:
            return False
        self._blocks[offset] = data
        self.high = max(self.high, offset + len(data))
        return True

    def take(self) -> bytes:
        """All that follows on what was taken before, without a gap."""
        parts: list[bytes] = []
        while (block := self._blocks.pop(self.done, None)) is not None:
            parts.append(block)
            self.done += len(block)
        return b"".join(parts)

    def cut(self, end: int) -> None:
        """The file ends here."""
        self.end = max(min(self.end, end), self.done)
        self.high = min(self.high, self.end)
        self._blocks = {at: block for at, block in self._blocks.items() if at + len(block) <= self.end}

    def gaps(self) -> list[tuple[int, int]]:
        """Offsets and sizes of what is missing below `high`, in blocks that fit a reply.

        Blocks that overlap a gap's end are dropped, as they would not follow on it.
        """
        gaps: list[tuple[int, int]] = []
        at = self.done
        for offset in sorted(self._blocks):
            if offset < at:
                del self._blocks[offset]
                continue
            gaps += _pieces(at, offset)
            at = offset + len(self._blocks[offset])
        return gaps + _pieces(at, self.high)


def _pieces(begin: int, end: int) -> list[tuple[int, int]]:
    return [(at, min(DATA_BYTES, end - at)) for at in range(begin, end, DATA_BYTES)]
