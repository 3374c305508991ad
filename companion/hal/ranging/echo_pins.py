"""Ultrasonic rangers with a trigger and an echo pin: HC-SR04 and JSN-SR04T.

A trigger pulse makes the part send eight cycles of 40 kHz; it then holds the echo pin high for the sound's
travel time. Range = c t / 2, with the speed of sound in dry air c = 331.3 sqrt(1 + T / 273.15) ≈ 331.3 +
0.606 T m/s, T in °C.
"""

import math
import threading
import time
from collections import deque
from collections.abc import Callable
from typing import Any, Final, NamedTuple, Protocol

from companion.core.errors import HardwareError

_ANSWER_S: Final = 0.02  # the echo pin rises within this, or the part is missing
_MEDIAN: Final = 3  # pings in one direction: the least that drops a single wrong one
_HELD_S: Final = 0.25  # longest time that a part without an echo holds the pin: 38 ms to 200 ms


class EchoChip(NamedTuple):
    """One kind. trigger_s: length of the pulse. period_s: between pings; the last one has died away."""

    trigger_s: float
    period_s: float


HCSR04: Final = EchoChip(10e-6, 0.06)  # data sheet of Elecfreaks
JSNSR04T: Final = EchoChip(20e-6, 0.1)  # at least 10 µs; without an echo it holds the pin for 60 ms


def speed_of_sound_m_s(air_c: float) -> float:
    """In air at this temperature in °C."""
    return 331.3 + 0.606 * air_c


class PinDevice(Protocol):
    """A gpiozero device with one pin."""

    @property
    def pin(self) -> Any: ...  # noqa: ANN401 — gpiozero's Pin, which has no types
    def close(self) -> None: ...


class EchoPinRanger:
    """Two gpiozero devices, timed by the edges' time stamps.

    trigger, echo: gpiozero GPIODevice; ticks_to_s: the pin factory's ticks_diff.
    """

    def __init__(
        self,
        trigger: PinDevice,
        echo: PinDevice,
        ticks_to_s: Callable[[float, float], float],
        max_range_m: float,
        air_c: float,
        chip: EchoChip = HCSR04,
    ) -> None:
        self.period_s = chip.period_s
        self._trigger_s = chip.trigger_s
        self._trigger = trigger
        self._echo = echo
        self._ticks_to_s = ticks_to_s
        self._sound_m_s = speed_of_sound_m_s(air_c)
        self._max_range_m = max_range_m
        self._longest_s = 2.0 * max_range_m / self._sound_m_s
        self._ranges_m: deque[float] = deque(maxlen=_MEDIAN)  # infinite without an echo
        self._edge_ticks: dict[bool, float] = {}  # rising: True
        self._has_fallen = threading.Event()
        trigger.pin.function = "output"
        trigger.pin.state = False
        echo.pin.edges = "both"
        echo.pin.bounce = None
        echo.pin.when_changed = self._on_edge

    def ping_m(self) -> float | None:
        """Range in metres, None without an echo in range; takes up to 20 ms plus the longest travel time. In
        one direction it is the median of three.
        Raises HardwareError: the echo pin is stuck high, or never rose: the part is missing.
        """
        self._has_fallen.clear()
        if self._echo.pin.state and not self._has_fallen.wait(_HELD_S):
            raise HardwareError("sonar: the echo pin is stuck high")
        self._edge_ticks.clear()
        self._has_fallen.clear()
        self._trigger.pin.state = True
        time.sleep(self._trigger_s)
        self._trigger.pin.state = False
        self._has_fallen.wait(_ANSWER_S + self._longest_s)
        rise, fall = self._edge_ticks.get(True), self._edge_ticks.get(False)
        if rise is None:
            raise HardwareError("sonar: no answer to the trigger; check power, trigger and echo wires")
        range_m = math.inf if fall is None else 0.5 * self._sound_m_s * self._ticks_to_s(fall, rise)
        self._ranges_m.append(range_m)
        if len(self._ranges_m) == _MEDIAN:
            range_m = sorted(self._ranges_m)[_MEDIAN // 2]
        return range_m if range_m <= self._max_range_m else None

    def forget(self) -> None:
        """Drop earlier pings: they were in another direction."""
        self._ranges_m.clear()

    def close(self) -> None:
        self._trigger.close()
        self._echo.close()

    def _on_edge(self, ticks: float, level: int) -> None:
        if level:
            self._edge_ticks[True] = ticks
        elif True in self._edge_ticks:  # otherwise the late end of an abandoned ping
            self._edge_ticks[False] = ticks
            self._has_fallen.set()
