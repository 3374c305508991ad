"""Where the tracks cross: the two depths there tell what the whole survey is good for."""

from dataclasses import dataclass
from typing import Final

import numpy as np
import shapely
from numpy.typing import NDArray

from mission_tools.bathymetry.blocks import MAD, along_track_m, thinned
from mission_tools.bathymetry.s44 import tvu_m
from mission_tools.bathymetry.soundings import Floats

STEP_M: Final = 2.0  # of the track's legs that are searched: a boat turns little within it
NEAR_M: Final = 1.5  # along each track: the mean of these soundings is its depth at the crossing
APART_S: Final = 20.0  # a crossing sooner after the first pass is the boat's own turn
LEAST: Final = 8  # crossings, for a spread
GAP_M: Final = 6.0  # a longer leg between soundings is no track: those between were rejected


@dataclass(frozen=True, slots=True, eq=False)
class Crossings:
    """Arrays of shape (n,): place, mean depth, the difference of later and earlier pass in metres, and the
    variance that a sounding's own noise of 1 leaves in it.
    """

    east_m: Floats
    north_m: Floats
    depth_m: Floats
    difference_m: Floats
    share: Floats

    def line_sd_m(self, white_m: float) -> float:
        """Standard deviation of what a line errs as a whole at a place, beyond a sounding's own noise: waves,
        position on slopes, water level. 0: none that stands out from the noise. NaN: too few crossings.
        """
        count = len(self.difference_m)
        if count < LEAST:
            return float("nan")
        variance = (MAD * float(np.median(np.abs(self.difference_m)))) ** 2
        excess = variance - white_m**2 * float(np.mean(self.share))
        # the variance from a median of n has a relative standard error of 2·1.17/√n; twice that is noise
        return float(np.sqrt(0.5 * excess)) if excess > 4.7 / np.sqrt(count) * variance else 0.0

    def within(self, order: str) -> float:
        """Share of the differences within the vertical uncertainty that an order allows; NaN of none.

        Two depths differ by √2 of what one errs; that is not granted here.
        """
        if not len(self.difference_m):
            return float("nan")
        return float(np.mean(np.abs(self.difference_m) <= tvu_m(order, self.depth_m)))


def crossings(east_m: Floats, north_m: Floats, depth_m: Floats, unix_s: Floats) -> Crossings:
    """All crossings of tracks through accepted soundings in the order of their times."""
    along = along_track_m(east_m, north_m)
    keep = thinned(along, STEP_M)
    place = np.column_stack((east_m, north_m))[keep]
    a, b, at = _met(place, unix_s[keep])
    found = []
    for first, second, middle in zip(keep[a].tolist(), keep[b].tolist(), at, strict=True):
        early, late = (depth_m[_near(along, east_m, north_m, leg, middle)] for leg in (first, second))
        if len(early) and len(late):
            depths = early.mean(), late.mean()
            found.append((*middle, 0.5 * sum(depths), depths[1] - depths[0], 1 / len(early) + 1 / len(late)))
    return Crossings(*np.array(found).reshape(-1, 5).T)


def _met(place: Floats, unix_s: Floats) -> tuple[NDArray[np.intp], NDArray[np.intp], Floats]:
    """The legs that cross, the earlier first, and where."""
    legs = shapely.linestrings(np.stack((place[:-1], place[1:]), axis=1))
    legs[shapely.length(legs) > GAP_M] = None
    a, b = shapely.STRtree(legs).query(legs, predicate="intersects")
    times = np.where(np.isfinite(unix_s), unix_s, np.arange(len(unix_s)))
    apart = (a < b) & (times[b] - times[a] > APART_S)
    a, b = a[apart], b[apart]
    meet = shapely.intersection(legs[a], legs[b])
    points = shapely.get_type_id(meet) == 0
    return a[points], b[points], shapely.get_coordinates(meet[points])


def _near(along: Floats, east_m: Floats, north_m: Floats, leg: int, at: Floats) -> slice:
    """The soundings of a track about a place on one of its legs."""
    way = along[leg] + np.hypot(at[0] - east_m[leg], at[1] - north_m[leg])
    return slice(
        int(np.searchsorted(along, way - NEAR_M)), int(np.searchsorted(along, way + NEAR_M, side="right"))
    )
