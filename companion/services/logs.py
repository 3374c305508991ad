"""LOG_*: stations list and download the onboard logs, 90 bytes per message.

Numbers: ArduPilot counts its logs from 1, and QGroundControl assumes that for ArduPilot vehicles; MAVSDK
assumes numbers from 0. So log k, the k-th oldest, has number k, and the newest is also available as 0. A
request for the whole list is answered with 0 to n-1; each of 1 to n can be requested, which QGroundControl
does for the missing one.

Rate: the messages of a tick are shared among the active downloads; their number grows until the computer is
busy, and stops where the link has no room. Files are read ahead by the log's worker. Stations request lost
parts again.
"""

from collections import deque
from dataclasses import dataclass, field
from typing import Final, NamedTuple

from companion.core.status_text import Severity
from companion.log.logbook import Logbook
from companion.log.reader import LogReader
from companion.log.store import LogFile
from companion.mavlink.address import Address, is_named
from companion.mavlink.dialect import Message, dialect, message_ids
from companion.services.outbox import Origin, Outbox
from companion.services.statustext import StatusTextService
from companion.vehicle.vehicle import Vehicle

LOG_MESSAGES = message_ids("LOG_REQUEST_LIST", "LOG_REQUEST_DATA", "LOG_REQUEST_END", "LOG_ERASE")
CHUNK_BYTES: Final = 90
_FRAME_BYTES: Final = 12 + 7 + CHUNK_BYTES
_MOST_PER_TICK: Final = 256.0  # chunks, of all downloads: 1.1 MB/s at 50 Hz
_FIRST_PER_TICK: Final = 32.0
_LEAST_PER_TICK: Final = 8.0
_BUSY_LOAD: Final = 0.5  # share of the tick above which downloads slow down
_FASTER_BY, _SLOWER_BY = 4, 0.95  # per tick; the load is averaged over about fifty
_ENTRIES_PER_TICK: Final = 20
_MOST_RANGES: Final = 32  # pending requests of a station
_MOST_LISTED: Final = 4096
_IN_FLIGHT_S: Final = 0.1  # what was just sent is not sent again
_LAST_NUMBER: Final = 0xFFFF


class _Range(NamedTuple):
    """A requested part of a log. is_open: the station needs to be told the end of the log."""

    begin: int
    end: int
    is_open: bool


class _Download:
    """One station's download of one log."""

    def __init__(self, number: int, reader: LogReader) -> None:
        self.number = number
        self.reader = reader
        self.offset = 0
        self.ranges: deque[_Range] = deque()
        self.last: _Range | None = None  # the range sent last, and when
        self.last_s = 0.0
        self.chunks_left = int(_LEAST_PER_TICK)  # until the next tick

    def request(self, wanted: _Range, now_s: float) -> None:
        """Add a request.

        The tail of the present or last range is already on its way: MAVSDK requests it at every chunk. A
        range that overlaps the rest replaces it. Any other is a gap and is queued.
        """
        current = self.ranges[0] if self.ranges else None
        for sent in (current, self.last if now_s - self.last_s < _IN_FLIGHT_S else None):
            if sent is not None and wanted.begin > sent.begin and wanted.end == sent.end:
                return
        if current is not None and wanted.begin < current.end and self.offset < wanted.end:
            self.ranges.clear()
        if len(self.ranges) < _MOST_RANGES:
            self.ranges.append(wanted)
            if len(self.ranges) == 1:
                self.offset = wanted.begin

    def next_range(self, now_s: float) -> None:
        """The first range is complete."""
        self.last, self.last_s = self.ranges.popleft(), now_s
        if self.ranges:
            self.offset = self.ranges[0].begin


