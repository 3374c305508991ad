"""Block means of soundings, the spacing of their lines, and the noise that they show themselves."""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from mission_tools.bathymetry.soundings import Floats

MAD: Final = 1.4826  # standard deviations of a normal distribution in its median absolute deviation
PARALLEL: Final = 0.9  # cosine: within 26°


@dataclass(frozen=True, slots=True, eq=False)
class Blocks:
    """Means of soundings in squares, (n,). extra: of a further value. place: east and north in m, (n, 2)."""

    place: Floats
    depth_m: Floats
    count: Floats
    extra: Floats


def means(
    east_m: Floats, north_m: Floats, depth_m: Floats, size_m: float, extra: Floats
) -> tuple[Blocks, NDArray[np.intp]]:
    """The means, and the number of the block of each sounding."""
    column = np.floor(east_m / size_m).astype(np.int64)
    row = np.floor(north_m / size_m).astype(np.int64)
    key = (row - row.min()) * (np.ptp(column) + 1) + column - column.min()
    _, block_of, count = np.unique(key, return_inverse=True, return_counts=True)
    east, north, depth, further = (
        np.bincount(block_of, weights=values) / count for values in (east_m, north_m, depth_m, extra)
    )
    return Blocks(np.column_stack((east, north)), depth, count.astype(np.float64), further), block_of


def white_noise_m(depth_m: Floats) -> float:
    """Standard deviation of a sounding's own noise, from second differences of successive depths: slopes and
    slow errors drop out, and their variance is six times the noise's. Jumps beyond 4 sd are left out.
    """
    if len(depth_m) < 3:
        return 0.0
    bend = np.abs(np.diff(depth_m, 2))
    usual = bend[bend < 4.0 * MAD * np.median(bend)]
    return float(np.sqrt(np.mean(usual**2) / 6.0)) if len(usual) else 0.0


def along_track_m(east_m: Floats, north_m: Floats) -> Floats:
    """The way along a track to each of its places, (n,)."""
    return np.concatenate(([0.0], np.cumsum(np.hypot(np.diff(east_m), np.diff(north_m)))))


def thinned(along_m: Floats, step_m: float) -> NDArray[np.intp]:
    """The places of a track that a step lies between, or more."""
    return np.unique(np.searchsorted(along_m, np.arange(0.0, along_m[-1], step_m)))


def line_spacing_m(east_m: Floats, north_m: Floats) -> float:
    """Distance of neighbouring lines: the median distance sideways to the nearest parallel pass.

    Places in the order of their times. NaN: there is only one pass.
    """
    along = along_track_m(east_m, north_m)
    step = max(along[-1] / 20_000.0, 1.0)  # a thinned track keeps the search short
    keep = thinned(along, step)
    place, way = np.column_stack((east_m, north_m))[keep], along[keep]
    if len(keep) < 3:
        return float("nan")
    course = np.gradient(place, axis=0)
    course /= np.maximum(np.hypot(*course.T), 1e-9)[:, None]
    distance, other = cKDTree(place).query(place, k=min(192, len(keep)))
    off = place[other] - place[:, None]
    side = np.abs(course[:, None, 0] * off[..., 1] - course[:, None, 1] * off[..., 0])
    parallel = np.abs(np.einsum("nkc,nc->nk", course[other], course)) > PARALLEL
    # on another pass: the way there along the track is three times as long as across
    elsewhere = np.abs(way[other] - way[:, None]) > np.maximum(3.0 * distance, 10.0 * step)
    distance[~(elsewhere & parallel & (side > PARALLEL * distance))] = np.inf
    nearest = distance.min(axis=1)
    return float(np.median(nearest[np.isfinite(nearest)])) if np.isfinite(nearest).any() else float("nan")
