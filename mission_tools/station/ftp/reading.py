"""A file read from the boat by bursts, with the gaps read one by one.

Theory of operation
-------------------
    OPEN_FILE_RO ─► session, size
    BURST_READ_FILE at `done` ─► blocks …; over when its last block says so, at the end of the file, or when
                                 nothing new has come for QUIET_S
    READ_FILE for every gap, IN_FLIGHT at a time, each repeated until answered
    no gap: the next burst, once the sink has room for it
    TERMINATE_SESSION

- Blocks go to the sink in order. At most WINDOW_BYTES wait behind a gap; what lies beyond is dropped and
  read later.
- A burst that brings nothing is followed by one READ_FILE, which brings a block, the end of the file, or
  the end of the transfer. After BARREN such bursts the file is read by READ_FILE alone. So every transfer
  ends.
- The size that the boat names with the open file is a limit; some boats name one that is too large. The
  refusal END_OF_FILE to a READ_FILE ends the file. A file that `grows` (a log) must have the size named.
- A session that the boat does not know any more (it has restarted, or closed the file) is opened again,
  REOPEN times at most. A file that grows goes on where it was, if it is not shorter and the last block is
  the same; another begins anew, as its content may have changed.
- `shall_yield` makes a file that grows close before its next burst; it goes on when it has its next turn.
- While the sink has no room, a byte is read from time to time, so that the boat keeps the session.
"""

from collections.abc import Callable
from typing import Final

from companion.mavlink.ftp_frames import DATA_BYTES, Code, Opcode, Reply
from mission_tools.station.ftp.asking import Asking, is_of_burst
from mission_tools.station.ftp.blocks import WINDOW_BYTES, Blocks
from mission_tools.station.ftp.jobs import FtpFailure, Job, Sink, failure_of
from mission_tools.station.words import say

QUIET_S: Final = 0.7  # after which a burst is over: its rest, or its request, is lost
IN_FLIGHT: Final = 24  # READ_FILE requests; the boat queues 32 of a station while it waits for its disk
BARREN: Final = 3
REOPEN: Final = 4
SILENT_S: Final = 10.0  # without anything new, when a request was given up
KEEP_S: Final = 8.0  # the boat closes a session that is not used for 30 s
LEAST_BYTES_S: Final = 100.0  # a boat that is slower, on average and after a minute, is given up
_GRACE_S: Final = 60.0
_CLOSING_TRIES: Final = 4


