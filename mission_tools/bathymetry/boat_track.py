"""Where a boat was at any time of its log, how it lay, and what the date was."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray
from pyproj import Geod

from mission_tools.bathymetry.soundings import Floats
from mission_tools.files.dataflash_columns import Columns

WANTED: Final[Mapping[str, tuple[str, ...]]] = {
    "GPS": ("TimeUS", "GWk", "GMS", "I"),
    "POS": ("TimeUS", "Lat", "Lng"),
    "ATT": ("TimeUS", "Roll", "Pitch", "Yaw"),
    "XKF1": ("TimeUS", "VN", "VE", "C"),
    "EST": ("TimeUS", "PosSD"),
}
_FRESH_S: Final = 2.0  # a sample farther from the nearest record has no value of it
_GPS_EPOCH_S: Final = 315_964_800.0  # 1980-01-06 as Unix time
_LEAP_S: Final = 18.0  # GPS time less UTC, since 2017
_WEEK_S: Final = 604_800.0
_WGS84: Final = Geod(ellps="WGS84")


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """A boat at n times, each array of shape (n,); NaN where the log says nothing within two seconds.

    log_s: since the boat's start. The others as in `Soundings`; position_sd_m is one standard deviation.
    """

    log_s: Floats
    unix_s: Floats
    lat_deg: Floats
    lon_deg: Floats
    position_sd_m: Floats
    heading_rad: Floats
    roll_rad: Floats
    pitch_rad: Floats
    speed_m_s: Floats

    def of_part(self, forward_m: float, starboard_m: float) -> "Motion":
        """With the places of a part of the boat; where the heading is unknown, still of the boat."""
        bearing_deg = np.degrees(self.heading_rad + np.arctan2(starboard_m, forward_m))
        far_m = np.full_like(self.lat_deg, np.hypot(forward_m, starboard_m))
        lon_deg, lat_deg, _ = _WGS84.fwd(self.lon_deg, self.lat_deg, bearing_deg, far_m)
        is_known = np.isfinite(bearing_deg)
        return replace(
            self,
            lat_deg=np.where(is_known, lat_deg, self.lat_deg),
            lon_deg=np.where(is_known, lon_deg, self.lon_deg),
        )


class BoatTrack:
    """Of the log's records, by linear interpolation. columns: those of WANTED. is_dated: a fix has a date."""

    def __init__(self, columns: Mapping[str, Columns]) -> None:
        self._columns = columns
        # The boat writes 0 for a roll and pitch that its heading sensor does not measure
        gps, attitude = columns["GPS"], columns["ATT"]
        is_usable = (gps["GWk"] > 0.0) & _of_first_instance(gps)
        unix_s = _GPS_EPOCH_S + gps["GWk"] * _WEEK_S + gps["GMS"] * 1e-3 - _LEAP_S
        fix_s, first = np.unique(gps["TimeUS"][is_usable] * 1e-6, return_index=True)
        self._fix_s, self._starts_s = fix_s, unix_s[is_usable][first] - fix_s
        self.is_dated = bool(len(fix_s))
        self._leans = bool(len(attitude["TimeUS"]) and (attitude["Roll"].any() or attitude["Pitch"].any()))

    def at(self, log_s: Floats) -> Motion:
        """The boat at these times, in seconds since its start."""
        lean = np.full_like(log_s, np.nan)
        unknown = lean, lean
        lat_deg, lon_deg = self._at(log_s, "POS", ("Lat", "Lng"), turns_at="Lng")
        (heading_deg,) = self._at(log_s, "ATT", ("Yaw",), turns_at="Yaw")
        roll_deg, pitch_deg = self._at(log_s, "ATT", ("Roll", "Pitch")) if self._leans else unknown
        north_m_s, east_m_s = self._at(log_s, "XKF1", ("VN", "VE"))
        (deviation_m,) = self._at(log_s, "EST", ("PosSD",))
        return Motion(
            log_s,
            log_s + self._start_unix_s(log_s),
            lat_deg,
            (lon_deg + 180.0) % 360.0 - 180.0,
            deviation_m,
            np.radians(heading_deg % 360.0),
            np.radians(roll_deg),
            np.radians(pitch_deg),
            np.hypot(north_m_s, east_m_s),
        )

    def _at(
        self, log_s: Floats, kind: str, labels: tuple[str, ...], turns_at: str = ""
    ) -> tuple[Floats, ...]:
        """Fields of a kind of record. turns_at: the one that begins anew after 360 degrees."""
        columns = self._columns[kind]
        rows = np.flatnonzero(_of_first_instance(columns))
        times_s, first = np.unique(columns["TimeUS"][rows] * 1e-6, return_index=True)
        rows = rows[first]
        if not len(rows):
            return tuple(np.full_like(log_s, np.nan) for _ in labels)
        after = np.searchsorted(times_s, log_s)
        before_s, after_s = (times_s[at.clip(0, len(rows) - 1)] for at in (after - 1, after))
        is_near = np.minimum(np.abs(log_s - before_s), np.abs(after_s - log_s)) <= _FRESH_S
        out = []
        for label in labels:
            values = columns[label][rows]
            values = np.unwrap(values, period=360.0) if label == turns_at else values
            out.append(np.where(is_near, np.interp(log_s, times_s, values), np.nan))
        return tuple(out)

    def _start_unix_s(self, log_s: Floats) -> Floats:
        """Unix time of the boat's start, as the fixes around each time have it: its clock may drift."""
        if not self.is_dated:
            return np.full_like(log_s, np.nan)
        starts_s: Floats = np.interp(log_s, self._fix_s, self._starts_s)
        return starts_s


def _of_first_instance(columns: Columns) -> NDArray[np.bool_]:
    """Which records are of the first receiver or filter."""
    instance = columns.get("I", columns.get("C", np.zeros(len(columns["TimeUS"]))))
    is_first: NDArray[np.bool_] = ~(instance > 0.0)  # a log may not say it
    return is_first
