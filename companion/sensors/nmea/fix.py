"""Combines NMEA 0183 sentences into fixes.

Field meanings: NMEA 0183 v4.11 (GGA, GNS, RMC, VTG, GLL, GSA, GST).
"""

import datetime
import math

from companion.core.geo import LatLon
from companion.core.readings import GnssFix
from companion.core.units import KNOT_M_S
from companion.sensors.nmea.sentences import Sentence

GNSS_SENTENCES = frozenset({"GGA", "GNS", "RMC", "VTG", "GLL", "GSA", "GST"})

_UNKNOWN_HDOP = 99.99
_NO_FIX, _FIX_2D, _FIX_3D, _DGNSS, _RTK_FLOAT, _RTK_FIXED = 1, 2, 3, 4, 5, 6
# Quality of a GGA; dead reckoning (6) and manual input (7) are no fix, 8 is a receiver's own simulator.
_QUALITY_FIX = {1: _FIX_3D, 2: _DGNSS, 3: _FIX_3D, 4: _RTK_FIXED, 5: _RTK_FLOAT, 8: _FIX_3D}
# Mode letters of a GNS, one for each constellation.
_MODE_FIX = {"A": _FIX_3D, "D": _DGNSS, "P": _FIX_3D, "R": _RTK_FIXED, "F": _RTK_FLOAT, "S": _FIX_3D}


class FixAssembler:
    """Combines the sentences of one epoch (one UTC time) into one GnssFix.

    A receiver does not mark the last sentence of an epoch, but its order is constant: the last sentence of an
    epoch is learned and completes the next. The first epoch, and one whose last sentence was lost, are
    completed by the next one.

    Without a fix a receiver sends no position. The result then has the last known position (0, 0 before the
    first) and fix_type 1, so that stations see a working receiver.
    """

    def __init__(self) -> None:
        self._epoch: _Epoch | None = None
        self._usual_ending = self._recent_ending = ("", 0)
        self._position = LatLon(0.0, 0.0)

    def feed(self, sentence: Sentence, time_s: float) -> list[GnssFix]:
        """Process a sentence received at time_s; returns at most two complete fixes."""
        fixes: list[GnssFix] = []
        epoch = self._epoch
        utc = sentence.fields.get("time")
        utc = utc if isinstance(utc, datetime.time) else None
        if epoch is None or epoch.is_over(sentence.kind, utc):
            if epoch is not None:
                self._learn(epoch.ending)
                fixes += self._emit(epoch)
            epoch = self._epoch = _Epoch(utc, time_s)
        epoch.add(sentence)
        if epoch.ending == self._usual_ending:
            fixes += self._emit(epoch)
        return fixes

    def _learn(self, ending: tuple[str, int]) -> None:
        # A lost sentence must not change the learned ending: two epochs must agree.
        if ending == self._recent_ending or not self._usual_ending[0]:
            self._usual_ending = ending
        self._recent_ending = ending

    def _emit(self, epoch: "_Epoch") -> list[GnssFix]:
        if epoch.is_out or not epoch.has_solution:
            return []
        epoch.is_out = True
        self._position = epoch.position or self._position
        return [epoch.fix(self._position)]


