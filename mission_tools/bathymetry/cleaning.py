"""Which soundings a chart may use: each that it may not has one named reason."""

from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.ndimage import label, median_filter
from scipy.spatial import cKDTree
from shapely.geometry.base import BaseGeometry

from mission_tools.bathymetry.blocks import MAD, means
from mission_tools.bathymetry.reduction import Reduced
from mission_tools.bathymetry.soundings import Flags, Floats, Soundings

Codes = NDArray[np.int8]

REASONS: Final = (
    "accepted",
    "no bottom",
    "no position",
    "position uncertain",
    "position jump",
    "outside the water",
    "multiple echo",
    "weeds",
    "low quality",
    "spike",
)
"""By code; the first that applies."""
_OK, _BOTTOM, _PLACE, _UNSURE, _JUMP, _LAND, _MULTIPLE, _WEEDS, _QUALITY, _SPIKE = range(len(REASONS))

WINDOW = 31  # soundings of the running median: echoes that are wrong in up to 15 of them stand out
SCALE_WINDOW = 101  # of the running spread
OUTLIER_SD = 5.0  # a normal error exceeds it once in two million soundings
LONGEST_SPIKE = 3  # soundings in a row; more that agree are taken for the bottom
LEAST_SD = (0.01, 0.005)  # m, of depth: resolution of common sounders, 1 cm and 0.5 % (Ping1D)
POORER = 0.8  # of the usual quality: a canopy's echo is weaker than the bottom's
MULTIPLE_SHARE = 0.15  # of the depth, off the double: slope and noise between the two paths
JUMP_M = 3.0  # position noise of a receiver from fix to fix (u-blox M8: 2.5 m CEP)
FASTEST_M_S = 10.0  # of a small boat whose speed is not known
SETTLED_S = 60.0  # a track that goes on so long after a jump is the boat's


@dataclass(frozen=True, slots=True)
class CleaningSettings:
    """least_quality: of an echo, 0 to 1. most_position_sd_m: of a fix, per axis; half of a usual spacing."""

    least_quality: float = 0.5
    most_position_sd_m: float = 5.0


def cleaned(s: Soundings, at: Reduced, water: BaseGeometry | None, settings: CleaningSettings) -> Codes:
    """The code in REASONS of each sounding, shape (n,). water: where soundings may lie, None: anywhere."""
    codes = np.full(len(s.depth_m), _OK, dtype=np.int8)

    def reject(flags: Flags, reason: int) -> None:
        codes[flags & (codes == _OK)] = reason

    reject(~np.isfinite(at.depth_m) | (np.nan_to_num(s.depth_m) <= 0.0), _BOTTOM)
    reject(~np.isfinite(at.east_m) | ~np.isfinite(at.north_m), _PLACE)
    reject(np.nan_to_num(s.position_sd_m) > settings.most_position_sd_m, _UNSURE)
    for voyage in np.unique(s.voyage):
        (own,) = np.nonzero((s.voyage == voyage) & (codes == _OK))
        codes[own[_jumped(s, at, own)]] = _JUMP
    if water is not None:
        near = shapely.buffer(water, JUMP_M)
        shapely.prepare(near)
        reject(~shapely.contains_xy(near, at.east_m, at.north_m), _LAND)
    for _ in range(2):  # what is left of a long run of second echoes is short enough the second time
        for voyage in np.unique(s.voyage):
            (own,) = np.nonzero((s.voyage == voyage) & (codes == _OK))
            if len(own) >= LONGEST_SPIKE:
                codes[own] = _echoes(at.depth_m[own], s.quality[own], settings.least_quality)
        (own,) = np.nonzero(codes == _OK)
        codes[own[_doubled(at, own)]] = _MULTIPLE
    return codes


def counts(codes: Codes) -> dict[str, int]:
    """How many soundings each reason has, all reasons in their order."""
    found = np.bincount(codes, minlength=len(REASONS))
    return {reason: int(count) for reason, count in zip(REASONS, found, strict=True)}


