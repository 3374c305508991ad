"""Where a boat was at any time of its log, how it lay, and what the date was."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray
from pyproj import Geod

from companion.core.units import GPS_EPOCH_UNIX_S, GPS_WEEK_S
from mission_tools.bathymetry.soundings import Floats, Motion
from mission_tools.files.dataflash_columns import Columns

WANTED: Final[Mapping[str, tuple[str, ...]]] = {
    "GPS": ("TimeUS", "GWk", "GMS", "I"),
    "POS": ("TimeUS", "Lat", "Lng"),
    "ATT": ("TimeUS", "Roll", "Pitch", "Yaw"),
    "XKF1": ("TimeUS", "VN", "VE", "C"),
    "EST": ("TimeUS", "PosSD"),
}
_FRESH_S: Final = 2.0  # a sample farther from the nearest record has no value of it
_WGS84: Final = Geod(ellps="WGS84")


def of_part(boat: Motion, forward_m: float, starboard_m: float) -> Motion:
    """With the places of a part of the boat; where the heading is unknown, still of the boat."""
    bearing_deg = np.degrees(boat.heading_rad + np.arctan2(starboard_m, forward_m))
    far_m = np.full_like(boat.lat_deg, np.hypot(forward_m, starboard_m))
    lon_deg, lat_deg, _ = _WGS84.fwd(boat.lon_deg, boat.lat_deg, bearing_deg, far_m)
    is_known = np.isfinite(bearing_deg)
    return replace(
        boat,
        lat_deg=np.where(is_known, lat_deg, boat.lat_deg),
        lon_deg=np.where(is_known, lon_deg, boat.lon_deg),
    )


class BoatTrack:
    """Of the log's records, by linear interpolation. columns: those of WANTED."""

    def __init__(self, columns: Mapping[str, Columns]) -> None:
        self._columns = columns

    def at(self, log_s: Floats) -> Motion:
        """The boat at these times, in seconds since its start; NaN farther than two seconds from a record."""
        attitude, lon_deg = self._columns["ATT"], self._of(log_s, "POS", "Lng", turns=True)
        # The boat writes 0 for a roll and pitch that its heading sensor does not measure
        lean = 1.0 if (attitude["Roll"].any() or attitude["Pitch"].any()) else np.nan
        return Motion(
            log_s + self._start_unix_s(log_s),
            self._of(log_s, "POS", "Lat"),
            (lon_deg + 180.0) % 360.0 - 180.0,
            self._of(log_s, "EST", "PosSD"),
            np.radians(self._of(log_s, "ATT", "Yaw", turns=True) % 360.0),
            np.radians(self._of(log_s, "ATT", "Roll")) * lean,
            np.radians(self._of(log_s, "ATT", "Pitch")) * lean,
            np.hypot(self._of(log_s, "XKF1", "VN"), self._of(log_s, "XKF1", "VE")),
        )

    def _of(self, log_s: Floats, kind: str, label: str, *, turns: bool = False) -> Floats:
        """A field of a kind of record. turns: it begins anew after 360 degrees."""
        columns = self._columns[kind]
        rows = _of_first_instance(columns)
        values = np.unwrap(columns[label][rows], period=360.0) if turns else columns[label][rows]
        return _between(log_s, columns["TimeUS"][rows] * 1e-6, values, _FRESH_S)

    def _start_unix_s(self, log_s: Floats) -> Floats:
        """Unix time of the boat's start, as the fixes around each time have it: its clock may drift."""
        gps = self._columns["GPS"]
        rows, fix_s = (gps["GWk"] > 0.0) & _of_first_instance(gps), gps["TimeUS"] * 1e-6
        starts_s = GPS_EPOCH_UNIX_S + gps["GWk"] * GPS_WEEK_S + gps["GMS"] * 1e-3 - fix_s
        return _between(log_s, fix_s[rows], starts_s[rows], np.inf)


def _between(log_s: Floats, times_s: Floats, values: Floats, reach_s: float) -> Floats:
    """Values at other times than theirs; NaN where none is within reach."""
    times_s, first = np.unique(times_s, return_index=True)
    if not len(times_s):
        return np.full_like(log_s, np.nan)
    after = np.searchsorted(times_s, log_s)
    before_s, after_s = (times_s[at.clip(0, len(times_s) - 1)] for at in (after - 1, after))
    is_near = np.minimum(np.abs(log_s - before_s), np.abs(after_s - log_s)) <= reach_s
    return np.where(is_near, np.interp(log_s, times_s, values[first]), np.nan)


def _of_first_instance(columns: Columns) -> NDArray[np.bool_]:
    """Which records are of the first receiver or filter."""
    instance = columns.get("I", columns.get("C", np.zeros(len(columns["TimeUS"]))))
    is_first: NDArray[np.bool_] = ~(instance > 0.0)  # a log may not say it
    return is_first
