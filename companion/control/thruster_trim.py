"""From the thrust that the gate lets through to what each motor is told, by what was measured of it.

Everything before thinks of two equal thrusters that answer from nought on, ahead as astern: with s the share
of thrust, d the dead band, g the side's gain and a the asymmetry (1 ahead), a motor is told

    d + (1 − d) g min(a |s|, 1)        with the sign of s; nothing for nothing

Below FAINT the dead band is taken in proportion, so that a share which trembles about nought does not make
the motor jump from side to side.
"""

from typing import Final

from companion.config.thrusters import Thrusters
from companion.core.state import MotorCommand

FAINT: Final = 0.01

_PLAIN: Final = Thrusters()


class ThrusterTrim:
    """`left` and `right` are what the motors are told, −1..1; `update` works them out."""

    __slots__ = ("_is_plain", "_setting", "left", "right")

    def __init__(self) -> None:
        self.left = self.right = 0.0
        self._setting = _PLAIN
        self._is_plain = True

    def update(self, command: MotorCommand, setting: Thrusters, *, is_bare: bool = False) -> None:
        """Take the gate's command. is_bare: hand it on as it is, for whoever measures the motors."""
        if setting is not self._setting:
            self._setting, self._is_plain = setting, setting == _PLAIN
        left, right = command.left, command.right
        if not (self._is_plain or is_bare):
            more = setting.asymmetry
            left = told(left, setting.left_ahead, setting.left_astern, setting.left_gain, more)
            right = told(right, setting.right_ahead, setting.right_astern, setting.right_gain, more)
        self.left, self.right = left, right


def told(share: float, ahead: float, astern: float, gain: float, asymmetry: float) -> float:
    """What one motor is told for a share of thrust: see the text above. NaN becomes nought."""
    if share > 0.0:
        size, dead = min(share, 1.0), ahead
    elif share < 0.0:
        size, dead = min(-share * asymmetry, 1.0), astern
    else:
        return 0.0
    if size < FAINT:
        dead *= size / FAINT
    size = dead + (1.0 - dead) * gain * size
    return size if share > 0.0 else -size


def share_of(told_share: float, dead_band: float, gain: float) -> float:
    """The share of thrust ahead for which a motor is told this much: the inverse of `told`, for positive."""
    return max(told_share - dead_band, 0.0) / ((1.0 - dead_band) * gain)
