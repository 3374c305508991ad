"""Converts NMEA 0183 sentences to headings.

Field meanings: v4.11 (HDT, THS, HDG, HDM, ROT); HPR is common among receivers with two antennas.
"""

import math

from companion.core.readings import HeadingReading
from companion.core.units import wrap_pi
from companion.sensors.nmea.sentences import Sentence

TRUE_SENTENCES = frozenset({"HDT", "THS", "HPR", "ROT"})
"""Those of a receiver with two antennas."""
HEADING_SENTENCES = TRUE_SENTENCES | {"HDG", "HDM"}

_PRECEDENCE_S = 2.0
_RATE_LIFE_S = 1.0
_FIXED = 4  # quality of an HPR, as of a GGA: carrier-phase ambiguities resolved
_TRUE, _CORRECTED, _MAGNETIC = 3, 2, 1


class HeadingAssembler:
    """Converts sentences to readings; correction_rad is added to every heading.

    HDT, THS and HPR are true headings. HDG is magnetic, with its own deviation and variation (east
    positive). HDM is magnetic without them, as an HDG may be: then the boat adds the declination. A better
    kind suppresses a worse one for 2 s. ROT (°/min, positive to starboard) gives the yaw rate.
    """

    def __init__(self, correction_rad: float = 0.0) -> None:
        self._correction_rad = correction_rad
        self._rank = 0
        self._ranked_s = -math.inf
        self._rate_rad_s: float | None = None
        self._rate_s = -math.inf

    def feed(self, sentence: Sentence, time_s: float) -> HeadingReading | None:
        """Process a sentence received at time_s; None if it gives no heading."""
        if sentence.kind == "ROT":
            rate_deg_min = sentence.number("rot") if sentence.text("valid") == "A" else None
            self._rate_rad_s = None if rate_deg_min is None else math.radians(rate_deg_min) / 60.0
            self._rate_s = time_s
            return None
        heading_deg, rank = _heading_deg(sentence)
        if heading_deg is None or (rank < self._rank and time_s - self._ranked_s < _PRECEDENCE_S):
            return None
        self._rank, self._ranked_s = rank, time_s
        rate_rad_s = self._rate_rad_s if time_s - self._rate_s < _RATE_LIFE_S else None
        heading_rad = wrap_pi(math.radians(heading_deg) + self._correction_rad)
        return HeadingReading(time_s, heading_rad, rate_rad_s, is_magnetic=rank == _MAGNETIC)


def _heading_deg(sentence: Sentence) -> tuple[float | None, int]:
    """The heading or None, and the rank of its kind."""
    if sentence.kind == "HDT":
        return sentence.number("headingT"), _TRUE
    if sentence.kind == "THS":
        return (sentence.number("headt") if sentence.text("mi") == "A" else None), _TRUE
    if sentence.kind == "HPR":
        return (sentence.number("heading") if sentence.number("quality") == _FIXED else None), _TRUE
    magnetic_deg = sentence.number("headingM")
    if sentence.kind == "HDM" or magnetic_deg is None:
        return magnetic_deg, _MAGNETIC
    deviation_deg = _eastward_deg(sentence, "deviation") or 0.0
    variation_deg = _eastward_deg(sentence, "variation")
    if variation_deg is None:
        return magnetic_deg + deviation_deg, _MAGNETIC
    return magnetic_deg + deviation_deg + variation_deg, _CORRECTED


def _eastward_deg(sentence: Sentence, name: str) -> float | None:
    angle_deg, side = sentence.number(name), sentence.text(f"{name}EW")
    if angle_deg is None or side not in {"E", "W"}:
        return None
    return angle_deg if side == "E" else -angle_deg
