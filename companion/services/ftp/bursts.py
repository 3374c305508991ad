"""Bursts: blocks of a file sent without individual requests; bursts share the tick."""

from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import dataclass, field

from companion.mavlink.ftp_frames import DATA_BYTES, Code, Refusal, Request, ack, nak
from companion.services.ftp.sessions import Burst, FtpStation, Session, Stations
from companion.services.ftp.tree import refusal_of

BLOCKS_PER_TICK = 96  # of all stations: a megabyte per second
_BLOCKS_PER_BURST = 512


@dataclass(eq=False)
class Bursts:
    """Sends blocks within the room of the channel and the share of the tick.

    A burst ends with a block marked as the last, after which the station requests more, or with the refusal
    at the end of the file. If that is lost, the station asks again.
    """

    _stations: Stations
    _worker: Executor
    _post: Callable[[FtpStation, bytes], None]
    _has_room: Callable[[int], bool]
    _blocks_left: int = field(default=BLOCKS_PER_TICK, init=False)

    def begin(self, station: FtpStation, request: Request, session: Session, now_s: float) -> None:
        """Start a burst from an offset, replacing the present one; a repeated request continues it."""
        if session.burst is None or session.burst.request.raw != request.raw:
            size = request.size or DATA_BYTES
            session.burst = Burst(request, request.offset, request.sequence + 1, _BLOCKS_PER_BURST, size)
        self._advance(station, session, self._blocks_left, now_s)

    def tick(self, now_s: float) -> None:
        self._blocks_left = BLOCKS_PER_TICK
        running = [(station, s) for station in self._stations for s in station.sessions.values() if s.burst]
        for index, (station, session) in enumerate(running):
            self._advance(station, session, self._blocks_left // (len(running) - index), now_s)

    def _advance(self, station: FtpStation, session: Session, blocks: int, now_s: float) -> None:
        burst, reading, channel = session.burst, session.reading, station.origin.channel
        while burst is not None and blocks > 0 and self._has_room(channel):
            if not reading.has(burst.offset, burst.block_bytes) and not self._load(station, session, burst):
                return
            blocks -= 1
            self._blocks_left -= 1
            session.used_s = now_s
            burst = session.burst = self._send(station, burst, reading.read(burst.offset, burst.block_bytes))

    def _send(self, station: FtpStation, burst: Burst, data: bytes) -> Burst | None:
        """Send one block; returns the rest of the burst."""
        request, offset, sequence = burst.request, burst.offset, burst.sequence
        if not data:
            self._post(station, nak(request, Refusal(Code.END_OF_FILE), offset=offset, sequence=sequence))
            return None
        burst.blocks_left -= 1
        burst.offset += len(data)
        burst.sequence += 1
        is_over = burst.blocks_left == 0
        self._post(station, ack(request, data, offset=offset, sequence=sequence, is_burst_over=is_over))
        return None if is_over else burst

    def _load(self, station: FtpStation, session: Session, burst: Burst) -> bool:
        """Load the next part of the file; returns whether it is available."""
        reading = session.reading
        if session.loading is None:
            session.loading = self._worker.submit(reading.load, burst.offset)
        if not session.loading.done():
            return False
        error, session.loading = session.loading.exception(), None
        if isinstance(error, OSError):
            session.burst = None
            self._post(station, nak(burst.request, refusal_of(error), sequence=burst.sequence))
        return error is None and reading.has(burst.offset, burst.block_bytes)
