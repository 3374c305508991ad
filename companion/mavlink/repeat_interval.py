"""The time after which an unanswered request is repeated, from measured round trips (RFC 6298).

A station that answers slowly, because it or the line is slow, is asked once. Only answers to requests that
were not repeated are measured (Karn's algorithm); any other lengthens the interval until the next one that
is. One request is repeated at a constant interval, for stations give up soon: QGroundControl 1.5 s after an
item, within which a quick station on a lossy line is asked five times.
"""

_SMOOTHING, _VARIATION = 1.0 / 8.0, 1.0 / 4.0  # RFC 6298, section 2.3
_DEVIATIONS = 4.0
# In first intervals, 0.5 s by default
_LEAST_MARGIN = 0.5  # beyond the round trip: RFC 6298's granularity, for what a station varies without notice
_LONGER = 1.3
_LONGEST = 2.8  # 1.4 s by default, within QGroundControl's patience


class RepeatInterval:
    """seconds: the present interval; first_s before anything was measured."""

    def __init__(self, first_s: float) -> None:
        self.seconds = first_s
        self._first_s = first_s
        self._smoothed_s: float | None = None
        self._variation_s = 0.0

    def measure(self, round_trip_s: float) -> None:
        """An answer to a request that was sent once."""
        if self._smoothed_s is None:
            self._smoothed_s, self._variation_s = round_trip_s, 0.5 * round_trip_s
        else:
            self._variation_s += _VARIATION * (abs(self._smoothed_s - round_trip_s) - self._variation_s)
            self._smoothed_s += _SMOOTHING * (round_trip_s - self._smoothed_s)
        self._set(self._smoothed_s + max(_LEAST_MARGIN * self._first_s, _DEVIATIONS * self._variation_s))

    def lengthen(self) -> None:
        """An answer to a request that was repeated: it may be slow, or the line has lost a message."""
        self._set(_LONGER * self.seconds)

    def _set(self, seconds: float) -> None:
        self.seconds = min(seconds, _LONGEST * self._first_s)
