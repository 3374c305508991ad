"""The server's one source of time; handed in, so that a test has its own."""

import time


class Clock:
    """The clock of the computer that the server runs on."""

    def now_s(self) -> float:
        """Seconds that never go back."""
        return time.monotonic()

    def unix_s(self) -> float:
        """The date, as seconds since 1970."""
        return time.time()