class Reading(Job):
    """One file. done: called once, with None when the sink has it all. grows: a log, see above."""

    def __init__(
        self,
        asking: Asking,
        path: str,
        sink: Sink,
        done: Callable[[FtpFailure | None], None],
        most_bytes: int,
        grows: bool,
    ) -> None:
        self.size: int | None = None  # as the boat named it
        self._asking = asking
        self._path = path.encode()
        self._sink = sink
        self._done: Callable[[FtpFailure | None], None] | None = done
        self._most_bytes = most_bytes
        self._grows = grows
        self._session: int | None = None
        self._blocks = Blocks(0)
        self._tail = b""
        self._burst: int | None = None  # number of the latest one
        self._is_bursting = self._is_fruitful = False
        self._asked: set[int] = set()  # offsets of the gaps under way
        self._barren = 0
        self._opened = 0
        self._quiet_s = self._new_s = self._kept_s = self._polled_s = 0.0
        self._spent_s = 0.0  # without the pauses

    def start(self, now_s: float) -> None:
        """Open the file, for the first time or again."""
        self.is_over = self.is_yielded = self.shall_yield = self.is_paused = False
        self._polled_s = self._polled_s or now_s
        self._asking.drop()
        self._asked.clear()
        self._session = self._burst = None
        self._is_bursting = False
        self._opened += 1
        self._asking.ask(Opcode.OPEN_FILE_RO, self._on_open, now_s, data=self._path)

    def handle(self, reply: Reply, now_s: float) -> None:
        """A block of a burst, or its end."""
        if self._burst is None or self._done is None or not is_of_burst(reply, self._burst):
            return
        if reply.opcode != Opcode.BURST_READ_FILE or reply.session != self._session:
            return
        if reply.code == Code.UNKNOWN_COMMAND:
            self._barren = BARREN
        elif reply.code not in (0, Code.END_OF_FILE):
            self._reopen(reply, now_s)
            return
        if not reply.code and self._keep_block(reply.offset, reply.data, now_s):
            self._quiet_s, self._is_fruitful = now_s, True
        if reply.code or reply.is_burst_over or self._blocks.is_full:
            self._end_burst()
        self._step(now_s)

    def poll(self, now_s: float) -> None:
        """Go on, and give up a boat that is too slow."""
        is_paused = self._session is not None and not self._is_bursting and not self._asked
        self._spent_s += 0.0 if is_paused else now_s - self._polled_s
        self._polled_s = now_s
        if self._done is None:
            return
        if self._spent_s > _GRACE_S + self._blocks.end / LEAST_BYTES_S:
            self._finish(FtpFailure(say("file.slow")), now_s)
            return
        if self._is_bursting and now_s - self._quiet_s > QUIET_S:
            self._end_burst()
        self._step(now_s)

    def cancel(self, now_s: float) -> None:
        """End: close the file on the boat."""
        self.is_yielded = False
        if self._done is None:
            return
        self._done = None
        if self._session is not None:
            self._close(now_s)

    def refuse(self, failure: FtpFailure) -> None:
        self.is_over = True
        done, self._done = self._done, None
        if done is not None:
            done(failure)

    def _on_open(self, reply: Reply | None, now_s: float) -> None:
        is_full = reply is not None and reply.code == Code.NO_SESSIONS_AVAILABLE
        if is_full and self._opened == 1 and self._done:  # sessions of an earlier run of this station
            self._asking.ask(Opcode.RESET_SESSIONS, lambda _, at_s: self.start(at_s), now_s, tries=3)
        elif reply is None or reply.code:
            self.refuse(failure_of(reply))
        else:
            self._session = reply.session
            if self._done is None:
                self._close(now_s)
            else:
                self._begin(int.from_bytes(reply.data[:4], "little"), now_s)

    def _begin(self, size: int, now_s: float) -> None:
        self._kept_s = now_s
        if size > self._most_bytes:
            kb, most_kb = size // 1000, self._most_bytes // 1000
            self._finish(FtpFailure(say("file.too_large", n=kb, most=most_kb)), now_s)
        elif self.size is None or not self._grows:
            self.size = size
            self._blocks = Blocks(size)
            self._sink.begin(size)
            self._step(now_s)
        elif size < self.size:
            self._finish(FtpFailure(say("file.shorter")), now_s)
        else:
            self._blocks = Blocks(self.size, self._blocks.done)
            self._check_tail(now_s)

    def _check_tail(self, now_s: float) -> None:
        """The last block again: is it the same file?"""
        if not self._tail:
            self._step(now_s)
            return
        at = self._blocks.done - len(self._tail)
        self._asked.add(at)

        def answered(reply: Reply | None, at_s: float) -> None:
            self._asked.discard(at)
            if reply is None:
                self._finish(failure_of(None), at_s)
            elif reply.data != self._tail:
                self._finish(FtpFailure(say("file.other")), at_s)
            else:
                self._step(at_s)

        self._read(at, len(self._tail), answered, now_s)

    def _read(
        self, at: int, size: int, answered: Callable[[Reply | None, float], None], now_s: float
    ) -> None:
        if self._session is not None:
            self._asking.ask(Opcode.READ_FILE, answered, now_s, session=self._session, offset=at, size=size)

    def _step(self, now_s: float) -> None:
        """Whatever is due, from the state alone."""
        blocks = self._blocks
        if self._done is None or self._session is None or self._is_bursting:
            return
        if blocks.done >= blocks.end:
            is_short = self._grows and self.size is not None and blocks.end < self.size
            self._finish(FtpFailure(say("file.short")) if is_short else None, now_s)
            return
        if len(self._asked) >= IN_FLIGHT:
            return
        if blocks.done < blocks.high or self._asked:
            self._read_gaps(now_s)
            return
        if self.shall_yield and self._grows:
            self.is_yielded = True
            self._opened -= 1
            self._close(now_s)
            return
        self.is_paused = self._sink.room() < min(WINDOW_BYTES, blocks.end - blocks.done)
        if self.is_paused:
            self._keep(now_s)
            return
        blocks.open()
        if self._barren >= BARREN:
            blocks.high = min(blocks.end, blocks.done + 4 * IN_FLIGHT * DATA_BYTES)
            self._read_gaps(now_s)
        else:
            self._is_bursting, self._is_fruitful = True, False
            self._quiet_s = self._kept_s = now_s
            self._burst = self._asking.burst(Opcode.BURST_READ_FILE, self._session, blocks.done, DATA_BYTES)

    def _end_burst(self) -> None:
        if not self._is_bursting:
            return
        self._is_bursting = False
        self._barren = 0 if self._is_fruitful else self._barren + 1
        if self._blocks.high == self._blocks.done:  # nothing, or the end: a request shows which
            self._blocks.high = min(self._blocks.end, self._blocks.done + DATA_BYTES)

    def _read_gaps(self, now_s: float) -> None:
        for at, size in self._blocks.gaps():
            if len(self._asked) >= IN_FLIGHT:
                return
            if at not in self._asked:
                self._read_gap(at, size, now_s)

    def _read_gap(self, at: int, size: int, now_s: float) -> None:
        self._asked.add(at)

        def answered(reply: Reply | None, at_s: float) -> None:
            self._asked.discard(at)
            if reply is None and at_s - self._new_s > SILENT_S:
                self._finish(failure_of(None), at_s)
            elif reply is None:  # lost each time, while others come through
                self._step(at_s)
            elif reply.code == Code.END_OF_FILE or not (reply.code or reply.data):
                self._blocks.cut(at)
                self._step(at_s)
            elif reply.code:
                self._reopen(reply, at_s)
            else:
                self._keep_block(at, reply.data[:size], at_s)
                self._step(at_s)

        self._read(at, size, answered, now_s)

    def _keep_block(self, at: int, data: bytes, now_s: float) -> bool:
        """Keep a block, and hand on what follows on the bytes so far; returns whether it is new."""
        if not self._blocks.put(at, data):
            return False
        self._new_s = now_s
        if data := self._blocks.take():
            self._tail = (self._tail + data)[-DATA_BYTES:]
            self._sink.write(data)
        return True

    def _keep(self, now_s: float) -> None:
        """The sink has no room."""
        if now_s - self._kept_s < KEEP_S:
            return
        self._kept_s = now_s

        def answered(reply: Reply | None, at_s: float) -> None:
            if reply is None:
                self._finish(failure_of(None), at_s)
            elif reply.code:
                self._reopen(reply, at_s)

        self._read(max(self._blocks.done - 1, 0), 1, answered, now_s)

    def _reopen(self, reply: Reply, now_s: float) -> None:
        if self._opened > REOPEN:
            self._finish(failure_of(reply), now_s)
        else:
            self.start(now_s)

    def _finish(self, failure: FtpFailure | None, now_s: float) -> None:
        done, self._done = self._done, None
        self._close(now_s)
        if done is not None:
            done(failure)

    def _close(self, now_s: float) -> None:
        self._asking.drop()
        self._burst = None
        self._is_bursting = False
        if self._session is None:
            self.is_over = True
            return
        self._asked.clear()

        def answered(reply: Reply | None, at_s: float) -> None:  # noqa: ARG001
            self.is_over = True

        session, self._session = self._session, None
        self._asking.ask(Opcode.TERMINATE_SESSION, answered, now_s, session=session, tries=_CLOSING_TRIES)
