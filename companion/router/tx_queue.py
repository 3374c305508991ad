"""Frames that wait for room on a slow or full link: urgent ones first, old ones dropped."""

from collections import deque
from collections.abc import Callable

from companion.router.token_bucket import TokenBucket

MAX_BYTES = 16 * 1024  # for each of the two queues


class _Queue:
    def __init__(self) -> None:
        self.frames: deque[tuple[float, bytes]] = deque()  # oldest first, each with when it came
        self.bytes = 0

    def add(self, data: bytes, now_s: float) -> int:
        """Put a frame in; how many of the oldest had to go for it."""
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
    """Stands before a link that cannot take everything at once.

    Urgent frames (answers, commands, transfers) go as soon as the link takes them. Telemetry keeps to the
    budget. What has waited for stale_s is dropped and counted: an old attitude is worth nothing.
    """

    def __init__(self, send: Callable[[bytes], bool], budget: TokenBucket | None, stale_s: float) -> None:
        self.dropped = 0
        self.overhead_bytes = 0  # what `send` adds to each frame
        self._send = send
        self._budget = budget
        self._stale_s = stale_s
        self._urgent = _Queue()
        self._telemetry = _Queue()

    @property
    def waiting_bytes(self) -> int:
        """How much waits."""
        return self._urgent.bytes + self._telemetry.bytes

    def may_send(self, now_s: float) -> bool:
        """Whether telemetry would go out at once."""
        if self._urgent.frames or self._telemetry.frames:
            return False
        return self._budget is None or self._budget.may_send(now_s)

    def put(self, data: bytes, is_urgent: bool, now_s: float) -> None:
        """Send a frame, or let it wait."""
        queue = self._urgent if is_urgent else self._telemetry
        self.dropped += queue.add(data, now_s)
        self.drain(now_s)

    def drain(self, now_s: float) -> None:
        """Send what the link takes by now. To be called every tick."""
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
