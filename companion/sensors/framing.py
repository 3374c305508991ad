"""Framing of the parts' serial protocols: bytes to frames. Pure; never raises."""

from abc import ABC, abstractmethod


class FrameReader(ABC):
    """Splits a byte stream into frames. Each protocol defines size and checksum.

    After a bad frame, the search continues at its second byte. At most one frame is buffered. skipped: count
    of bytes outside of good frames.
    """

    def __init__(self) -> None:
        self.skipped = 0
        self._held = b""

    def split(self, data: bytes) -> list[bytes]:
        """The whole frames; a partial one is kept."""
        held, at, frames = self._held + data, 0, list[bytes]()
        while at < len(held):
            size = self._size(held, at)
            if size and at + size > len(held):
                break
            if size and self._is_whole(frame := held[at : at + size]):
                frames.append(frame)
                at += size
            else:
                self.skipped += 1
                at += 1
        self._held = held[at:]
        return frames

    def forget(self) -> None:
        """Drop a partial frame: the line was interrupted."""
        self._held = b""

    @abstractmethod
    def _size(self, held: bytes, at: int) -> int:
        """Length of the frame that may start here, or of what decides it; 0 if none starts here."""

    @abstractmethod
    def _is_whole(self, frame: bytes) -> bool:
        """Whether the frame's checksum is right."""
