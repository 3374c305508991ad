"""Non-blocking reader of a log for downloads: the worker reads ahead."""

import logging
from functools import partial

from companion.core.errors import StorageError
from companion.log.sink import Worker
from companion.log.store import LogStore

logger = logging.getLogger(__name__)

BLOCK_BYTES = 65536


class LogReader:
    """One file of the store, with a few blocks in memory."""

    def __init__(self, store: LogStore, worker: Worker, name: str) -> None:
        self.name = name
        self._store = store
        self._worker = worker
        self._blocks: dict[int, bytes] = {}  # by number; the worker adds, the loop removes
        self._asked: set[int] = set()

    def piece(self, offset: int, count: int) -> bytes | None:
        """Up to count bytes from an offset, fewer at the end; None while they are being read."""
        number, at = divmod(offset, BLOCK_BYTES)
        self._ask(number)
        self._ask(number + 1)
        block = self._blocks.get(number)
        if block is None:
            return None
        piece = block[at : at + count]
        if len(piece) == count or len(block) < BLOCK_BYTES:
            return piece
        rest = self.piece((number + 1) * BLOCK_BYTES, count - len(piece))
        return None if rest is None else piece + rest

    def refresh(self) -> None:
        """Read the end again: the file may have grown."""
        for number in list(self._blocks):
            if len(self._blocks[number]) < BLOCK_BYTES:
                del self._blocks[number]

    def _ask(self, number: int) -> None:
        if number in self._blocks or number in self._asked:
            return
        for old in list(self._blocks):
            if not number - 2 <= old <= number + 1:  # a piece may lie across two, and a third is ahead
                del self._blocks[old]
        self._asked.add(number)
        if not self._worker.submit(partial(self._read, number), BLOCK_BYTES):
            self._asked.discard(number)

    def _read(self, number: int) -> None:
        try:
            with self._store.open(self.name) as file:
                file.seek(number * BLOCK_BYTES)
                content = file.read(BLOCK_BYTES)
        except (OSError, StorageError) as error:
            logger.warning("log %s: %s", self.name, error)
            content = b""
        self._blocks[number] = content
        self._asked.discard(number)
