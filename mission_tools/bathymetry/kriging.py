"""Local ordinary kriging with a band that the soundings themselves calibrate.

The covariance is Matérn's with a smoothness of 1/2, 3/2 or 5/2 (Rasmussen and Williams, *Gaussian Processes
for Machine Learning*, 2006, eq. 4.14-4.17). Its variance is tied to the measured semivariance at one line
spacing; smoothness, range and scale of the band come from cross-validation in which each held-out place is as
far from the remaining data as the places to predict are (C. Milà et al., Methods Ecol. Evol. 13 (2022) 1304).
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import product
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from mission_tools.bathymetry.soundings import Floats

Indices = NDArray[np.intp]
NEIGHBOURS: Final = 40  # blocks of a quarter of a spacing: a circle over three lines and a half
SMOOTHNESS: Final = (0.5, 1.5, 2.5)
RANGES: Final = (3.0, 12.0)  # in line spacings; 2 to 16 had scores between or near these on seeds 1 to 3
FACTORS: Final = (0.15, 0.5, 1.5)  # of the variance; trends make the semivariance too large
CHOSEN_ON: Final = 400  # held-out places: what 18 covariances are compared on
SCALED_ON: Final = 2000  # held-out places: what the scale is from
# Relative standard error of the scale without noise: a quantile's 4 %, with half of the places independent
DOUBT: Final = 0.07
PRIOR_SD: Final = 0.3  # of the scale that the log score leaves
LOCAL: Final = 100  # held-out places about a cell: their mean square is known to 14 %
LOCAL_SD: Final = 1.0  # of the local factor: rough and even parts of one lake differ so much
MOST_SD: Final = 4.0  # of an error in a mean square: single outliers
BAND_SD: Final = 1.6449  # half of the 90 % band of a normal distribution
_BATCH: Final = 1500  # systems solved at once: 20 MB
_JITTER: Final = 1e-8  # of the variance: keeps systems solvable in double precision


@dataclass(frozen=True, slots=True)
class Covariance:
    """Matérn's."""

    smoothness: float
    range_m: float
    variance_m2: float

    def __call__(self, distance_m: Floats) -> Floats:
        """The covariance at distances, shape as given."""
        return self.variance_m2 * correlation(self.smoothness, distance_m / self.range_m)


def correlation(smoothness: float, ratio: Floats) -> Floats:
    """Matérn's correlation at distances in units of the range."""
    x = np.sqrt(2.0 * smoothness) * ratio
    factor = {0.5: 1.0, 1.5: 1.0 + x, 2.5: 1.0 + x + x * x / 3.0}[smoothness]
    found: Floats = factor * np.exp(-x)
    return found


class Data(NamedTuple):
    """Depths to interpolate: place (n, 2), depth and variance of its noise (n,)."""

    place: Floats
    depth_m: Floats
    noise_m2: Floats


def predict(data: Data, model: Covariance, groups: Floats, neighbours: Indices) -> tuple[Floats, Floats]:
    """Depth and variance of the kriging error at places that share neighbours.

    groups: places (g, m, 2). neighbours: indices into the data (g, k), −1: none. Returns arrays (g, m).
    """
    depth, variance = np.empty(groups.shape[:2]), np.empty(groups.shape[:2])
    for start in range(0, len(groups), _BATCH):
        part = slice(start, start + _BATCH)
        system = _System.of(data, groups[part], neighbours[part])
        depth[part], variance[part] = system.solved(model)
    return depth, variance


@dataclass(frozen=True, slots=True, eq=False)
class _System:
    """Ordinary kriging of g groups of m places from k neighbours each: distances, noise, depths."""

    between_m: Floats  # (g, k, k)
    away_m: Floats  # (g, k, m)
    noise_m2: Floats  # (g, k)
    depth_m: Floats  # (g, k)
    missing: NDArray[np.bool_]

    @classmethod
    def of(cls, data: Data, at: Floats, near: Indices) -> "_System":
        x, y = np.moveaxis(data.place[near], -1, 0)
        between = np.hypot(x[:, :, None] - x[:, None, :], y[:, :, None] - y[:, None, :])
        away = np.hypot(x[:, :, None] - at[:, None, :, 0], y[:, :, None] - at[:, None, :, 1])
        return cls(between, away, data.noise_m2[near], data.depth_m[near], near < 0)

    def solved(self, model: Covariance) -> tuple[Floats, Floats]:
        g, k, m = self.away_m.shape
        system = np.ones((g, k + 1, k + 1))
        system[:, :k, :k] = model(self.between_m)
        noise = self.noise_m2 + _JITTER * model.variance_m2
        system[:, range(k), range(k)] += np.where(self.missing, 1e6 * model.variance_m2, noise)
        system[:, k, k] = 0.0
        right = np.ones((g, k + 1, m))
        right[:, :k] = np.where(self.missing[:, :, None], 0.0, model(self.away_m))
        weights = np.linalg.solve(system, right)
        depth = np.matmul(self.depth_m[:, None, :], weights[:, :k])[:, 0]
        return depth, np.maximum(model.variance_m2 - (weights * right).sum(axis=1), 0.0)


