"""The cycle collector, and when it may work."""

import gc
from collections.abc import Callable

import pytest

from companion.app import garbage_collection as garbage

LONG_S = 0.018


@pytest.fixture
def swept(monkeypatch: pytest.MonkeyPatch) -> Callable[..., list[int]]:
    """Sweep with so many objects of each generation waiting; the generations that were looked at."""
    seen: list[int] = []

    def sweep(left_s: float, *waiting: int) -> list[int]:
        seen.clear()
        monkeypatch.setattr(gc, "get_count", lambda: waiting)
        monkeypatch.setattr(gc, "collect", seen.append)
        garbage.sweep(left_s)
        return list(seen)

    return sweep


def test_many_are_swept_between_ticks_and_older_ones_more_seldom(swept: Callable[..., list[int]]) -> None:
    assert swept(LONG_S, 4_000, 0, 0) == [0]
    assert swept(LONG_S, 4_000, 20, 0) == [1]
    assert swept(LONG_S, 4_000, 20, 20) == [2]


def test_nothing_is_swept_for_which_the_tick_has_no_time_left(swept: Callable[..., list[int]]) -> None:
    assert swept(0.001, 100_000, 20, 20) == []
    assert swept(-1.0, 100_000, 20, 20) == []
    assert swept(0.003, 4_000, 20, 20) == [0]
    assert swept(0.006, 4_000, 20, 20) == [1]
