"""Simulated payload: outputs and programs that record what they are given."""

import math
from collections import deque
from typing import NamedTuple

from companion.config.boat_config import BoatConfig
from companion.config.payload import CommandPayload, WinchPayload
from companion.core.errors import HardwareError
from companion.hal.interfaces import PayloadParts

RUN_S = 1.0  # time that a simulated program takes
_MEDIUM_MB, _IMAGE_MB = 16_000.0, 4.0


class Recorded(NamedTuple):
    """A value and its time."""

    time_s: float
    value: float


class SimOutput:
    """An output. history: every change of its value; fault: why it does not answer, empty if it does."""

    def __init__(self, clock: "SimPayload", title: str) -> None:
        self.title = title
        self.history: list[Recorded] = []
        self.fault = ""
        self.is_closed = False
        self._clock = clock

    @property
    def value(self) -> float:
        """The present value, NaN before the first."""
        return self.history[-1].value if self.history else math.nan

    def write(self, value: float) -> None:
        """Record it."""
        if self.fault:
            raise HardwareError(self.fault)
        if value == self.value:
            return
        self.history.append(Recorded(self._clock.time_s, value))
        self._clock.lines.append(f"{self.title}: {value:g}")

    def close(self) -> None:
        """Release it."""
        self.is_closed = True


class SimCounter:
    """The switch of a winch. is_stuck: it gives no more pulses."""

    def __init__(self, setting: WinchPayload, output: SimOutput) -> None:
        self.is_stuck = False
        self._setting = setting
        self._output = output
        self._moved_m = 0.0

    @property
    def count(self) -> int:
        """Pulses so far."""
        return int(self._moved_m / self._setting.pulse_m)

    def step(self, dt_s: float) -> None:
        """Let the winch run."""
        value = self._output.value
        if not self.is_stuck and math.isfinite(value):
            self._moved_m += abs(value) * self._setting.speed_m_s * dt_s

    def close(self) -> None:
        """Nothing to release."""


class SimProgram:
    """A program. starts: the times of its starts; outcome: what it reports, empty for success."""

    def __init__(self, clock: "SimPayload", title: str) -> None:
        self.title = title
        self.starts: list[float] = []
        self.outcome = ""
        self._clock = clock
        self._has_told = True

    @property
    def is_running(self) -> bool:
        """Whether its time is not over."""
        return bool(self.starts) and self._clock.time_s < self.starts[-1] + RUN_S

    def start(self) -> str:
        """Record the start."""
        if not self.is_running:
            self.starts.append(self._clock.time_s)
            self._has_told = False
            self._clock.lines.append(f"{self.title}: started")
        return ""

    def poll(self) -> str | None:
        """The end, once."""
        if self._has_told or self.is_running:
            return None
        self._has_told = True
        return self.outcome

    def end(self) -> None:
        """Nothing to end."""

    def close(self) -> None:
        """Nothing to release."""


class SimCapture(SimProgram):
    """A camera."""

    def start(self) -> str:
        """Record the start; the name of the image."""
        super().start()
        return f"image-{len(self.starts):05d}.jpg"

    def space_mb(self) -> tuple[float, float]:
        """An SD card that fills with images."""
        return _MEDIUM_MB, max(_MEDIUM_MB - _IMAGE_MB * len(self.starts), 0.0)


class SimPayload:
    """The payload of a configuration. Its parts are in `parts`, by the index of their table.

    lines: what was done lately, for a timeline to take.
    """

    def __init__(self, config: BoatConfig) -> None:
        self.time_s = 0.0
        self.lines: deque[str] = deque(maxlen=100)
        self.outputs: dict[int, SimOutput] = {}
        self.counters: dict[int, SimCounter] = {}
        self.programs: dict[int, SimProgram] = {}
        self.capture = SimCapture(self, "camera") if config.camera.capture else None
        for index, setting in enumerate(config.payload):
            if isinstance(setting, CommandPayload):
                self.programs[index] = SimProgram(self, setting.title)
                continue
            output = self.outputs[index] = SimOutput(self, setting.title)
            if isinstance(setting, WinchPayload) and setting.count_pin is not None:
                self.counters[index] = SimCounter(setting, output)
        self.parts = PayloadParts(self.outputs, self.counters, self.programs, self.capture)

    def step(self, now_s: float) -> None:
        """Time goes on."""
        dt_s, self.time_s = now_s - self.time_s, now_s
        for counter in self.counters.values():
            counter.step(dt_s)
