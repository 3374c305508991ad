"""Frames on their way to a link: the boat's own first, then other channels' in equal shares.

Forwarded frames wait in a queue for each source channel. Deficit round robin (Shreedhar and Varghese 1995)
gives each source the same number of bytes, so a source that floods delays only itself. A source's addressed
frames go before its broadcasts.
"""

from collections import deque
from collections.abc import Callable

MAX_BYTES = 16 * 1024  # per queue
_QUANTUM_BYTES = 280  # of a turn: the longest frame of MAVLink 2
_BURST_S = 0.2  # largest saving
_DEBT_S = 1.0  # largest debt, from urgent frames
_LEAST_SHARE = 0.1
_FULL_SPEED = 1.0
_RESERVED_SHARE = 0.5  # twice what the default telemetry, 1.1 kB/s, takes of 57,600 baud

# SiK radios report their free buffer in percent about once a second. The bounds and steps keep it between
# 20 and 90 percent free, so that it neither overflows nor runs empty.
_STEPS = ((20, 0.6), (50, 0.85), (90, 1.0), (101, 1.25))


class TokenBucket:
    """A token bucket at the line's rate. Whoever does not ask first may overdraw it; the others then wait.

    The radio's reports can reduce the rate, never raise it above the nominal one.
    """

    def __init__(self, bytes_s: float) -> None:
        self.share = _FULL_SPEED  # of bytes_s
        self._bytes_s = bytes_s
        self._left = bytes_s * _BURST_S
        self._filled_s: float | None = None

    def may_send(self, now_s: float) -> bool:
        """Whether a message of the usual size may be sent."""
        self._fill(now_s)
        return self._left > 0.0

    def spend(self, count: int, now_s: float) -> None:
        """Account for sent bytes."""
        self._fill(now_s)
        self._left = max(self._left - count, -self._bytes_s * _DEBT_S)

    def on_radio_status(self, free_percent: int) -> None:
        """Adapt the rate to the free transmit buffer."""
        step = next((step for bound, step in _STEPS if free_percent < bound), _FULL_SPEED)
        self.share = min(max(self.share * step, _LEAST_SHARE), _FULL_SPEED)

    def _fill(self, now_s: float) -> None:
        if self._filled_s is not None and now_s > self._filled_s:
            rate = self._bytes_s * self.share
            self._left = min(self._left + rate * (now_s - self._filled_s), rate * _BURST_S)
        self._filled_s = now_s


class LineBudget:
    """Rate limit of a line for the boat's own and for forwarded frames.

    Each may use what the other leaves. A share of the line is reserved for the boat's own, whatever others
    forward.
    """

    def __init__(self, bytes_s: float) -> None:
        self._line = TokenBucket(bytes_s)
        self._reserved = TokenBucket(_RESERVED_SHARE * bytes_s)

    def may_send(self, now_s: float, *, is_own: bool) -> bool:
        """Whether the boat's telemetry, or a frame of another channel, may be sent."""
        return self._line.may_send(now_s) or (is_own and self._reserved.may_send(now_s))

    def spend(self, count: int, now_s: float, *, is_own: bool) -> None:
        """Account for sent bytes."""
        self._line.spend(count, now_s)
        if is_own:
            self._reserved.spend(count, now_s)

    def on_radio_status(self, free_percent: int) -> None:
        """Adapt the rate to the radio's free transmit buffer."""
        self._line.on_radio_status(free_percent)
        self._reserved.on_radio_status(free_percent)


class _Queue:
    def __init__(self) -> None:
        self.frames: deque[tuple[float, bytes]] = deque()  # oldest first, with time of arrival
        self.bytes = 0

    def add(self, data: bytes, now_s: float) -> int:
        """Append a frame; returns the number of old ones dropped for it."""
        self.frames.append((now_s, data))
        self.bytes += len(data)
        dropped = 0
        while self.bytes > MAX_BYTES:
            self.pop()
            dropped += 1
        return dropped

    def pop(self) -> bytes:
        _, data = self.frames.popleft()
        self.bytes -= len(data)
        return data

    def drop_older(self, than_s: float) -> int:
        dropped = 0
        while self.frames and self.frames[0][0] < than_s:
            self.pop()
            dropped += 1
        return dropped


