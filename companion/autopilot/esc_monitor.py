"""What the speed controllers report, by side, and what of it the operator is told."""

from collections.abc import Sequence
from typing import Final

from companion.config.actuators import MotorsPart
from companion.core.readings import EscPair
from companion.core.state import MotorCommand
from companion.core.status_text import Severity, StatusText
from companion.hal.interfaces import EscTelemetry
from companion.sensors.silence import SilenceMonitor, fresh

_COOLER_C: Final = 5.0  # below the limit a hot one is cool again
_SWAPPED: Final = 10  # looks in a row, 1 s: both shafts have followed their commands by then


class EscMonitor:
    """readings: left and right, None while silent or not fitted."""

    def __init__(self, lines: Sequence[EscTelemetry]) -> None:
        self.readings: EscPair = (None, None)
        self._lines = lines
        self._monitors: list[tuple[SilenceMonitor, SilenceMonitor, SilenceMonitor]] = []
        self._are_hot = [False, False]
        self._swapped = 0

    def update(self, part: MotorsPart, command: MotorCommand, now_s: float, sides: int) -> list[StatusText]:
        """Read all; what is new for the operator. sides: 2 with a right motor, 1 without."""
        heard = {one.side: one for line in self._lines for one in line.read() or ()}
        left, right = (fresh(heard.get(side), part.telemetry_timeout_s, now_s) for side in (0, 1))
        self.readings = left, right
        self._monitors = self._monitors or [self._monitors_of(side) for side in range(sides)]
        told: list[StatusText | None] = [self._watch_sides(command)]
        for side, (silence, heat, fault) in enumerate(self._monitors):
            reading = self.readings[side]
            told.append(silence.update(part.telemetry_timeout_s, now_s, is_heard=reading is not None))
            if reading is None:
                continue
            limit_c = part.hot_c - _COOLER_C * self._are_hot[side]
            self._are_hot[side] = part.hot_c > 0.0 and reading.temperature_c > limit_c
            what = f"is hot: {reading.temperature_c:.0f} C"
            told.append(heat.update(0.0, now_s, is_heard=not self._are_hot[side], what=what))
            told.append(fault.update(0.0, now_s, is_heard=not reading.fault, what=f"reports {reading.fault}"))
        return [one for one in told if one is not None]

    def _monitors_of(self, side: int) -> tuple[SilenceMonitor, SilenceMonitor, SilenceMonitor]:
        name = ("Left ESC", "Right ESC")[side]
        silence = SilenceMonitor(name, self._lines[min(side, len(self._lines) - 1)])
        return silence, SilenceMonitor(name, again="is cool again"), SilenceMonitor(name, again="works again")

    def _watch_sides(self, command: MotorCommand) -> StatusText | None:
        """One motor is driven, and the other controller says that its motor turns, as in a motor test."""
        left, right = self.readings
        is_crossed = False
        if left is not None and right is not None and (not command.left) != (not command.right):
            driven, idle = (left, right) if command.left else (right, left)
            is_crossed = not driven.shaft_rad_s and bool(idle.shaft_rad_s)
        self._swapped = self._swapped + 1 if is_crossed else 0
        if self._swapped != _SWAPPED:
            return None
        return StatusText(Severity.WARNING, "ESC telemetry: left and right are swapped")
