"""Queue of frames for a slow or full link: urgent ones first, stale ones dropped."""

from collections import deque
from collections.abc import Callable

from companion.router.token_bucket import TokenBucket

MAX_BYTES = 16 * 1024  # per queue


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


class TxQueue:
    """Queue before a link that cannot take everything at once.

    Urgent frames (answers, commands, transfers) are sent as soon as the link takes them. Telemetry respects
    the rate limit. Frames that have waited for stale_s are dropped and counted.
    """

    def __init__(self, send: Callable[[bytes], bool], budget: TokenBucket | None, stale_s: float) -> None:
        self.dropped = 0
        self.overhead_bytes = 0  # added to each frame by `send`
        self._send = send
        self._budget = budget
        self._stale_s = stale_s
        self._urgent = _Queue()
        self._telemetry = _Queue()

    @property
    def waiting_bytes(self) -> int:
        """Bytes in the queue."""
        return self._urgent.bytes + self._telemetry.bytes

    def may_send(self, now_s: float) -> bool:
        """Whether telemetry would be sent at once."""
        if self._urgent.frames or self._telemetry.frames:
            return False
        return self._budget is None or self._budget.may_send(now_s)

    def put(self, data: bytes, is_urgent: bool, now_s: float) -> None:
        """Send or queue a frame."""
        queue = self._urgent if is_urgent else self._telemetry
        self.dropped += queue.add(data, now_s)
        self.drain(now_s)

    def drain(self, now_s: float) -> None:
        """Send what the link takes. Call every tick."""
        oldest_s = now_s - self._stale_s
        self.dropped += self._urgent.drop_older(oldest_s) + self._telemetry.drop_older(oldest_s)
        if self._drain(self._urgent, now_s, keeps_to_budget=False):
            self._drain(self._telemetry, now_s, keeps_to_budget=True)

    def _drain(self, queue: _Queue, now_s: float, keeps_to_budget: bool) -> bool:
        budget = self._budget
        while queue.frames:
            if keeps_to_budget and budget is not None and not budget.may_send(now_s):
                return False
            data = queue.frames[0][1]
            if not self._send(data):
                return False
            queue.pop()
            if budget is not None:
                budget.spend(len(data) + self.overhead_bytes, now_s)
        return True