class _Source:
    """Waiting frames of another channel. deficit_bytes: what is left of its turn."""

    def __init__(self) -> None:
        self.deficit_bytes = _QUANTUM_BYTES
        self.addressed = _Queue()
        self.broadcast = _Queue()

    @property
    def first(self) -> _Queue:
        """The queue to serve next."""
        return self.addressed if self.addressed.frames else self.broadcast

    @property
    def bytes(self) -> int:
        return self.addressed.bytes + self.broadcast.bytes

    def drop_older(self, than_s: float) -> int:
        return self.addressed.drop_older(than_s) + self.broadcast.drop_older(than_s)


class TxQueue:
    """Queue before a link that cannot take everything at once.

    The boat's own frames are sent as soon as the link takes them; its telemetry asks `may_send` first.
    Forwarded frames use what the rate limit leaves. Frames that have waited for stale_s are dropped and
    counted in `dropped`.
    """

    def __init__(self, send: Callable[[bytes], bool], budget: LineBudget | None, stale_s: float) -> None:
        self.dropped = 0
        self.overhead_bytes = 0  # added to each frame of our own by `send`
        self._send = send
        self._budget = budget
        self._stale_s = stale_s
        self._own = _Queue()
        self._sources: dict[int, _Source] = {}  # with waiting frames, by channel, in order of their turns

    @property
    def waiting_bytes(self) -> int:
        return self._own.bytes + sum(source.bytes for source in self._sources.values())

    def may_send(self, now_s: float) -> bool:
        """Whether the boat's telemetry would be sent at once."""
        if self._own.frames:
            return False
        return self._budget is None or self._budget.may_send(now_s, is_own=True)

    def put(self, data: bytes, now_s: float) -> None:
        """Send or queue a frame of our own."""
        self.dropped += self._own.add(data, now_s)
        self.drain(now_s)

    def forward(self, data: bytes, source: int, is_addressed: bool, now_s: float) -> None:
        """Send or queue a frame of another channel."""
        if not (self._own.frames or self._sources) and self._send_forwarded(data, now_s):
            return  # the usual case
        waiting = self._sources.get(source)
        if waiting is None:
            waiting = self._sources[source] = _Source()
        queue = waiting.addressed if is_addressed else waiting.broadcast
        self.dropped += queue.add(data, now_s)
        self.drain(now_s)

    def drain(self, now_s: float) -> None:
        """Send what the link takes. Call every tick."""
        own, sources, budget = self._own, self._sources, self._budget
        if not (own.frames or sources):
            return
        oldest_s = now_s - self._stale_s
        self.dropped += own.drop_older(oldest_s)
        for number, source in list(sources.items()):
            self.dropped += source.drop_older(oldest_s)
            if not source.bytes:
                del sources[number]
        while own.frames:
            data = own.frames[0][1]
            if not self._send(data):
                return
            own.pop()
            if budget is not None:
                budget.spend(len(data) + self.overhead_bytes, now_s, is_own=True)
        while sources:
            number, source = next(iter(sources.items()))
            data = source.first.frames[0][1]
            if not self._send_forwarded(data, now_s):
                return
            source.first.pop()
            source.deficit_bytes -= len(data)
            if not source.bytes:
                del sources[number]
            elif source.deficit_bytes <= 0:
                source.deficit_bytes += _QUANTUM_BYTES
                sources[number] = sources.pop(number)

    def _send_forwarded(self, data: bytes, now_s: float) -> bool:
        budget = self._budget
        if budget is not None and not budget.may_send(now_s, is_own=False):
            return False
        if not self._send(data):
            return False
        if budget is not None:
            budget.spend(len(data), now_s, is_own=False)
        return True
