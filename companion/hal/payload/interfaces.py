"""Interfaces of the payload's outputs. The drivers beside this file and the emulator satisfy them."""

from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import dataclass, field
from typing import Protocol


class Closable(Protocol):
    """A part to release."""

    def close(self) -> None:
        """Release it. May be called twice."""


class PayloadOutput(Protocol):
    """One output of the payload."""

    def write(self, value: float) -> None:
        """Set it. A servo: pulse width in µs, 0 without pulses. A pin: 1 on, 0 off. A winch: share of full
        speed, positive out. Never blocks.

        Raises:
            HardwareError: the output does not answer.
        """

    def close(self) -> None:
        """Set the state for the end of the program, then release the output. May be called twice."""


class PulseCounter(Protocol):
    """Counts the pulses of a switch, such as a winch's."""

    @property
    def count(self) -> int:
        """Pulses since it was opened."""

    def close(self) -> None:
        """Release the part. May be called twice."""


class OwnersProgram(Protocol):
    """A program outside the boat's own, which is started by it."""

    def start(self) -> str:
        """Start it; no effect while it runs. Never blocks.

        Returns the path of the file that it makes; empty if none.
        """

    def poll(self) -> str | None:
        """How a run has ended, told once: empty if well, otherwise what went wrong."""

    @property
    def is_running(self) -> bool:
        """Whether a run has not ended yet."""

    def end(self) -> None:
        """Begin to end it, without waiting."""

    def close(self) -> None:
        """End it, and wait for that. May be called twice."""


class Capture(OwnersProgram, Protocol):
    """A program that takes an image."""

    def space_mb(self) -> tuple[float, float]:
        """Size of the medium and free space on it, 0 and 0 if unknown, as last measured."""


@dataclass(frozen=True, slots=True)
class PayloadParts:
    """The opened payload, by the index of its `[[payload]]` table. capture: takes an image."""

    outputs: Mapping[int, PayloadOutput] = field(default_factory=dict)
    counters: Mapping[int, PulseCounter] = field(default_factory=dict)
    programs: Mapping[int, OwnersProgram] = field(default_factory=dict)
    capture: Capture | None = None

    def close(self) -> None:
        """Release all of them, even if one raises. May be called twice."""
        with ExitStack() as rest:
            parts: list[Closable] = [*self.outputs.values(), *self.counters.values()]
            for part in (*parts, *self.programs.values()):
                rest.callback(part.close)
            if self.capture is not None:
                rest.callback(self.capture.close)
            for program in self.programs.values():
                program.end()
