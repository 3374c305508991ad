"""A byte-stream link over a descriptor: a TCP connection or a serial line."""

import contextlib
import os
from collections.abc import Callable

_CHUNK_BYTES = 4096
_CHUNKS_PER_CALL = 16  # limit against flooding stations


class StreamLink:
    """Satisfies `companion.links.interfaces.Link` over a non-blocking descriptor.

    Output waits in a queue of at most queue_bytes; a frame that does not fit is dropped whole, so the stream
    never has partial frames. The queue drains on every `receive` and `send`. End of stream closes the link,
    even if the far side closed only its sending half: a silent station is useless.
    """

    is_datagram = False  # chunk boundaries are arbitrary

    def __init__(
        self, name: str, descriptor: int, release: Callable[[], object], queue_bytes: int, host: str = ""
    ) -> None:
        self.name = name
        self.host = host
        self._descriptor = descriptor
        self._release = release
        self._queue_bytes = queue_bytes
        self._pending = bytearray()
        self._is_broken = False  # sending failed; received data may still be read

    @property
    def is_closed(self) -> bool:
        """True after `close`, or once the far side is gone and all data was read."""
        return self._descriptor < 0

    def receive(self) -> list[bytes]:
        """Received data, at most 64 KiB per call."""
        chunks: list[bytes] = []
        has_ended = False
        while self._descriptor >= 0 and len(chunks) < _CHUNKS_PER_CALL:
            try:
                chunk = os.read(self._descriptor, _CHUNK_BYTES)
            except (BlockingIOError, InterruptedError):
                has_ended = self._is_broken
                break
            except OSError:
                has_ended = True
                break
            if not chunk:
                has_ended = True
                break
            chunks.append(chunk)
            if len(chunk) < _CHUNK_BYTES and not self._is_broken:
                break
        if has_ended:
            self.close()
        elif self._pending:
            self._drain()
        return chunks

    def send(self, data: bytes) -> bool:
        """Send or queue a frame whole; False if it was dropped."""
        if self._pending:
            self._drain()
        is_full = bool(self._pending) and len(self._pending) + len(data) > self._queue_bytes
        if is_full or self._is_broken or self._descriptor < 0:
            return False
        self._pending += data
        self._drain()
        return not self._is_broken

    def fileno(self) -> int:
        """The descriptor, −1 once closed."""
        return self._descriptor

    def close(self) -> None:
        if self._descriptor >= 0:
            self._descriptor = -1
            self._pending.clear()
            with contextlib.suppress(OSError):  # an unplugged device may fail to close
                self._release()

    def _drain(self) -> None:
        if self._descriptor < 0 or self._is_broken:
            return
        try:
            del self._pending[: os.write(self._descriptor, self._pending)]
        except (BlockingIOError, InterruptedError):
            pass
        except OSError:
            self._is_broken = True
