"""Decides which of compass and gyro is faulty when they diverge.

The heading filter lets the compass correct the heading and the gyro bias, so a slowly drifting compass
corrupts both. This monitor propagates a second heading by the gyro alone, with the bias averaged over a
minute, and follows the compass only slowly. When the two headings differ too much, each predicts a velocity
over ground with the current and thrust gain from before the disagreement. The heading that explains the
measured velocity is right (the idea of a bank of filters, each with its own hypothesis: Y. Bar-Shalom, X. R.
Li, T. Kirubarajan, *Estimation with Applications to Tracking and Navigation*, 2001, section 11.6).
"""

import cmath
import math
from enum import Enum
from typing import Final

_HEADING_S: Final = 20.0  # time constant towards the compass,
_BIAS_S: Final = 60.0  # and towards the filter's bias; both shorter in the first minute
_LEAST_S: Final = 2.0
_YOUNG: Final = 0.7  # of its age
_DISAGREEMENT_RAD: Final = 0.12
_KEEP_S: Final = 4.0  # current and gain are kept from one to two of these periods ago
_TELLING_M_S: Final = 0.25  # least difference of the two predicted velocities that is informative
_HEAR_S: Final = 3.0
_ENOUGH_S: Final = 1.5
_CLEAR: Final = 0.35  # largest ratio of the better to the worse mean square error,
_WRONG_M_S: Final = 0.15  # and least error of the worse one
_GIVE_UP_S: Final = 120.0  # without a decision after this, the gyro is taken to be faulty


class HeadingVerdict(Enum):
    """The faulty sensor."""

    NOTHING = 0
    COMPASS = 1
    GYRO = 2


class HeadingConsistencyMonitor:
    """gap_rad: its heading less the filter's, clockwise. bias_rad_s: its gyro bias.

    current_m_s and gain: current and thrust gain from before the disagreement.
    """

    def __init__(self) -> None:
        self.current_m_s, self.gain = 0j, 1 + 0j
        self._newer = (0j, 1 + 0j)
        self._recorded_s = math.inf
        self.reset(0.0, 0.0)

    def reset(self, corrected_rad: float, bias_rad_s: float) -> None:
        """Follow the filter's present heading. corrected_rad: see `update`."""
        self._corrected_rad, self.bias_rad_s = corrected_rad, bias_rad_s
        self.gap_rad = self._age_s = 0.0
        self.is_disagreeing = False
        self._disagreement_s = self._evidence_s = self._compass_off = self._gyro_off = 0.0

    def record(self, current_m_s: complex, gain: complex, dt_s: float) -> None:
        """Record current and gain while the headings agree."""
        self._recorded_s += dt_s
        if self._recorded_s >= _KEEP_S and not self.is_disagreeing:
            first = self._recorded_s == math.inf
            self._recorded_s = 0.0
            self.current_m_s, self.gain = (current_m_s, gain) if first else self._newer
            self._newer = (current_m_s, gain)

    def update(self, corrected_rad: float, bias_rad_s: float, dt_s: float) -> None:
        """Advance by dt_s.

        corrected_rad: sum of the filter's compass corrections. bias_rad_s: the filter's gyro bias.
        """
        gap = self.gap_rad - (corrected_rad - self._corrected_rad) + (bias_rad_s - self.bias_rad_s) * dt_s
        self._corrected_rad = corrected_rad
        self._age_s += dt_s
        if not self.is_disagreeing:
            young_s = max(_YOUNG * self._age_s, _LEAST_S)
            gap -= min(dt_s / min(young_s, _HEADING_S), 1.0) * gap
            self.bias_rad_s += min(dt_s / min(young_s, _BIAS_S), 1.0) * (bias_rad_s - self.bias_rad_s)
            self.is_disagreeing = abs(gap) > _DISAGREEMENT_RAD
        self.gap_rad = gap

    def judge(self, over_ground: complex, through_water: complex, dt_s: float) -> HeadingVerdict:
        """Compare a measured velocity with both headings; through_water: by the filter's heading."""
        self._disagreement_s += dt_s
        bow = self.gain * through_water
        turned = bow * cmath.rect(1.0, self.gap_rad)
        if abs(turned - bow) > _TELLING_M_S:
            off = over_ground - self.current_m_s
            share = (
                min(dt_s / _HEAR_S, 1.0) if self._evidence_s > _HEAR_S else dt_s / (self._evidence_s + dt_s)
            )
            self._evidence_s += dt_s
            self._compass_off += share * (abs(off - bow) ** 2 - self._compass_off)
            self._gyro_off += share * (abs(off - turned) ** 2 - self._gyro_off)
        if self._evidence_s >= _ENOUGH_S:
            worst = max(self._compass_off, self._gyro_off)
            if worst > _WRONG_M_S * _WRONG_M_S and min(self._compass_off, self._gyro_off) < _CLEAR * worst:
                return HeadingVerdict.COMPASS if self._compass_off == worst else HeadingVerdict.GYRO
        return HeadingVerdict.GYRO if self._disagreement_s > _GIVE_UP_S else HeadingVerdict.NOTHING
