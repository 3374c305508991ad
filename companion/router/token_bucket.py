"""Rate limits of a slow line."""

_BURST_S = 0.2  # largest saving
_DEBT_S = 1.0  # largest debt, from urgent frames
_LEAST_SHARE = 0.1
_FULL_SPEED = 1.0
_RESERVED_SHARE = 0.5  # twice what the default telemetry, 1.1 kB/s, takes of 57,600 baud

# SiK radios report their free buffer in percent about once a second. The bounds and steps keep it between
# 20 and 90 percent free, so that it neither overflows nor runs empty.
_STEPS = ((20, 0.6), (50, 0.85), (90, 1.0), (101, 1.25))


class TokenBucket:
    """A token bucket at the line's rate. Whoever does not ask first may overdraw it; the others then wait.

    The radio's reports can reduce the rate, never raise it above the nominal one.
    """

    def __init__(self, bytes_s: float) -> None:
        self.share = _FULL_SPEED  # of bytes_s
        self._bytes_s = bytes_s
        self._left = bytes_s * _BURST_S
        self._filled_s: float | None = None

    def may_send(self, now_s: float) -> bool:
        """Whether a message of the usual size may be sent."""
        self._fill(now_s)
        return self._left > 0.0

    def spend(self, count: int, now_s: float) -> None:
        """Account for sent bytes."""
        self._fill(now_s)
        self._left = max(self._left - count, -self._bytes_s * _DEBT_S)

    def on_radio_status(self, free_percent: int) -> None:
        """Adapt the rate to the free transmit buffer."""
        step = next((step for bound, step in _STEPS if free_percent < bound), _FULL_SPEED)
        self.share = min(max(self.share * step, _LEAST_SHARE), _FULL_SPEED)

    def _fill(self, now_s: float) -> None:
        if self._filled_s is not None and now_s > self._filled_s:
            rate = self._bytes_s * self.share
            self._left = min(self._left + rate * (now_s - self._filled_s), rate * _BURST_S)
        self._filled_s = now_s


class LineBudget:
    """Rate limit of a line for the boat's own and for forwarded frames.

    Each may use what the other leaves. A share of the line is reserved for the boat's own, whatever others
    forward.
    """

    def __init__(self, bytes_s: float) -> None:
        self._line = TokenBucket(bytes_s)
        self._reserved = TokenBucket(_RESERVED_SHARE * bytes_s)

    def may_send_own(self, now_s: float) -> bool:
        """Whether the boat's telemetry may be sent."""
        return self._line.may_send(now_s) or self._reserved.may_send(now_s)

    def may_forward(self, now_s: float) -> bool:
        """Whether a frame of another channel may be sent."""
        return self._line.may_send(now_s)

    def spend_own(self, count: int, now_s: float) -> None:
        """Account for sent bytes of our own."""
        self._line.spend(count, now_s)
        self._reserved.spend(count, now_s)

    def spend_forwarded(self, count: int, now_s: float) -> None:
        """Account for sent bytes of another channel."""
        self._line.spend(count, now_s)

    def on_radio_status(self, free_percent: int) -> None:
        """Adapt the rate to the radio's free transmit buffer."""
        self._line.on_radio_status(free_percent)
        self._reserved.on_radio_status(free_percent)
