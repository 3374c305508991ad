"""The real-time loop: a fixed tick, and an ear on the links between ticks.

A ground station that uploads item by item must not wait a tick for each answer, so the time left in a tick is
spent waiting for the links' descriptors. A tick that starts late is counted; whole ticks that were missed are
skipped, never caught up. A clock is read nowhere else.
"""

import select
import time
from collections.abc import Callable, Collection
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


class Runner:
    """Calls `step(number)` once a period and `receive(ready)` whenever a link has something in between.

    ready: the descriptors that have become readable. `receive` may return how many frames it took. Under a
    heavy stream of frames (a bridge between two fast links) they are left to gather for a millisecond, which
    costs less than waking up for each.
    """

    def __init__(
        self,
        clock: Clock,
        period_s: float,
        step: Callable[[int], None],
        receive: Callable[[Collection[int]], int | None],
        filenos: Callable[[], list[int]],
        *,
        skip_missed: bool = True,
        has_more: Callable[[], bool] = lambda: False,
    ) -> None:
        """skip_missed: False for the emulator, whose ticks are its time: it runs slow rather than skip.

        has_more: whether `receive` has left something behind, which no descriptor would tell.
        """
        self.ticks = TickCount()
        self.load = 0.0  # share of the period spent in `step`, smoothed over about a second
        self._clock = clock
        self._period_s = period_s
        self._step = step
        self._receive = receive
        self._filenos = filenos
        self._skip_missed = skip_missed
        self._has_more = has_more
        self._poll = select.poll()
        self._polled: list[int] = []
        self._ready: list[int] = []
        self._frames = 0  # taken in this period so far, or in the one before it

    def run(self, should_stop: Callable[[], bool]) -> None:
        """Run until told to stop. What `step` raises comes out here."""
        due_s = self._clock.now_s()
        number = 0
        while not should_stop():
            self._listen_until(due_s, should_stop)
            start_s = self._clock.now_s()
            late_s = start_s - due_s
            self.ticks.run += 1
            self.ticks.worst_s = max(self.ticks.worst_s, late_s)
            if late_s > LATE_S:
                self.ticks.late += 1
            self._step(number)
            self.load += 0.02 * ((self._clock.now_s() - start_s) / self._period_s - self.load)
            number += 1
            due_s += self._period_s
            missed = int((self._clock.now_s() - due_s) / self._period_s)
            if missed > 0:
                self.ticks.skipped += missed
                due_s += missed * self._period_s
                if self._skip_missed:
                    number += missed
            garbage.sweep(due_s - self._clock.now_s())

    def _listen_until(self, due_s: float, should_stop: Callable[[], bool]) -> None:
        is_busy, self._frames = self._frames > _BUSY_FRAMES, 0
        for _ in range(_MAX_RECEIVES):
            left_s = due_s - self._clock.now_s()
            if left_s <= 0.0 or should_stop():
                return
            has_more = self._has_more()
            if not (self._wait(0.0 if has_more else left_s) or has_more):
                return
            frames = self._receive(self._ready) or 0
            self._frames += frames
            if frames < _FEW_FRAMES and (is_busy or self._frames > _BUSY_FRAMES):
                self._clock.sleep(min(_GATHER_S, due_s - self._clock.now_s()))
        self._clock.sleep(due_s - self._clock.now_s())

    def _wait(self, seconds: float) -> bool:
        """Whether a link has something to say before the time is over."""
        filenos = self._filenos()
        if not filenos:
            self._clock.sleep(seconds)
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
        self._clock.sleep(min(seconds, 0.001))
        return False
