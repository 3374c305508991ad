"""Growing delay between retries."""


class Backoff:
    """Delays that double from first_s to longest_s. Time is an argument."""

    def __init__(self, first_s: float = 0.5, longest_s: float = 8.0) -> None:
        self._first_s = first_s
        self._longest_s = longest_s
        self._delay_s = first_s
        self._due_s = float("-inf")

    def is_due(self, now_s: float) -> bool:
        """Whether the next attempt is due."""
        return now_s >= self._due_s

    def failed(self, now_s: float = 0.0) -> float:
        """Schedule the next attempt; returns the delay in seconds."""
        delay_s = self._delay_s
        self._due_s = now_s + delay_s
        self._delay_s = min(2.0 * delay_s, self._longest_s)
        return delay_s

    def succeeded(self) -> None:
        """Reset to the shortest delay."""
        self._delay_s = self._first_s
        self._due_s = float("-inf")
