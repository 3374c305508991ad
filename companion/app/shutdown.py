"""Ctrl-C and SIGTERM as a question that a loop asks, so that every way out goes through the same doors."""

import signal
from types import FrameType


class Shutdown:
    """Remembers that a signal to stop has come. Asked like a function."""

    def __init__(self) -> None:
        self.signal_number = 0

    def install(self) -> None:
        """Take over SIGINT, SIGTERM and SIGHUP. A second signal is left to the system's own way."""
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, self._on_signal)

    def __call__(self) -> bool:
        """Whether it is time to stop."""
        return self.signal_number != 0

    def _on_signal(self, number: int, frame: FrameType | None) -> None:  # noqa: ARG002
        self.signal_number = number
        signal.signal(number, signal.SIG_DFL)
