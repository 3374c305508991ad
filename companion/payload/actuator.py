"""One output of the payload: values written to it now and later, counted by the boat's clock.

A winch runs for a length of line, measured by time or by pulses.
"""

import math
from collections.abc import Iterable, Iterator
from typing import NamedTuple

from companion.config.payload import WinchPayload
from companion.core.units import clamp
from companion.hal.interfaces import PayloadOutput, PulseCounter
from companion.payload.actions import MoveWinch, WinchMotion

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


_SLACK_M = 1e-6  # rounding errors
_REVERSAL_S = 0.1  # at rest: the motor and the bridge stop first


class Winch(Actuator):
    """The output takes shares of full speed, positive out.

    out_m: line that is out; NaN until the line was wound in for the first time since the start.
    """

    def __init__(self, setting: WinchPayload, output: PayloadOutput, counter: PulseCounter | None) -> None:
        super().__init__(output)
        self.setting = setting
        self.out_m = math.nan
        self.stall_text = ""  # why the last motion ended early
        self._counter = counter
        # of the present motion, all unsigned but for the sign: 0 at rest
        self._sign = self._moved_m = self._limit_m = self._tick_s = self._pulse_s = 0.0
        self._pulses = 0
        self._is_homing = False  # ends with the line wound in

    @property
    def is_moving(self) -> bool:
        """Whether the winch runs."""
        return self._sign != 0.0

    @property
    def speed_m_s(self) -> float:
        """Of the line, positive out."""
        return self.value * self.setting.speed_m_s if self.is_moving else 0.0

    def move(self, action: MoveWinch, now_s: float) -> None:
        """Begin a motion, or stop."""
        match action.motion:
            case WinchMotion.LENGTH:
                share = self._share(math.copysign(action.rate_m_s or math.inf, action.length_m))
                limit_m = min(abs(action.length_m), self._left_m(share))
            case WinchMotion.RATE:
                share = self._share(action.rate_m_s)
                limit_m = self._left_m(share)
            case WinchMotion.RETRACT:
                share, limit_m = -1.0, self._left_m(-1.0)
            case _:
                share = limit_m = 0.0
        self._start(share if limit_m > 0.0 else 0.0, limit_m, now_s)
        self._is_homing = action.motion is WinchMotion.RETRACT

    def stop(self, now_s: float) -> None:
        self._start(0.0, 0.0, now_s)

    def tick(self, now_s: float) -> None:
        """Measure the line, and stop at the end of the motion."""
        super().tick(now_s)
        if not self.is_moving:
            return
        if self.fault:
            self.out_m = math.nan  # the motor did not do what is counted
        step_m = self._step_m(now_s)
        self._tick_s = now_s
        self._moved_m += step_m
        self.out_m += self._sign * step_m
        if self._moved_m >= self._limit_m - _SLACK_M:
            if self._is_homing:
                self.out_m = 0.0
            self.stop(now_s)
        elif self._counter is not None and now_s - self._pulse_s >= self.setting.stall_s:
            self.stop(now_s)
            self.stall_text = f"no pulse for {self.setting.stall_s:g} s, stopped"

    def _share(self, rate_m_s: float) -> float:
        """The share of full speed that the motor can give; a bridge knows only full speed."""
        share = clamp(rate_m_s / self.setting.speed_m_s, -1.0, 1.0)
        return share if self.setting.out_pin is None else _sign(share)

    def _left_m(self, share: float) -> float:
        """Line that may still move in this direction."""
        if math.isnan(self.out_m):
            return self.setting.line_m
        return max(self.setting.line_m - self.out_m if share > 0.0 else self.out_m, 0.0)

    def _step_m(self, now_s: float) -> float:
        """Line moved since the last tick."""
        counter = self._counter
        if counter is None:
            return abs(self.value) * self.setting.speed_m_s * (now_s - self._tick_s)
        before, self._pulses = self._pulses, counter.count
        if self._pulses != before:
            self._pulse_s = now_s
        return (self._pulses - before) * self.setting.pulse_m

    def _start(self, share: float, limit_m: float, now_s: float) -> None:
        self._sign, self._limit_m, self._moved_m = _sign(share), limit_m, 0.0
        self.stall_text = ""
        self._tick_s = self._pulse_s = now_s
        if self._counter is not None:
            self._pulses = self._counter.count
        stop = [TimedWrite(0.0, _REVERSAL_S)] if self.value * share < 0.0 else []
        self.run([*stop, TimedWrite(share)], now_s)


def _sign(value: float) -> float:
    return math.copysign(1.0, value) if value else 0.0