@dataclass(eq=False)
class LogService:
    """Serves the logs of the logbook's store, if any."""

    _own: Address
    _vehicle: Vehicle
    _outbox: Outbox
    _texts: StatusTextService
    _logbook: Logbook | None
    _listed: dict[int, tuple[LogFile, ...]] = field(default_factory=dict, init=False)  # files by channel
    _entries: dict[int, deque[int]] = field(default_factory=dict, init=False)
    _downloads: dict[int, _Download] = field(default_factory=dict, init=False)
    _per_tick: float = field(default=_FIRST_PER_TICK, init=False)

    def __post_init__(self) -> None:
        self._store = None if self._logbook is None else self._logbook.store

    @property
    def is_busy(self) -> bool:
        return bool(self._entries or self._downloads)

    def handle(self, message: Message, origin: Origin, now_s: float) -> None:
        """Handle a request that names this boat."""
        if not is_named(self._own, message.target_system, message.target_component):
            return
        match message.get_type():
            case "LOG_REQUEST_LIST":
                self._on_request_list(message, origin.channel)
            case "LOG_REQUEST_DATA":
                self._on_request_data(message, origin.channel, now_s)
            case "LOG_REQUEST_END":
                self._downloads.pop(origin.channel, None)
            case "LOG_ERASE":
                self._erase()

    def forget(self, channel: int) -> None:
        for table in (self._listed, self._entries, self._downloads):
            table.pop(channel, None)

    def tick(self, now_s: float, load: float) -> None:
        """Continue lists and downloads. load: share of the tick used."""
        if self._logbook is not None and self._logbook.onboard is not None:
            self._texts.send(self._logbook.onboard.take_status_texts())
        if self._entries:
            for channel in list(self._entries):
                self._send_entries(channel)
        if self._downloads:
            if load < _BUSY_LOAD:
                self._per_tick = min(self._per_tick + _FASTER_BY, _MOST_PER_TICK)
            else:
                self._per_tick = max(self._per_tick * _SLOWER_BY, _LEAST_PER_TICK)
            share = max(int(self._per_tick) // len(self._downloads), 1)
            for channel, download in list(self._downloads.items()):
                download.chunks_left = share
                self._send_chunks(channel, download, now_s)
        else:
            self._per_tick = _FIRST_PER_TICK

    def _on_request_list(self, message: Message, channel: int) -> None:
        if self._store is None or not self._store.logs:
            self._outbox.send(channel, dialect.MAVLink_log_entry_message(0, 0, 0, 0, 0))
            return
        is_whole = message.start == 0 and message.end == _LAST_NUMBER
        if is_whole or channel not in self._listed:
            self._listed[channel] = self._store.logs[-_MOST_LISTED:]
        count = len(self._listed[channel])
        last = count - 1 if is_whole else min(message.end, count)
        self._entries[channel] = deque(range(message.start, last + 1))

    def _send_entries(self, channel: int) -> None:
        entries, listed = self._entries[channel], self._listed[channel]
        for _ in range(min(_ENTRIES_PER_TICK, len(entries))):
            if not self._outbox.has_room(channel):
                return
            number = entries.popleft()
            file = self._current(listed[number - 1])
            entry = dialect.MAVLink_log_entry_message(
                number, len(listed), len(listed) - 1, round(file.unix_s), file.size_bytes
            )
            self._outbox.send_bulk(channel, entry, 26)
        if not entries:
            del self._entries[channel]

    def _current(self, file: LogFile) -> LogFile:
        """The file's present entry: it may have grown."""
        now = self._store.find(file.name) if self._store is not None else None
        return file._replace(size_bytes=0) if now is None else now

    def _on_request_data(self, message: Message, channel: int, now_s: float) -> None:
        if self._store is None or self._logbook is None:
            self._send_empty(channel, message)
            return
        listed = self._listed.setdefault(channel, self._store.logs[-_MOST_LISTED:])
        if not listed or message.id > len(listed):
            self._send_empty(channel, message)
            return
        file = self._current(listed[message.id - 1])
        if message.ofs > file.size_bytes or not file.size_bytes:
            self._send_empty(channel, message)
            return
        download = self._downloads.get(channel)
        if download is None or download.number != message.id or download.reader.name != file.name:
            reader = LogReader(self._store, self._logbook.worker, file.name)
            download = self._downloads[channel] = _Download(message.id, reader)
        end = message.ofs + message.count
        download.reader.refresh()
        download.request(_Range(message.ofs, min(end, file.size_bytes), end > file.size_bytes), now_s)
        self._send_chunks(channel, download, now_s)

    def _send_empty(self, channel: int, message: Message) -> None:
        """An empty chunk ends a download at once; otherwise the station would ask again."""
        self._outbox.send(channel, _chunk(message.id, message.ofs, b""))

    def _send_chunks(self, channel: int, download: _Download, now_s: float) -> None:
        """Send what the tick, the link and the worker allow."""
        while download.ranges and download.chunks_left > 0 and self._outbox.has_room(channel):
            wanted = download.ranges[0]
            count = min(CHUNK_BYTES, wanted.end - download.offset)
            piece = download.reader.piece(download.offset, count) if count else b""
            if piece is None:
                return
            if piece or wanted.is_open or count:
                self._outbox.send_bulk(channel, _chunk(download.number, download.offset, piece), _FRAME_BYTES)
                download.chunks_left -= 1
            download.offset += len(piece)
            # A short chunk marks the end; a log of whole chunks needs an empty one
            is_short = len(piece) < CHUNK_BYTES
            if is_short or (download.offset >= wanted.end and not wanted.is_open):
                download.next_range(now_s)

    def _erase(self) -> None:
        if self._vehicle.armed:
            self._texts.notify(Severity.WARNING, "Logs are not erased while the boat is armed")
            return
        if self._store is not None and self._logbook is not None:
            self._downloads.clear()
            self._entries.clear()
            self._listed.clear()
            self._logbook.worker.submit(self._store.erase)
            self._texts.notify(Severity.NOTICE, "Logs erased")


def _chunk(number: int, offset: int, piece: bytes) -> Message:
    return dialect.MAVLink_log_data_message(number, offset, len(piece), piece.ljust(CHUNK_BYTES, b"\0"))
