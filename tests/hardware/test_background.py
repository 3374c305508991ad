"""The thread for parts that make their reader wait, and the waits between tries."""

import logging
import threading

import pytest
from patience import MOMENT_S

from companion.hal.background import Background


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
