"""FILE_TRANSFER_PROTOCOL: the boat's files for stations, after the MAVLink guide, "File Transfer Protocol".

Theory of operation. Requests for virtual files are answered at once. Disk access runs in a worker and is
answered when it is done; later requests for the same session are queued. An upload is kept in memory until
its session is closed, then replaces the old file as a whole; an aborted session leaves the old file. A
repeated request gets the same answer and is not executed again.

Stations share the capacity of a tick; requests beyond it are dropped and will be repeated.
"""

from collections import deque
from collections.abc import Callable
from concurrent.futures import Executor, Future
from typing import Any, NamedTuple

from companion.mavlink.address import Address, is_named
from companion.mavlink.dialect import Message, dialect
from companion.mavlink.ftp_frames import SESSION_AT, Code, Opcode, Refusal, Request, nak, parse_request
from companion.services.ftp.bursts import Bursts
from companion.services.ftp.operations import Operations, Reply
from companion.services.ftp.sessions import FtpStation, Session, Stations
from companion.services.ftp.tree import FileTree, refusal_of
from companion.services.outbox import Origin, Outbox

_FRAME_BYTES = 280
REQUESTS_PER_TICK = 256  # of all stations
_MAX_JOBS = 64
_MAX_QUEUED = 32  # of one station
_EXPIRY_PERIOD_S = 1.0

# Executed again when repeated: they change nothing
_READS = frozenset(
    (Opcode.NONE, Opcode.LIST_DIRECTORY, Opcode.READ_FILE, Opcode.BURST_READ_FILE, Opcode.CALC_FILE_CRC32)
)
_OPENS = frozenset((Opcode.OPEN_FILE_RO, Opcode.OPEN_FILE_WO, Opcode.CREATE_FILE))


class _Job(NamedTuple):
    """Work in progress for a request, and how to make its reply."""

    station: FtpStation
    request: Request
    future: "Future[Any]"
    then: Callable[[Any], bytes]

    def reply(self) -> bytes:
        """The reply when the work is done. Re-raises its exceptions."""
        return self.then(self.future.result(timeout=0))


class FtpService:
    """Serves a file tree. The worker is shut down with the service."""

    def __init__(self, own: Address, outbox: Outbox, tree: FileTree, worker: Executor) -> None:
        self.dropped = 0  # requests beyond the capacity
        self._own = own
        self._outbox = outbox
        self._worker = worker
        self._stations = Stations()
        self._bursts = Bursts(self._stations, worker, self._post_block, outbox.has_room)
        self._operations = Operations(
            tree,
            self._stations,
            self._later,
            self._release,
            lambda station, request, session: self._bursts.begin(station, request, session, self._now_s),
        )
        self._jobs: deque[_Job] = deque()
        self._requests_left = REQUESTS_PER_TICK
        self._now_s = 0.0
        self._expire_at_s = 0.0

    def handle(self, message: Message, origin: Origin, now_s: float) -> None:
        """Handle a request; others are ignored."""
        self._now_s = now_s
        request = parse_request(bytes(message.payload))
        if request is None or not is_named(self._own, message.target_system, message.target_component):
            return
        if self._requests_left <= 0 or len(self._jobs) >= _MAX_JOBS:
            self.dropped += 1
            return
        self._requests_left -= 1
        station = self._stations.get(origin)
        self._release(self._stations.take_displaced())
        if station is None:
            self._post(FtpStation(origin), nak(request, Refusal(Code.NO_SESSIONS_AVAILABLE)))
            return
        if station.is_busy(request.session):
            self._queue(station, request)
        else:
            self._carry_out(station, request)

    @property
    def is_busy(self) -> bool:
        return bool(self._jobs or self._stations)

    def tick(self, now_s: float) -> None:
        """Answer finished work, continue bursts, close idle sessions."""
        self._now_s = now_s
        self._requests_left = REQUESTS_PER_TICK
        while self._jobs and self._jobs[0].future.done():
            job = self._jobs.popleft()
            job.station.waiting.discard(job.request.raw)
            self._answer(job.station, job.request, job.reply)
            self._next_queued(job.station)
        if not self._stations:
            return
        self._bursts.tick(now_s)
        if now_s >= self._expire_at_s:
            self._expire_at_s = now_s + _EXPIRY_PERIOD_S
            self._release(self._stations.expire(now_s))

    def forget(self, channel: int) -> None:
        self._release(self._stations.forget(channel))

    def close(self) -> None:
        """Close all files and the worker. May be called twice."""
        for channel in {station.origin.channel for station in self._stations}:
            self.forget(channel)
        self._worker.shutdown(wait=True)

    def _queue(self, station: FtpStation, request: Request) -> None:
        """Queue a request of a busy session, in order."""
        if request.raw in station.waiting or request in station.queued:
            return
        if len(station.queued) < _MAX_QUEUED:
            station.queued.append(request)
        else:
            self.dropped += 1

    def _next_queued(self, station: FtpStation) -> None:
        queued, station.queued = station.queued, deque()
        for request in queued:
            if station.is_busy(request.session):
                station.queued.append(request)
            else:
                self._carry_out(station, request)

    def _carry_out(self, station: FtpStation, request: Request) -> None:
        if (reply := station.repeated(request, self._now_s)) is not None:
            self._post(station, reply)
            return
        self._answer(station, request, lambda: self._operations.carry_out(station, request, self._now_s))

    def _answer(self, station: FtpStation, request: Request, carry_out: Callable[[], Reply]) -> None:
        """Send the reply if available, and keep it for a repeat."""
        opened = None
        try:
            reply = carry_out()
            if reply is not None and request.opcode in _OPENS:
                opened = reply[SESSION_AT]
        except Refusal as refusal:
            reply = nak(request, refusal)
        except OSError as error:
            reply = nak(request, refusal_of(error))
        if reply is None:
            return
        if request.opcode not in _READS:
            station.remember(request, reply, self._now_s, opened)
        self._post(station, reply)

    def _later(
        self,
        station: FtpStation,
        request: Request,
        on_disk: bool,
        work: Callable[[], Any],
        then: Callable[[Any], bytes],
    ) -> Reply:
        """Run disk access in the worker, other work now."""
        if not on_disk:
            return then(work())
        job = _Job(station, request, self._worker.submit(work), then)
        if job.future.done():
            return job.reply()
        station.waiting.add(request.raw)
        self._jobs.append(job)
        return None

    def _release(self, sessions: list[Session]) -> None:
        for session in sessions:
            if session.upload is None:
                self._worker.submit(session.reading.close)

    def _post(self, station: FtpStation, payload: bytes) -> None:
        self._outbox.send(station.origin.channel, _message(station, payload))

    def _post_block(self, station: FtpStation, payload: bytes) -> None:
        self._outbox.send_bulk(station.origin.channel, _message(station, payload), _FRAME_BYTES)


def _message(station: FtpStation, payload: bytes) -> Message:
    address = station.origin.address
    return dialect.MAVLink_file_transfer_protocol_message(0, address.system, address.component, payload)
