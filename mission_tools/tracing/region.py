"""Seeded region growing in CIE L*a*b*: the pixels that look like a seed's water and hang together with it.

The model of the water is a normal distribution of colour, first of a disc around the seed, then of the region
that grew from it, until that no longer changes. How far a colour may be from the model is Otsu's threshold
(N. Otsu, "A threshold selection method from gray-level histograms", 1979) of the Mahalanobis distances, if
none is given. R. Adams and L. Bischof, "Seeded region growing" (1994), is the pattern.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

Colours = NDArray[np.float64]  # rows × columns × 3
Mask = NDArray[np.bool_]
Pixel = tuple[int, int]  # column, row

SEED_RADIUS = 5  # pixels
SMOOTHING = 1.0  # pixels: sigma; evens out ripples
COLOUR_FLOOR = 4.0  # ΔE: a model is never narrower, or a single colour would be all the water
FARTHEST = 12.0  # in standard deviations: beyond it everything is equally unlike the water
ROUNDS = 12
SETTLED_SHARE = 0.002  # of the region's pixels that may still change
OPENING = 2  # pixels: narrower bridges of alike colour, such as a wet path, do not carry the region on

# CIE 15: sRGB (IEC 61966-2-1) to XYZ with white D65
_XYZ = np.array(
    [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041]]
)
_WHITE = np.array([0.95047, 1.0, 1.08883])


class Region(NamedTuple):
    """The pixels of the water, and the threshold that made them."""

    mask: Mask
    threshold: float


def lab_of(rgb: NDArray[np.uint8]) -> Colours:
    """sRGB bytes as L*, a*, b*."""
    share = rgb.astype(np.float64) / 255.0
    linear = np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
    xyz = linear @ _XYZ.T / _WHITE
    f = np.where(xyz > 216.0 / 24389.0, np.cbrt(xyz), (24389.0 / 27.0 * xyz + 16.0) / 116.0)
    x, y, z = f[..., 0], f[..., 1], f[..., 2]
    return np.stack((116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)), axis=-1)


def grow(
    rgb: NDArray[np.uint8], seeds: Sequence[Pixel], land: Sequence[Pixel] = (), threshold: float | None = None
) -> Region:
    """The regions around the seeds, each with a model of its own, as one.

    land: pixels whose like is never water. threshold: None chooses; the largest chosen one is returned.
    """
    lab = lab_of(rgb)
    lab = np.stack([ndimage.gaussian_filter(lab[..., n], SMOOTHING) for n in range(3)], axis=-1)
    ashore = _distances(lab, [_disc(lab, at) for at in land])
    regions = [_grow_one(lab, seed, ashore, threshold) for seed in seeds]
    mask: Mask = np.logical_or.reduce([region.mask for region in regions])
    return Region(mask, max(region.threshold for region in regions))


def _grow_one(lab: Colours, seed: Pixel, ashore: NDArray[np.float64], threshold: float | None) -> Region:
    region, limit = _disc(lab, seed), threshold or 0.0
    for _ in range(ROUNDS):
        distance = _distance(lab, region)
        limit = threshold or otsu(distance[distance < FARTHEST], FARTHEST)
        grown = _connected((distance < limit) & (distance < ashore), seed)
        changed = np.count_nonzero(grown ^ region)
        region = grown
        if changed <= SETTLED_SHARE * np.count_nonzero(grown):
            break
    return Region(region, limit)


def otsu(values: NDArray[np.float64], top: float) -> float:
    """The threshold between 0 and top that separates values into the two most distinct classes."""
    counts, edges = np.histogram(values, 256, (0.0, top))
    share = counts / max(counts.sum(), 1)
    middles = 0.5 * (edges[:-1] + edges[1:])
    below = np.cumsum(share)
    mean = np.cumsum(share * middles)
    weight = below * (1.0 - below)
    between = np.where(weight > 1e-9, (mean[-1] * below - mean) ** 2 / np.maximum(weight, 1e-9), 0.0)
    return float(middles[np.argmax(between)])


def _disc(lab: Colours, at: Pixel) -> Mask:
    rows, columns = np.ogrid[: lab.shape[0], : lab.shape[1]]
    found: Mask = (columns - at[0]) ** 2 + (rows - at[1]) ** 2 <= SEED_RADIUS**2
    return found


def _distances(lab: Colours, regions: Sequence[Mask]) -> NDArray[np.float64]:
    """To the nearest of several models; infinite without one."""
    if not regions:
        return np.full(lab.shape[:2], np.inf)
    nearest: NDArray[np.float64] = np.minimum.reduce([_distance(lab, region) for region in regions])
    return nearest


def _distance(lab: Colours, region: Mask) -> NDArray[np.float64]:
    """Mahalanobis distance of every colour from those of a region."""
    inside = lab[region]
    spread = np.cov(inside.T) + COLOUR_FLOOR**2 * np.eye(3)
    off = lab - inside.mean(axis=0)
    squares: NDArray[np.float64] = np.einsum("...i,ij,...j", off, np.linalg.inv(spread), off)
    return np.sqrt(squares)


def _connected(candidates: Mask, seed: Pixel) -> Mask:
    """The piece of the candidates that the seed lies in, without narrow bridges; empty if it lies in none."""
    labels, _ = ndimage.label(ndimage.binary_opening(candidates, iterations=OPENING))
    label = labels[seed[1], seed[0]]
    found: Mask = (labels == label) & (label > 0)
    return found
