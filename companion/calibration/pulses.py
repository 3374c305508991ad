"""Pulse test of one thruster at rest: its dead band, and its thrust above it.

A pulse train alternates between no thrust and thrust. Thrust appears as a saw-tooth in the turn rate; wind
and the hull's own rotation appear as a smooth curve, here a cubic. A regression separates the two. Thrust
grows about with the square of the command above the dead band, and slightly less as the load slows the motor.
With s the root of a pulse's response and s₁ the largest root, the command is modelled as

    c = dead band + slope × (s + BEND s² / s₁)
"""

import math
from typing import Final, NamedTuple

from companion.calibration.routine import RoutineInputs, Step, come_back, rest
from companion.core.fitting import Fit
from companion.core.intent import Drive, Stop

LEVELS: Final = (0.08, 0.12, 0.16, 0.2, 0.25, 0.31, 0.4, 0.5)
BEND: Final = 0.4
_STOP: Final = Stop()
_HALF_S: Final = 1.5  # without thrust, then with thrust
_HALVES: Final = 5
_LAG_S: Final = 0.15  # until the shaft turns or stops
_SIGNAL: Final = 4.0  # standard deviations: a smaller response is taken for weather
_FEWEST: Final = 3
_AWAY_SHARE: Final = 0.3  # of the radius


class Thruster(NamedTuple):
    """One side, one way: 1 ahead, −1 astern."""

    left: float
    right: float

    def drive(self, level: float) -> Drive:
        """A command to this thruster alone."""
        return Drive(0.5 * (self.left + self.right) * level, 0.5 * (self.left - self.right) * level)

    @property
    def turn(self) -> float:
        """The sign of its turning moment."""
        return self.left - self.right


LEFT_AHEAD, RIGHT_AHEAD = Thruster(1.0, 0.0), Thruster(0.0, 1.0)
LEFT_ASTERN, RIGHT_ASTERN = Thruster(-1.0, 0.0), Thruster(0.0, -1.0)
THRUSTERS = (LEFT_AHEAD, RIGHT_AHEAD, LEFT_ASTERN, RIGHT_ASTERN)


class ThrustCurve(NamedTuple):
    """The model above. sigma: one standard deviation of the dead band."""

    dead_band: float
    slope: float
    root_max: float
    sigma: float

    def over(self, root: float) -> float:
        """The command above the dead band for a response with this root."""
        return self.slope * (root + BEND * root * root / self.root_max)


class PulseTest:
    """`sail` runs the pulses; `curve` evaluates them."""

    def __init__(self) -> None:
        self._answers: dict[Thruster, list[tuple[float, float, float]]] = {one: [] for one in THRUSTERS}

    def sail(self, inputs: RoutineInputs) -> Step[None]:
        """All levels of all four thrusters."""
        for level in LEVELS:
            for one in THRUSTERS:
                if inputs.off_m > _AWAY_SHARE * inputs.radius_m:
                    yield from come_back(inputs)
                    yield from rest(inputs, 1.0)
                yield from self._train(inputs, one, level)

    def _train(self, inputs: RoutineInputs, one: Thruster, level: float) -> Step[None]:
        fit, driven_s, drive = Fit(5), 0.0, one.drive(level)
        began_s = now_s = inputs.now_s
        while now_s - began_s < _HALVES * _HALF_S:
            is_on = bool(int((now_s - began_s) / _HALF_S) & 1)
            yield drive if is_on else _STOP
            if ((inputs.now_s - began_s - _LAG_S) // _HALF_S) % 2.0:
                driven_s += inputs.now_s - now_s
            now_s = inputs.now_s
            t = (now_s - began_s) / (_HALVES * _HALF_S)
            fit.add((driven_s, 1.0, t, t * t, t * t * t), one.turn * inputs.nav.yaw_rate_rad_s)
        if (solved := fit.solve()) is not None:
            self._answers[one].append((level, solved[0][0], solved[1]))

    def curve(self, one: Thruster) -> ThrustCurve | None:
        """The thrust curve; None if the thrust cannot be told from the weather."""
        told = [
            (level, math.sqrt(answer), sigma)
            for level, answer, sigma in self._answers[one]
            if answer > _SIGNAL * sigma
        ]
        if len(told) < _FEWEST:
            return None
        top, fit = max(root for _, root, _ in told), Fit(2)
        for level, root, sigma in told:
            fit.add((1.0, root + BEND * root * root / top), level, (root / sigma) ** 2)
        solved = fit.solve()
        if solved is None or not solved[0][1] > 0.0:
            return None
        return ThrustCurve(max(solved[0][0], 0.0), solved[0][1], top, solved[1])
