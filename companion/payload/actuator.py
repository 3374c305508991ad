"""One output of the payload: values written to it now and later, counted by the boat's clock."""

import math
from collections.abc import Iterable, Iterator
from typing import NamedTuple

from companion.hal.payload.interfaces import PayloadOutput

_REFRESH_S = 1.0  # a servo chip whose supply has dipped has lost its signals
_SLACK_S = 1e-6  # rounding errors of the clock


class TimedWrite(NamedTuple):
    """A value, and how long until the next one."""

    value: float
    hold_s: float = math.inf


class Actuator:
    """Writes a plan of values. value: the latest one; NaN before the first.

    fault: why the output did not take it, empty if it did. The value is written again every second.
    """

    def __init__(self, output: PayloadOutput, max_on_s: float = 0.0) -> None:
        """max_on_s: longest time at 1 without a break, whatever the plan; then 0 is written. 0: no limit."""
        self.value = math.nan
        self.fault = ""
        self._output = output
        self._plan: Iterator[TimedWrite] = iter(())
        self._due_s = math.inf
        self._refresh_s = math.inf
        self._max_on_s = max_on_s or math.inf
        self._on_s = math.inf  # since when it is at 1

    def run(self, plan: Iterable[TimedWrite], now_s: float) -> None:
        """Replace the plan, and write its first value."""
        self._plan, self._due_s = iter(plan), now_s
        self.tick(now_s)

    def tick(self, now_s: float) -> None:
        """Write what is due, one value at most."""
        if now_s - self._on_s >= self._max_on_s:
            self._due_s = math.inf
            self._write(0.0, now_s)
        if now_s + _SLACK_S >= self._due_s:
            write = next(self._plan, None)
            if write is None:
                self._due_s = math.inf
            else:
                self._due_s += write.hold_s
                self._write(write.value, now_s)
                return
        if now_s >= self._refresh_s:
            self._write(self.value, now_s)

    def _write(self, value: float, now_s: float) -> None:
        self.value = value
        self._on_s = min(self._on_s, now_s) if value == 1.0 else math.inf
        self._refresh_s = now_s + _REFRESH_S
        try:
            self._output.write(value)
        except OSError as error:  # a HardwareError, or the bus
            self.fault = str(error)
        else:
            self.fault = ""


def alternate(first: float, second: float, count: int, period_s: float) -> Iterator[TimedWrite]:
    """First and second value for half a period each, count times."""
    for _ in range(count):
        yield TimedWrite(first, 0.5 * period_s)
        yield TimedWrite(second, 0.5 * period_s)