class HeldOut(NamedTuple):
    """Means of soundings, and the distance (m,) within which data are left out to predict each."""

    data: Data
    apart_m: Floats

    def solved(self, data: Data, models: Iterable[Covariance]) -> Iterator[tuple[Floats, Floats]]:
        """Squares of the errors of predictions from the rest of the data, and their kriging variance."""
        near = _outside(data, self.data.place, self.apart_m)
        system = _System.of(data, self.data.place[:, None, :], near)
        for model in models:
            depth, variance = system.solved(model)
            yield (depth[:, 0] - self.data.depth_m) ** 2, variance[:, 0]


def fitted(data: Data, held_out: HeldOut, spacing_m: float, semivariance_m2: float) -> Covariance:
    """The covariance with the best log score at held-out places.

    held_out: means with little noise. semivariance_m2: at the spacing of the lines.
    """
    models = []
    for smoothness, ratio, factor in product(SMOOTHNESS, RANGES, FACTORS):
        share = 1.0 - float(correlation(smoothness, np.array(1.0 / ratio)))
        models.append(Covariance(smoothness, ratio * spacing_m, factor * semivariance_m2 / share))
    scores = []
    for square, variance in held_out.solved(data, models):
        total = variance + held_out.data.noise_m2
        scores.append(float(np.mean(np.log(total) + np.minimum(square / total, MOST_SD**2))))
    return models[int(np.argmin(scores))]


class Calibration:
    """How much larger or smaller the errors are than the covariance says, from held-out places.

    About each place by its LOCAL nearest ones, as a bottom is rough here and even there; then everywhere by
    the factor with which 90 % of the errors are within their bands. Where noise hides the errors, factors are
    drawn towards 1.

    held_out: means over less than a cell, so that they miss nothing of a rough bottom.
    """

    def __init__(self, data: Data, model: Covariance, held_out: HeldOut) -> None:
        ((square, self._variance),) = held_out.solved(data, [model])
        self._noise = held_out.data.noise_m2
        self._excess = np.minimum(square, MOST_SD**2 * (self._variance + self._noise)) - self._noise
        self._tree = cKDTree(held_out.data.place)
        self._scale = 1.0
        local = np.maximum(self.factor(held_out.data.place, skip=1) * self._variance, 1e-12)
        # |e| ≤ z·sqrt(s·v + n)  ⇔  s ≥ ((e/z)² − n)/v
        found = np.maximum(np.quantile((square / BAND_SD**2 - self._noise) / local, 0.9), 0.0)
        self._scale = float(_drawn(found, DOUBT, PRIOR_SD, np.median(self._noise / local)))

    def factor(self, place: Floats, skip: int = 0) -> Floats:
        """Of the variance at places (m, 2), shape (m,). skip: so many of the nearest held-out places."""
        many = min(LOCAL, self._tree.n - skip)
        near = self._tree.query(place, k=many + skip)[1][:, skip:]
        variance = np.maximum(self._variance[near].sum(axis=1), 1e-12)
        found = np.maximum(self._excess[near].sum(axis=1) / variance, 0.1)
        noise = self._noise[near].sum(axis=1) / variance
        return self._scale * _drawn(found, np.sqrt(2.0 / many), LOCAL_SD, noise)


def _drawn(found: Floats, doubt: float, prior_sd: float, noise: Floats | np.float64) -> Floats:
    """A factor drawn towards 1 by its relative standard error `doubt`, which grows with noise ÷ variance."""
    weight = prior_sd**2 / (prior_sd**2 + (doubt * (1.0 + noise)) ** 2)
    drawn: Floats = 1.0 + weight * (found - 1.0)
    return drawn


def _outside(data: Data, place: Floats, apart_m: Floats) -> Indices:
    """The nearest data of each place beyond its own distance, shape (m, NEIGHBOURS), −1: none."""
    tree = cKDTree(data.place)
    many = min(4 * NEIGHBOURS, len(data.place))
    distance, index = tree.query(place, k=many)
    rank = np.argsort(distance <= apart_m[:, None], axis=1, kind="stable")[:, :NEIGHBOURS]
    chosen = np.take_along_axis(index, rank, axis=1)
    left_out = np.take_along_axis(distance, rank, axis=1) <= apart_m[:, None]
    return np.where(left_out, -1, chosen)


def semivariance_m2(data: Data, lag_m: float) -> float:
    """Half the mean square of differences at about a lag, less the noise. The lag: 0.7 to 1.3 of it."""
    thin = slice(None, None, max(len(data.place) // 5000, 1))
    place, depth, noise = data.place[thin], data.depth_m[thin], data.noise_m2[thin]
    a, b = cKDTree(place).query_pairs(1.3 * lag_m, output_type="ndarray").T
    far = np.hypot(*(place[a] - place[b]).T) > 0.7 * lag_m
    square = ((depth[a] - depth[b]) ** 2 - noise[a] - noise[b])[far]
    return max(0.5 * float(np.mean(square)), 1e-6) if len(square) else max(float(np.var(depth)), 1e-6)
