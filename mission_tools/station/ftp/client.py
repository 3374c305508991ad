"""Files of one boat by MAVLink FTP, as a station reads them. No I/O: handle, poll, and callbacks.

One transfer is under way at a time; others wait in line, and logs take turns with them. `list_folder`, `read`
and `read_whole` return the job, which `cancel` ends. A callback is called once, never after `cancel`, and may
ask for more.
"""

from collections import deque
from collections.abc import Callable
from typing import Final

from companion.mavlink.address import Address, is_named
from companion.mavlink.dialect import Message
from companion.mavlink.ftp_frames import parse_reply
from mission_tools.station.ftp.asking import Asking
from mission_tools.station.ftp.blocks import WINDOW_BYTES
from mission_tools.station.ftp.jobs import Entry, FtpFailure, Job, Listing, Sink
from mission_tools.station.ftp.reading import Reading
from mission_tools.station.words import say

MOST_WAITING: Final = 16
TURN_S: Final = 3.0  # of a long file while others wait
PAUSED_TURN_S: Final = 0.5  # of one whose reader is slow
MOST_WHOLE_BYTES: Final = 2_000_000


class _Whole:
    """Satisfies `Sink`: a file in memory."""

    def __init__(self) -> None:
        self.content = bytearray()

    def begin(self, size: int) -> None:  # noqa: ARG002
        self.content.clear()

    def write(self, data: bytes) -> None:
        self.content += data

    def room(self) -> int:
        return WINDOW_BYTES


class FtpClient:
    """The transfers with one boat. send: to this boat."""

    def __init__(self, boat: Address, own: Address, send: Callable[[Message], None]) -> None:
        self._own = own
        self._asking = Asking(boat, send)
        self._jobs: deque[Job] = deque()  # the first one is under way
        self._is_started = False
        self._began_s = self._now_s = 0.0

    @property
    def is_busy(self) -> bool:
        """Whether a transfer is under way."""
        return bool(self._jobs)

    def list_folder(self, path: str, done: Callable[[list[Entry] | FtpFailure], None]) -> Listing:
        """The entries of a folder, in the boat's order."""
        job = Listing(self._asking, path, done)
        self._add(job)
        return job

    def read(
        self,
        path: str,
        sink: Sink,
        done: Callable[[FtpFailure | None], None],
        *,
        most_bytes: int,
        grows: bool = False,
    ) -> Reading:
        """A file into a sink. grows: a log, whose beginning never changes; see `reading`."""
        job = Reading(self._asking, path, sink, done, most_bytes, grows)
        self._add(job)
        return job

    def read_whole(
        self,
        path: str,
        done: Callable[[bytes | FtpFailure], None],
        most_bytes: int = MOST_WHOLE_BYTES,
    ) -> Reading:
        """A file into memory."""
        whole = _Whole()
        return self.read(
            path,
            whole,
            lambda failure: done(bytes(whole.content) if failure is None else failure),
            most_bytes=most_bytes,
        )

    def cancel(self, job: Job) -> None:
        """End a transfer, or take it out of the line. Nothing happens to one that is over."""
        if self._jobs and self._jobs[0] is job and self._is_started:
            job.cancel(self._now_s)
            self._next()
        elif job in self._jobs:
            self._jobs.remove(job)

    def handle(self, message: Message, now_s: float) -> None:
        """FILE_TRANSFER_PROTOCOL of this boat; what is not for us or answers nothing is ignored."""
        self._now_s = now_s
        if not is_named(self._own, message.target_system, message.target_component):
            return
        reply = parse_reply(bytes(message.payload))
        if reply is None or not self._is_started:
            return
        self._asking.handle(reply, now_s)
        if self._jobs and self._is_started:
            self._jobs[0].handle(reply, now_s)
            self._next()

    def poll(self, now_s: float) -> None:
        """Begin, repeat, go on, give up."""
        self._now_s = now_s
        self._next()
        if self._is_started:
            self._asking.poll(now_s)
            self._jobs[0].poll(now_s)
            self._next()

    def _add(self, job: Job) -> None:
        if len(self._jobs) > MOST_WAITING:
            job.refuse(FtpFailure(say("file.busy")))
        else:
            self._jobs.append(job)

    def _next(self) -> None:
        """Begin the next transfer once the one before is over, or gives way."""
        if self._is_started and self._jobs[0].is_over:
            self._asking.drop()
            job = self._jobs.popleft()
            if job.is_yielded:
                self._jobs.append(job)
            self._is_started = False
        if not self._jobs:
            return
        job = self._jobs[0]
        if not self._is_started:
            self._is_started = True
            self._began_s = self._now_s
            job.start(self._now_s)
        elif len(self._jobs) > 1:
            turn_s = PAUSED_TURN_S if job.is_paused else TURN_S
            job.shall_yield |= self._now_s - self._began_s >= turn_s