def _jumped(s: Soundings, at: Reduced, own: NDArray[np.intp]) -> Flags:
    """Soundings of one voyage on short stretches that the boat cannot have reached at its own speed."""
    east, north, time = at.east_m[own], at.north_m[own], s.unix_s[own]
    speed = np.nan_to_num(s.speed_m_s[own], nan=FASTEST_M_S)
    slack = JUMP_M + np.nan_to_num(s.position_sd_m[own])
    moved = np.hypot(np.diff(east), np.diff(north)) - np.maximum(speed[1:], speed[:-1]) * np.diff(time)
    jumps = np.nonzero(moved > np.maximum(slack[1:], slack[:-1]))[0] + 1  # of NaN, a log without times, none
    flags = np.zeros(len(own), dtype=bool)
    for start, end in pairwise([0, *jumps.tolist(), len(own)]):
        flags[start:end] = len(jumps) > 0 and time[end - 1] - time[start] < SETTLED_S
    return flags


def _echoes(depth: Floats, quality: Floats, least_quality: float) -> Codes:
    """Codes of the soundings of a voyage against the running median of the good ones."""
    codes = np.full(len(depth), _OK, dtype=np.int8)
    poor = np.nan_to_num(quality, nan=1.0) < least_quality
    index = np.arange(len(depth))
    good = index[~poor] if (~poor).sum() >= LONGEST_SPIKE else index
    for _ in range(2):  # the second time without those far off, which draw the median on a slope
        local = np.interp(index, good, median_filter(depth[good], WINDOW, mode="nearest"))
        off = depth - local
        spread = MAD * median_filter(np.abs(off[good]), SCALE_WINDOW, mode="nearest")
        sd = np.maximum(np.interp(index, good, spread), LEAST_SD[0] + LEAST_SD[1] * local)
        far = np.abs(off) > OUTLIER_SD * sd
        good = good[~far[good]] if not far[good].all() else good
    short = depth - median_filter(depth, 2 * LONGEST_SPIKE + 1, mode="nearest")
    bend = np.abs(np.diff(depth, 2, prepend=depth[0], append=depth[-1]))
    noise = MAD * median_filter(bend, SCALE_WINDOW, mode="nearest") / np.sqrt(6.0)  # as `white_noise_m`
    codes[np.abs(short) > OUTLIER_SD * np.maximum(noise, LEAST_SD[0] + LEAST_SD[1] * local)] = _SPIKE
    poorer = quality < POORER * np.nanmedian(np.append(quality, 1.0))
    codes[(codes == _SPIKE) & (off < 0.0) & poorer] = _WEEDS
    codes[poor] = _QUALITY
    codes[poor & (off < -OUTLIER_SD * sd)] = _WEEDS
    codes[_abrupt(far & _is_double(depth, local), depth, local)] = _MULTIPLE
    return codes


def _is_double(depth: Floats, local: Floats) -> Flags:
    """The echo that the surface sends down again: twice the depth below the surface."""
    found: Flags = np.abs(depth - 2.0 * local) < MULTIPLE_SHARE * local
    return found


def _abrupt(flags: Flags, depth: Floats, local: Floats) -> Flags:
    """Those runs of flags that begin or end with a step of half the depth; a shore does not."""
    numbers, count = label(flags)
    step = np.abs(np.diff(depth, prepend=depth[0])) > 0.5 * local
    begins = flags & (np.roll(numbers, 1) != numbers) & step
    ends = flags & (np.roll(numbers, -1) != numbers) & np.roll(step, -1)
    found = np.zeros(count + 1, dtype=bool)
    found[numbers[begins | ends]] = True
    kept: Flags = flags & found[numbers]
    return kept


def _doubled(at: Reduced, own: NDArray[np.intp]) -> Flags:
    """Long runs of second echoes: twice the depth of what other passes found beside them."""
    flags = np.zeros(len(own), dtype=bool)
    if len(own) < WINDOW:
        return flags
    blocks, block_of = means(at.east_m[own], at.north_m[own], at.depth_m[own], 3.0, own.astype(np.float64))
    near = min(24, len(blocks.place))
    _, others = cKDTree(blocks.place).query(blocks.place, k=near)
    apart = np.abs(blocks.extra[others] - blocks.extra[:, None]) > 4 * WINDOW
    values = np.where(apart, blocks.depth_m[others], np.nan)
    enough = apart.sum(axis=1) >= 4
    values[~enough] = blocks.depth_m[~enough, None]
    local = np.nanmedian(values, axis=1)
    spread = MAD * np.nanmedian(np.abs(values - local[:, None]), axis=1)
    double = enough & _is_double(blocks.depth_m, local) & (blocks.depth_m - local > OUTLIER_SD * spread)
    return _abrupt(double[block_of], at.depth_m[own], local[block_of])