class _Epoch:
    """The sentences of one epoch so far."""

    def __init__(self, utc: datetime.time | None, time_s: float) -> None:
        self.kinds: list[str] = []
        self.is_out = False
        self.has_solution = False  # contains a GGA, GNS or RMC
        self.position: LatLon | None = None
        self._utc = utc
        self._time_s = time_s
        self._fix_type = _NO_FIX
        self._is_valid = True
        self._is_flat = False
        self._satellites = 0
        self._hdop = _UNKNOWN_HDOP
        self._altitude_m = 0.0
        self._accuracy_m: float | None = None
        self._velocity: tuple[float, float] | None = None
        self._date: datetime.date | None = None
        self._correction_age_s: float | None = None

    def is_over(self, kind: str, utc: datetime.time | None) -> bool:
        """Whether a sentence of this kind and time begins the next epoch.

        A cold receiver has no time and a faulty one repeats it; then a second GGA or RMC begins the next. GNS
        may occur once per constellation.
        """
        if utc is not None and utc != self._utc:
            return True
        return kind in self.kinds and (kind in {"GGA", "RMC"} or (kind == "GNS" and utc is None))

    @property
    def ending(self) -> tuple[str, int]:
        """Kind of the latest sentence, and how many of that kind there were."""
        kind = self.kinds[-1]
        return kind, self.kinds.count(kind)

    def add(self, sentence: Sentence) -> None:
        kind = sentence.kind
        self.kinds.append(kind)
        if kind in {"GGA", "GNS"}:
            self._add_solution(sentence)
        elif kind == "RMC":
            self._add_minimum(sentence)
        elif kind == "VTG":
            self._add_velocity(sentence.number("sogn"), sentence.number("cogt"))
        elif kind == "GSA":
            self._is_flat = sentence.number("navMode") == 2
            if self._hdop == _UNKNOWN_HDOP:
                self._hdop = sentence.number("HDOP") or _UNKNOWN_HDOP
        elif kind == "GST":
            north_m, east_m = sentence.number("stdLat"), sentence.number("stdLong")
            if north_m is not None and east_m is not None:
                self._accuracy_m = math.hypot(north_m, east_m)

    def fix(self, fallback: LatLon) -> GnssFix:
        has_fix = self._is_valid and self.position is not None
        fix_type = self._fix_type if has_fix else _NO_FIX
        if self._is_flat and fix_type == _FIX_3D:
            fix_type = _FIX_2D
        north_m_s, east_m_s = self._velocity if self._velocity and fix_type > _NO_FIX else (None, None)
        unix_time_s = None
        if self._date is not None and self._utc is not None:
            unix_time_s = datetime.datetime.combine(self._date, self._utc, datetime.UTC).timestamp()
        return GnssFix(
            time_s=self._time_s,
            position=self.position or fallback,
            fix_type=fix_type,
            satellites=self._satellites,
            hdop=self._hdop,
            north_m_s=north_m_s,
            east_m_s=east_m_s,
            altitude_m=self._altitude_m,
            horizontal_accuracy_m=self._accuracy_m,
            unix_time_s=unix_time_s,
            time_of_day_s=None if self._utc is None else _seconds(self._utc),
            correction_age_s=self._correction_age_s,
        )

    def _add_solution(self, sentence: Sentence) -> None:
        self.has_solution = True
        self._add_position(sentence)
        if sentence.kind == "GGA":
            fix_type = _QUALITY_FIX.get(int(sentence.number("quality") or 0), _NO_FIX)
        else:
            fix_type = max(
                (_MODE_FIX.get(mode, _NO_FIX) for mode in sentence.text("posMode")), default=_NO_FIX
            )
        self._fix_type = fix_type if sentence.kind == "GGA" else max(fix_type, self._fix_type)
        self._satellites = max(self._satellites, int(sentence.number("numSV") or 0))
        self._hdop = sentence.number("HDOP") or self._hdop
        self._altitude_m = sentence.number("alt") or 0.0
        self._correction_age_s = sentence.number("diffAge")

    def _add_minimum(self, sentence: Sentence) -> None:
        self.has_solution = True
        self._add_position(sentence)
        self._is_valid = sentence.text("status") == "A"
        if self._is_valid and not {"GGA", "GNS"} & set(self.kinds):
            self._fix_type = _FIX_3D
        self._add_velocity(sentence.number("spd"), sentence.number("cog"))
        # A receiver without a fix reports whatever its clock holds, after a cold start 1980
        date = sentence.fields.get("date")
        if self._is_valid and isinstance(date, datetime.date):
            self._date = date

    def _add_position(self, sentence: Sentence) -> None:
        lat_deg, lon_deg = sentence.number("lat"), sentence.number("lon")
        if lat_deg is not None and lon_deg is not None and abs(lat_deg) <= 90.0 and abs(lon_deg) <= 180.0:
            self.position = LatLon(lat_deg, lon_deg)

    def _add_velocity(self, speed_kn: float | None, course_deg: float | None) -> None:
        # A receiver at rest leaves the course empty: a speed without direction is no velocity.
        if speed_kn is not None and course_deg is not None:
            speed_m_s, course_rad = speed_kn * KNOT_M_S, math.radians(course_deg)
            self._velocity = (speed_m_s * math.cos(course_rad), speed_m_s * math.sin(course_rad))


def _seconds(utc: datetime.time) -> float:
    """The time of day in seconds since midnight."""
    return 3600.0 * utc.hour + 60.0 * utc.minute + utc.second + 1e-6 * utc.microsecond
