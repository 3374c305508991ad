"""A clock for real-time loops in tests."""


class FakeClock:
    """Time that passes only when somebody waits, or sets it."""

    def __init__(self, time_s: float = 0.0) -> None:
        self.time_s = time_s

    def now_s(self) -> float:
        """The time."""
        return self.time_s

    def sleep(self, seconds: float) -> None:
        """Let it pass."""
        self.time_s += max(seconds, 0.0)
