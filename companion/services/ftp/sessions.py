"""Open files by station. A station is a channel and an address, each with its own sessions."""

import errno
import math
from collections import Counter, OrderedDict, deque
from collections.abc import Iterator
from concurrent.futures import Future
from dataclasses import dataclass, field

from companion.mavlink.ftp_frames import SESSION_AT, Code, Refusal, Request
from companion.services.ftp.tree import Place, Reading
from companion.services.outbox import Origin

IDLE_S = 30.0  # an unused session is closed
MAX_STATIONS = 32
MAX_SESSIONS = 8  # per station
MAX_UPLOAD_BYTES = 4 * 1024 * 1024
MAX_UPLOADS_BYTES = 16 * 1024 * 1024  # of all stations
_REPEAT_S = 10.0  # window in which an identical request is a repeat
_REPEATS = 64


class Upload:
    """A file being written, in memory until its session is closed."""

    def __init__(self, place: Place, content: bytes) -> None:
        self.place = place
        self.content = bytearray(content)
        self.is_written = False

    def growth(self, end: int) -> int:
        """Growth of the file when written up to an offset. Raises OSError: too long."""
        if end > MAX_UPLOAD_BYTES:
            raise OSError(errno.EFBIG, "too long")
        return max(end - len(self.content), 0)

    def write(self, offset: int, data: bytes) -> None:
        """Write data at an offset; a gap is filled with zeros."""
        end = offset + len(data)
        if offset > len(self.content):
            self.content.extend(bytes(offset - len(self.content)))
        self.content[offset:end] = data
        self.is_written = True

    def save(self) -> None:
        """Replace the file. Raises what its mount raises."""
        self.place.mount.save(self.place.names, bytes(self.content))


@dataclass(slots=True)
class Burst:
    """State of a burst."""

    request: Request
    offset: int
    sequence: int  # of the next reply
    blocks_left: int
    block_bytes: int


@dataclass(slots=True)
class Session:
    """An open file, for reading or writing."""

    number: int
    file: Reading | Upload
    on_disk: bool
    used_s: float
    burst: Burst | None = None
    loading: Future[None] | None = None  # what the burst waits for

    @property
    def reading(self) -> Reading:
        """The file being read. Raises Refusal: it is being written."""
        if isinstance(self.file, Upload):
            raise Refusal(Code.FILE_PROTECTED)
        return self.file

    @property
    def upload(self) -> Upload | None:
        return self.file if isinstance(self.file, Upload) else None


@dataclass(slots=True)
class Answer:
    """An answer, and the session that it opened."""

    reply: bytes
    at_s: float
    opened: int | None


@dataclass(slots=True)
class FtpStation:
    """One client."""

    origin: Origin
    is_gone: bool = False
    sessions: dict[int, Session] = field(default_factory=dict)
    waiting: set[bytes] = field(default_factory=set)  # requests in progress
    queued: deque[Request] = field(default_factory=deque)  # later requests for the same sessions
    _answers: OrderedDict[bytes, Answer] = field(default_factory=OrderedDict)

    def is_busy(self, number: int) -> bool:
        """Whether a request for a session is in progress."""
        return any(raw[SESSION_AT] == number for raw in self.waiting)

    def session(self, number: int, now_s: float) -> Session:
        """An open session; marks it as used. Raises Refusal: no such session."""
        session = self.sessions.get(number)
        if session is None:
            raise Refusal(Code.INVALID_SESSION)
        session.used_s = now_s
        return session

    def open(self, wanted: int, file: Reading | Upload, on_disk: bool, now_s: float) -> Session:
        """Open a session with the wanted number, or the lowest free one. Refusal: there are too many."""
        if len(self.sessions) >= MAX_SESSIONS or self.is_gone:
            raise Refusal(Code.NO_SESSIONS_AVAILABLE)
        number = wanted
        if number in self.sessions:
            number = next(free for free in range(256) if free not in self.sessions)
        session = self.sessions[number] = Session(number, file, on_disk, now_s)
        return session

    def close(self, number: int) -> Session:
        """Close a session. Raises Refusal: no such session."""
        session = self.sessions.pop(number, None)
        if session is None:
            raise Refusal(Code.INVALID_SESSION)
        for raw in [raw for raw, answer in self._answers.items() if answer.opened == number]:
            del self._answers[raw]
        return session

    def remember(self, request: Request, reply: bytes, now_s: float, opened: int | None = None) -> None:
        """Keep an answer for a repeat."""
        self._answers[request.raw] = Answer(reply, now_s, opened)
        if len(self._answers) > _REPEATS:
            self._answers.popitem(last=False)

    def repeated(self, request: Request, now_s: float) -> bytes | None:
        """The answer to a repeated request; None for a new one."""
        answer = self._answers.get(request.raw)
        return answer.reply if answer is not None and now_s - answer.at_s < _REPEAT_S else None

    def is_idle(self, now_s: float) -> bool:
        """Whether nothing is open or remembered."""
        newest_s = max((answer.at_s for answer in self._answers.values()), default=-math.inf)
        return not self.sessions and not self.waiting and now_s - newest_s >= _REPEAT_S


class Stations:
    """All clients and their open files."""

    def __init__(self) -> None:
        self._stations: dict[Origin, FtpStation] = {}
        self._displaced: list[Session] = []

    def __bool__(self) -> bool:
        return bool(self._stations)

    def __iter__(self) -> Iterator[FtpStation]:
        return iter(self._stations.values())

    def get(self, origin: Origin) -> FtpStation | None:
        """The client at an origin; None if there are too many.

        The longest idle one without open files is displaced. If all have open files, one of the channel with
        the most clients is displaced for a channel with fewer, as addresses are easily forged.
        """
        station = self._stations.pop(origin, None)
        if station is None:
            if len(self._stations) >= MAX_STATIONS and not self._make_way(origin.channel):
                return None
            station = FtpStation(origin)
        self._stations[origin] = station  # the dict's order is that of last use
        return station

    def _make_way(self, channel: int) -> bool:
        idle = (one for one in self if not one.sessions and not one.waiting)
        victim = next(idle, None)
        if victim is None:
            counts = Counter(one.origin.channel for one in self)
            fullest, count = counts.most_common(1)[0]
            if count <= counts[channel] + 1:
                return False
            victim = next(one for one in self if one.origin.channel == fullest)
        del self._stations[victim.origin]
        victim.is_gone = True
        self._displaced += victim.sessions.values()
        return True

    def take_displaced(self) -> list[Session]:
        """Sessions of clients displaced since the last call."""
        displaced, self._displaced = self._displaced, []
        return displaced

    def uploads_bytes(self) -> int:
        uploads = (session.upload for station in self for session in station.sessions.values())
        return sum(len(upload.content) for upload in uploads if upload is not None)

    def expire(self, now_s: float) -> list[Session]:
        """Close idle sessions and return them; idle stations are removed."""
        closed = []
        for origin, station in list(self._stations.items()):
            for number, session in list(station.sessions.items()):
                if now_s - session.used_s > IDLE_S:
                    closed.append(station.close(number))
            if station.is_idle(now_s):
                del self._stations[origin]
        return closed

    def forget(self, channel: int) -> list[Session]:
        """A channel has closed: its sessions."""
        gone = [origin for origin in self._stations if origin.channel == channel]
        stations = [self._stations.pop(origin) for origin in gone]
        for station in stations:
            station.is_gone = True
        return [session for station in stations for session in station.sessions.values()]
