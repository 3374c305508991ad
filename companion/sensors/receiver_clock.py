"""Time of measurement of a fix, from the receiver's time of day.

A driver knows the arrival time. The receiver reports the time of day of the measurement, by an independent
clock. Arrival time less time of day is the clock offset plus the delay of that fix; its minimum over the last
minutes is the offset plus the shortest delay, as delays are positive (D. L. Mills et al., RFC 5905, section
10: the clock filter, which trusts the sample of least delay). The excess over the minimum is the additional
delay of a fix. The shortest delay cannot be observed and is configured.
"""

import math
from typing import Final

import msgspec

from companion.core.readings import GnssFix

DAY_S: Final = 86_400.0
# A crystal is good to 50 ppm (0.003 %): within two windows the clocks drift by 6 ms at most.
WINDOW_S: Final = 60.0
# A larger delay is a clock step, as by the 18 leap seconds that a cold receiver learns.
LATEST_S: Final = 3.0
EARLIEST_S: Final = 1.0  # likewise, for fixes earlier than all others
# A delay beyond that of a serial line varies; a constant one is a clock step:
LATE_S: Final = 0.5
SAME_S: Final = 0.2
AGREE: Final = 10  # in a row: 2 s at 5 Hz, 10 s at 1 Hz


class ReceiverClock:
    """latency_s: shortest time from measurement to arrival. window_s: in which one of the delays is it."""

    def __init__(self, latency_s: float, window_s: float = WINDOW_S) -> None:
        self._latency_s = latency_s
        self._window_s = window_s
        self._last_time_of_day_s = math.nan
        self._outliers, self._outlier_s = (
            0,
            0.0,
        )  # how many fixes in a row were odd, and how late the latest of them
        self._offset_s = self._since_s = math.nan
        self._least_s = self._before_s = math.inf

    def stamp(self, fix: GnssFix) -> GnssFix:
        """The fix with the time of its measurement in place of its arrival."""
        return msgspec.structs.replace(fix, time_s=self.measured_s(fix.time_of_day_s, fix.time_s))

    def measured_s(self, time_of_day_s: float | None, arrival_s: float) -> float:
        """The boat's time of a measurement; without a usable time of day, the shortest delay is assumed."""
        if (
            time_of_day_s is None or time_of_day_s == self._last_time_of_day_s
        ):  # a faulty receiver repeats its time
            return arrival_s - self._latency_s
        self._last_time_of_day_s = time_of_day_s
        offset_s = arrival_s - time_of_day_s
        # How much later than by _offset_s, around midnight too
        late_s = (offset_s - self._offset_s + 0.5 * DAY_S) % DAY_S - 0.5 * DAY_S
        if self._is_other_clock(late_s):
            self._offset_s, self._since_s, self._outliers = offset_s, arrival_s, 0
            self._least_s = self._before_s = math.inf
            late_s = 0.0
        least_s = min(self._least_s, self._before_s)
        if not least_s - EARLIEST_S <= late_s <= least_s + LATEST_S and least_s < math.inf:
            return arrival_s - self._latency_s
        if arrival_s - self._since_s >= self._window_s:
            self._before_s, self._least_s, self._since_s = self._least_s, late_s, arrival_s
        self._least_s = min(self._least_s, late_s)
        return arrival_s - self._latency_s - (late_s - min(self._least_s, self._before_s))

    def _is_other_clock(self, late_s: float) -> bool:
        """Whether one of the two clocks was stepped."""
        if math.isnan(late_s):
            return True
        least_s = min(self._least_s, self._before_s)
        if least_s - EARLIEST_S <= late_s <= least_s + LATE_S:
            self._outliers = 0  # number of consecutive outliers, and the delay of the latest
            return False
        self._outliers = (
            self._outliers + 1 if self._outliers and abs(late_s - self._outlier_s) < SAME_S else 1
        )
        self._outlier_s = late_s
        return self._outliers >= AGREE
