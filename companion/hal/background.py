"""A thread for a blocking part: sonar echoes, serial lines, I²C."""

import logging
import threading
from collections import deque
from collections.abc import Callable
from typing import Generic, Self, TypeVar

from companion.core.drain import drain
from companion.core.status_text import StatusText
from companion.links.retried import Backoff

_MOST_TEXTS = 8  # kept until the boat takes them

_log = logging.getLogger(__name__)
Reading = TypeVar("Reading")


class Background:
    """Calls `step` in a daemon thread until closed; step returns the seconds to wait before its next call.

    An exception in `step` is logged once and retried with a growing delay: a loose wire must not end the
    thread, and a part that recovers is read again.
    """

    def __init__(
        self,
        step: Callable[[], float],
        name: str,
        first_wait_s: float = 0.0,
        *,
        retry_s: float = 0.1,
        longest_retry_s: float = 2.0,
    ) -> None:
        """retry_s: first delay after a failure; it doubles up to longest_retry_s."""
        self._step = step
        self._name = name
        self._first_wait_s = first_wait_s
        self._retry = Backoff(first_s=retry_s, longest_s=longest_retry_s)
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)

    def start(self) -> None:
        """Begin to call `step`."""
        self._thread.start()

    def close(self) -> None:
        """Stop the thread and wait at most a second. May be called twice."""
        self._stop.set()
        if self._thread.is_alive() and self._thread is not threading.current_thread():
            self._thread.join(timeout=1.0)

    def _run(self) -> None:
        wait_s = self._first_wait_s
        is_well = True
        while not self._stop.wait(wait_s):
            try:
                wait_s = self._step()
            except Exception as error:
                if is_well:
                    _log.warning("%s: %s; trying again", self._name, error)
                wait_s, is_well = self._retry.failed(), False
            else:
                if not is_well:
                    _log.info("%s: answers again", self._name)
                self._retry.succeeded()
                is_well = True


class BackgroundSensor(Generic[Reading]):
    """A sensor that a thread reads; its latest reading is available without waiting."""

    def __init__(
        self,
        step: Callable[[], float],
        name: str,
        now: Callable[[], float],
        release: Callable[[], None] = lambda: None,
    ) -> None:
        """step: reads the part once, as for `Background`. release: releases the part, at every `close`."""
        self._now = now
        self._latest: Reading | None = None
        self._texts: deque[StatusText] = deque(maxlen=_MOST_TEXTS)
        self._background = Background(step, name)
        self._release = release

    def start(self) -> Self:
        """Begin to read in a thread."""
        self._background.start()
        return self

    def read(self) -> Reading | None:
        """The latest reading, None before the first."""
        return self._latest

    def notify(self, severity: int, text: str) -> None:
        """Tell the operator; called in the sensor's thread."""
        self._texts.append(StatusText(severity, text))

    def take_texts(self) -> list[StatusText]:
        return drain(self._texts)

    def close(self) -> None:
        self._background.close()
        self._release()
