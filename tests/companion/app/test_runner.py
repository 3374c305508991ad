import gc
import os
from collections.abc import Callable, Collection

import pytest
from fake_clock import FakeClock

from companion.app import garbage_collection as garbage
from companion.app.runner import Runner

PERIOD_S = 0.02


class Loop:
    """A runner over a fake clock; `work_s` says how long each tick takes."""

    def __init__(self, work_s: Callable[[int], float], *, skip_missed: bool = True) -> None:
        self.clock = FakeClock(100.0)
        self.began_s: list[float] = []
        self.numbers: list[int] = []
        self._work_s = work_s
        self.runner = Runner(
            self.clock, PERIOD_S, self.step, lambda ready: None, list, skip_missed=skip_missed
        )

    def step(self, number: int) -> None:
        self.began_s.append(self.clock.time_s - 100.0)
        self.numbers.append(number)
        self.clock.time_s += self._work_s(len(self.numbers) - 1)

    def run(self, ticks: int) -> "Loop":
        self.runner.run(lambda: len(self.numbers) >= ticks)
        return self


def test_ticks_come_at_their_times_however_long_the_work_takes_within_them() -> None:
    loop = Loop(lambda n: 0.001 + 0.01 * (n % 2)).run(500)
    assert loop.began_s == pytest.approx([n * PERIOD_S for n in range(500)], abs=1e-6)
    ticks = loop.runner.ticks
    assert (ticks.run, ticks.late, ticks.skipped) == (500, 0, 0)


def test_missed_ticks_are_skipped_and_counted_never_caught_up() -> None:
    loop = Loop(lambda n: 0.109 if n == 2 else 0.0).run(10)
    assert loop.runner.ticks.skipped == 4
    assert loop.numbers[:5] == [0, 1, 2, 7, 8]
    gaps = [after - before for before, after in zip(loop.began_s[3:], loop.began_s[4:], strict=False)]
    assert min(gaps) > PERIOD_S - 0.01


@pytest.mark.parametrize(("chunks", "heard"), [(3, 3), (1000, 200)])
def test_links_are_heard_between_ticks_but_a_flood_does_not_eat_the_loop(chunks: int, heard: int) -> None:
    (reader, writer), clock = os.pipe(), FakeClock(100.0)
    os.write(writer, bytes(chunks))
    order: list[str] = []

    def receive(ready: Collection[int]) -> None:
        assert list(ready) == [reader]
        os.read(reader, 1)
        order.append("receive")
        if len(order) == chunks + 1:
            clock.time_s += PERIOD_S  # silence for the rest of the tick

    runner = Runner(clock, PERIOD_S, lambda n: order.append("step"), receive, lambda: [reader])
    runner.run(lambda: order.count("step") == 2)
    os.close(reader)
    os.close(writer)
    assert order == ["step", *["receive"] * heard, "step"]
    assert clock.time_s == pytest.approx(100.0 + PERIOD_S)
    assert runner.ticks.late == 0


@pytest.mark.parametrize(
    ("left_s", "waiting", "generations"),
    [
        (0.018, (4_000, 0, 0), [0]),
        (0.018, (4_000, 20, 0), [1]),
        (0.018, (4_000, 20, 20), [2]),
        (0.006, (4_000, 20, 20), [1]),  # no time for the oldest
        (0.018, (3_999, 20, 20), []),
        (0.001, (4_000, 0, 0), []),
    ],
)
def test_many_are_swept_between_ticks_and_older_ones_more_seldom(
    monkeypatch: pytest.MonkeyPatch, left_s: float, waiting: tuple[int, ...], generations: list[int]
) -> None:
    seen: list[int] = []
    monkeypatch.setattr(gc, "get_count", lambda: waiting)
    monkeypatch.setattr(gc, "collect", seen.append)
    garbage.sweep(left_s)
    assert seen == generations
