"""The real-time loop: a fixed tick, and an ear on the links between ticks.

A ground station that uploads item by item must not wait a tick for each answer, so the time left in a tick is
spent waiting for the links' descriptors. A tick that starts late is counted; whole ticks that were missed are
skipped, never caught up. A clock is read nowhere else.
"""

import select
import time
from collections.abc import Callable, Collection
from dataclasses import KW_ONLY, dataclass, field
from typing import Protocol

from companion.app import garbage_collection as garbage
from companion.core.tick_count import TickCount

LATE_S = 0.005
_MAX_RECEIVES = 200  # between two ticks: a flood of bytes must not eat the loop
_BUSY_FRAMES = 60  # in one period; from there on it pays to let frames gather instead of waking for each
_FEW_FRAMES = 20  # at once; with more there is no need to wait for others
_GATHER_S = 0.001


class Clock(Protocol):
    """Time as the boat counts it, and a way to wait."""

    def now_s(self) -> float:
        """Seconds since boot; never goes back."""

    def sleep(self, seconds: float) -> None:
        """Wait these seconds."""


class SystemClock:
    """Monotonic seconds since the clock was made."""

    def __init__(self) -> None:
        self._start_s = time.monotonic()

    def now_s(self) -> float:
        return time.monotonic() - self._start_s

    def sleep(self, seconds: float) -> None:
        """Wait; a time in the past is no wait."""
        if seconds > 0.0:
            time.sleep(seconds)

    def unix_offset_s(self) -> float:
        """What to add to `now_s` for the date; 0 while the computer's own date is plainly unset."""
        unix_s = time.time()
        return unix_s - self.now_s() if unix_s > 1.6e9 else 0.0


@dataclass(eq=False)
class Runner:
    """Calls `step(number)` once a period and `receive(ready)` whenever a link has something in between.

    ready: the descriptors that have become readable. `receive` may return how many frames it took. Under a
    heavy stream of frames (a bridge between two fast links) they are left to gather for a millisecond, which
    costs less than waking up for each. skip_missed: False for the emulator, whose ticks are its time: it runs
    slow rather than skip. has_more: whether `receive` has left something behind, which no descriptor tells.
    """

    clock: Clock
    period_s: float
    step: Callable[[int], None]
    receive: Callable[[Collection[int]], int | None]
    filenos: Callable[[], list[int]]
    _: KW_ONLY
    skip_missed: bool = True
    has_more: Callable[[], bool] = lambda: False
    ticks: TickCount = field(default_factory=TickCount, init=False)
    load: float = field(default=0.0, init=False)  # share of the period spent in `step`, over about a second
    _poll: select.poll = field(default_factory=select.poll, init=False)
    _polled: list[int] = field(default_factory=list, init=False)
    _ready: list[int] = field(default_factory=list, init=False)
    _frames: int = field(default=0, init=False)  # taken in this period so far, or in the one before it

    def run(self, should_stop: Callable[[], bool]) -> None:
        """Run until told to stop. What `step` raises comes out here."""
        due_s = self.clock.now_s()
        number = 0
        while not should_stop():
            self._listen_until(due_s, should_stop)
            start_s = self.clock.now_s()
            late_s = start_s - due_s
            self.ticks.run += 1
            self.ticks.worst_s = max(self.ticks.worst_s, late_s)
            if late_s > LATE_S:
                self.ticks.late += 1
            self.step(number)
            self.load += 0.02 * ((self.clock.now_s() - start_s) / self.period_s - self.load)
            number += 1
            due_s += self.period_s
            missed = int((self.clock.now_s() - due_s) / self.period_s)
            if missed > 0:
                self.ticks.skipped += missed
                due_s += missed * self.period_s
                if self.skip_missed:
                    number += missed
            garbage.sweep(due_s - self.clock.now_s())

    def _listen_until(self, due_s: float, should_stop: Callable[[], bool]) -> None:
        is_busy, self._frames = self._frames > _BUSY_FRAMES, 0
        for _ in range(_MAX_RECEIVES):
            left_s = due_s - self.clock.now_s()
            if left_s <= 0.0 or should_stop():
                return
            has_more = self.has_more()
            if not (self._wait(0.0 if has_more else left_s) or has_more):
                return
            frames = self.receive(self._ready) or 0
            self._frames += frames
            if frames < _FEW_FRAMES and (is_busy or self._frames > _BUSY_FRAMES):
                self.clock.sleep(min(_GATHER_S, due_s - self.clock.now_s()))
        self.clock.sleep(due_s - self.clock.now_s())

    def _wait(self, seconds: float) -> bool:
        """Whether a link has something to say before the time is over."""
        filenos = self.filenos()
        if not filenos:
            self.clock.sleep(seconds)
            return False
        if filenos != self._polled:
            self._polled = filenos
            self._poll = select.poll()
            for fileno in filenos:
                self._poll.register(fileno, select.POLLIN)
        # poll counts in whole milliseconds: wait for all but the last, then sleep the rest
        self._ready = [fileno for fileno, _ in self._poll.poll(int(seconds * 1e3))]
        if self._ready:
            return True
        self.clock.sleep(min(seconds, 0.001))
        return False
