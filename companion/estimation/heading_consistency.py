"""A second opinion on the heading, for the day when compass and gyro part: which of the two has gone wrong?

The heading filter lets the compass draw the heading in and teach the gyro its bias, so that a compass that
turns away slowly takes all along with it. The witness goes by the gyro alone, with the bias of a minute, and
follows the compass only slowly. Once the two are too far apart they are heard against a third: the velocity
over ground, with the set of the water and the worth of thrust as they were before the quarrel. The heading
that explains it is right (the idea of a bank of filters, each with a hypothesis of its own: Y. Bar-Shalom,
X. R. Li, T. Kirubarajan, *Estimation with Applications to Tracking and Navigation*, 2001, section 11.6).
"""

import cmath
import math
from enum import Enum
from typing import Final

_HEADING_S: Final = 20.0  # how slowly the witness follows the compass,
_BIAS_S: Final = 60.0  # and the bias that the compass teaches; both less in the first minute
_LEAST_S: Final = 2.0
_YOUNG: Final = 0.7  # of its age
_DISAGREEMENT_RAD: Final = 0.12
_KEEP_S: Final = 4.0  # set and gain are remembered from one to two of these ago
_TELLING_M_S: Final = 0.25  # apart, in what the two headings say of the velocity
_HEAR_S: Final = 3.0
_ENOUGH_S: Final = 1.5
_CLEAR: Final = 0.35  # share of the other's square error that the better one may have
_WRONG_M_S: Final = 0.15  # and how far off the other one must be
_GIVE_UP_S: Final = 120.0  # without way nobody can tell


class HeadingVerdict(Enum):
    """What the witness has to say."""

    NOTHING = 0
    COMPASS = 1  # it is the compass that has gone wrong,
    GYRO = 2  # or the gyro


class HeadingConsistencyMonitor:
    """gap_rad: by how much its heading lies clockwise of the filter's. bias_rad_s: the gyro's, as it has it.

    current_m_s and gain: of the water and of thrust, as they were before a quarrel began.
    """

    __slots__ = (
        "_age_s",
        "_compass_off",
        "_corrected_rad",
        "_disagreement_s",
        "_evidence_s",
        "_gyro_off",
        "_newer",
        "_recorded_s",
        "bias_rad_s",
        "current_m_s",
        "gain",
        "gap_rad",
        "is_disagreeing",
    )  # fmt: skip

    def __init__(self) -> None:
        self.current_m_s, self.gain = 0j, 1 + 0j
        self._newer = (0j, 1 + 0j)
        self._recorded_s = math.inf
        self.reset(0.0, 0.0)

    def reset(self, corrected_rad: float, bias_rad_s: float) -> None:
        """Go along with the filter as it is now. drawn_rad: see `update`."""
        self._corrected_rad, self.bias_rad_s = corrected_rad, bias_rad_s
        self.gap_rad = self._age_s = 0.0
        self.is_disagreeing = False
        self._disagreement_s = self._evidence_s = self._compass_off = self._gyro_off = 0.0

    def record(self, current_m_s: complex, gain: complex, dt_s: float) -> None:
        """Remember set and gain while all is well."""
        self._recorded_s += dt_s
        if self._recorded_s >= _KEEP_S and not self.is_disagreeing:
            first = self._recorded_s == math.inf
            self._recorded_s = 0.0
            self.current_m_s, self.gain = (current_m_s, gain) if first else self._newer
            self._newer = (current_m_s, gain)

    def update(self, corrected_rad: float, bias_rad_s: float, dt_s: float) -> None:
        """Go on by dt_s.

        drawn_rad: how far the compass has drawn the filter's heading in all. bias_rad_s: the gyro's, as the
        filter has it.
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
        """Hear a velocity over ground, in a quarrel; through_water: as the filter's heading has it."""
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
