"""The thread for parts that make their reader wait, and the waits between tries."""

import logging
import threading

import pytest
from hypothesis import given
from hypothesis import strategies as st
from patience import MOMENT_S

from companion.hal.background import Background
from companion.links.retried import Backoff


@pytest.mark.realtime
def test_a_step_that_raises_is_logged_once_and_tried_again(caplog: pytest.LogCaptureFixture) -> None:
    calls, is_done = list[int](), threading.Event()

    def step() -> float:
        calls.append(len(calls))
        if len(calls) <= 2:
            raise OSError("wire is loose")
        is_done.set()
        return 10.0

    background = Background(step, "compass")
    with caplog.at_level(logging.INFO):
        background.start()
        assert is_done.wait(MOMENT_S)
        background.close()
        background.close()
    assert [record.getMessage() for record in caplog.records] == [
        "compass: wire is loose; trying again",
        "compass: answers again",
    ]
    assert len(calls) == 3


@given(st.lists(st.floats(0.0, 100.0), max_size=20))
def test_waits_double_up_to_the_longest_and_start_over_after_a_success(moments: list[float]) -> None:
    backoff = Backoff(first_s=0.5, longest_s=8.0)
    expected_s = 0.5
    for now_s in moments:
        assert backoff.failed(now_s) == expected_s
        assert not backoff.is_due(now_s + 0.99 * expected_s)
        assert backoff.is_due(now_s + 1.01 * expected_s)
        expected_s = min(2.0 * expected_s, 8.0)
    backoff.succeeded()
    assert backoff.is_due(0.0)
    assert backoff.failed(0.0) == 0.5
