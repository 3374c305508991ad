"""A boat's parameters from voyages: output error with multiple shooting.

The model is run through segments of a voyage, each from a speed of its own, and compared with what
receiver, gyro and battery monitor measured (R. E. Maine and K. W. Iliff, *Application of Parameter
Estimation to Aircraft Stability and Control*, NASA RP-1168, 1986, chapter 5; structure: T. I. Fossen,
*Handbook of Marine Craft Hydrodynamics and Motion Control*, 2nd edition, Wiley 2021, chapter 6). The turn
rate is the one predicted by a filter that knows gusts, whose strength is found with the rest (R. V.
Jategaonkar, *Flight Vehicle System Identification*, 2nd edition, AIAA 2015, chapter 5: filter error). The
receiver's filter colours the other residuals. All are whitened by a first-order filter for each output, found
from the residuals of the last round, as generalised least squares do (L. Ljung, *System Identification*,
2nd edition, 1999, section 7.4), with a robust loss.

A parameter is the logarithm of a factor on the base boat's value and known beforehand within exp(PRIOR). So
what a voyage does not tell stays where it was, with the uncertainty that it had.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain
from operator import attrgetter
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from sitl.twin.model import DISTURBANCES, KEYS, LEFT, RIGHT, simulate
from sitl.twin.segmented_voyage import CHANNELS, CURRENT_M_S, NUISANCE, OF_RUN, SEGMENT_S, SegmentedVoyage
from sitl.twin.voyage import Floats, Voyage
from sitl.world.scenario import Scenario

Flags = NDArray[np.bool_]

PRIOR: Final = 0.7
"""A factor of two either way."""
UNTOLD: Final = 0.35
"""A larger deviation than this, half of what was known before: the voyage does not tell the parameter."""
_NOISE: Final = (0.1, 0.1, 0.05, 0.2)  # deviations in the first round
_STEP: Final = 2e-3  # of a parameter in deviations, for differences
_LOSS: Final = 2.0  # deviations, beyond which a residual counts less
_ENOUGH: Final = {"linear": 1e-3, "soft_l1": 1e-5}  # relative change of the cost
_START_M_S: Final = 0.2  # of the speed at the beginning of a segment


def fitted_keys(base: Scenario) -> tuple[str, ...]:
    """The parameters of a boat's file that are fitted: those that the base boat has."""
    other = "thrusters.esc.dead_band" if base.thrusters.esc is None else "thrusters.motor.no_load_a"
    return tuple(key for key in KEYS if key not in {other, RIGHT} and attrgetter(key)(base) > 0.0)


def factors_of(keys: Sequence[str], logs: Floats) -> dict[str, Floats]:
    """Factors on the base boat's values, shape (boats, 1), from logarithms, shape (boats, keys). What one
    motor gains, the other loses.
    """
    factors = {key: np.exp(logs[:, n, None]) for n, key in enumerate(keys)}
    return {**factors, RIGHT: 1.0 / factors[LEFT]}


def weather(nuisances: Floats) -> tuple[Floats, Floats, Floats]:
    """Wind north and east, and disturbances, for boats with these nuisances, one a row."""
    north, east, *logs = (nuisances[:, :OF_RUN] * NUISANCE[:OF_RUN]).T[..., None]
    return north, east, np.reshape(DISTURBANCES, (3, 1, 1)) * np.exp(logs)


@dataclass(frozen=True, slots=True)
class Fit:
    """logs: of the factors on the base boat's values, by fitted key; told: whether the voyages tell it, else
    its logarithm is 0. covariance: of all logs, what was known beforehand included. By voyage: nuisances, in
    their deviations, and residuals by channel, in deviations of white noise.
    """

    base: Scenario
    keys: tuple[str, ...]
    logs: Floats
    told: Flags
    covariance: Floats
    segmented: tuple[SegmentedVoyage, ...]
    nuisances: tuple[Floats, ...]
    residuals: tuple[list[Floats], ...]


def following(
    fit: Fit, voyage: Voyage, segment_s: float = SEGMENT_S
) -> tuple[SegmentedVoyage, Floats, Floats]:
    """A further voyage, what the model makes of its commands, headings and turn rates, with wind and current
    as they were at the end of the first one; and these as nuisances.
    """
    segments, first, known = SegmentedVoyage(voyage, fit.base, segment_s), fit.segmented[0], fit.nuisances[0]
    nuisance = np.zeros(segments.nuisances)
    nuisance[: len(NUISANCE)] = known[: len(NUISANCE)]
    flow = [one[-1] for one in first.flow_m_s(known)]
    nuisance[len(NUISANCE) :].reshape(2, -1)[:, 0] = np.divide(flow, CURRENT_M_S)
    facing = segments.inputs.heading_rad[0]
    surge_m_s = segments.surge_m_s - flow[0] * np.cos(facing) - flow[1] * np.sin(facing)
    factors = factors_of(fit.keys, fit.logs[None])
    run = simulate(fit.base, factors, segments.inputs, surge_m_s, *weather(known[None]))
    return segments, run[:, :, 0], nuisance


class _Problem:
    """Residuals and their derivatives. Unknowns are in deviations of what is known beforehand: the fitted
    keys' logarithms, then for each voyage its nuisances and the speeds at the beginning of its segments.
    """

    def __init__(self, base: Scenario, segmented: Sequence[SegmentedVoyage]) -> None:
        self.base, self.segmented, self.keys = base, segmented, fitted_keys(base)
        self.noise, self.correlation = np.array(_NOISE), np.zeros(len(CHANNELS))
        self.parts: list[tuple[slice, slice]] = []
        self.size = len(self.keys)
        for segments in segmented:
            middle, end = self.size + segments.nuisances, self.size + segments.nuisances + segments.count
            self.parts.append((slice(self.size, middle), slice(middle, end)))
            self.size = end
        self._known: tuple[Floats, list[Floats], list[Floats]] | None = None

    def _run(self, segments: SegmentedVoyage, logs: Floats, nuisances: Floats, starts: Floats) -> Floats:
        """Of boats, one a row."""
        speed, factors = segments.surge_m_s + _START_M_S * starts, factors_of(self.keys, PRIOR * logs)
        return simulate(self.base, factors, segments.inputs, speed, *weather(nuisances))

    def evaluate(self, x: Floats) -> tuple[list[Floats], list[Floats]]:
        """Residuals of all channels of all voyages, one after the other, and their derivatives."""
        if self._known is None or not np.array_equal(x, self._known[0]):
            pairs = [self._of_voyage(x, *one) for one in zip(self.segmented, self.parts, strict=True)]
            rows, slopes = ([*chain(*one)] for one in zip(*pairs, strict=True))
            self._known = x.copy(), rows, slopes
        return self._known[1:]

    def _of_voyage(
        self, x: Floats, segments: SegmentedVoyage, part: tuple[slice, slice]
    ) -> tuple[list[Floats], list[Floats]]:
        (own, begun), count, nuisance = part, len(self.keys), x[part[0]]
        # Boats: as it is, one for each key, wind, disturbances, speed at the beginning
        boats = count + OF_RUN + 2
        logs, airs, starts = (np.tile(one, (boats, 1)) for one in (x[:count], nuisance, x[begun]))
        logs[1 : count + 1] += _STEP * np.eye(count)
        airs[count + 1 : -1, :OF_RUN] += _STEP * np.eye(OF_RUN)
        starts[-1] += _STEP
        run = self._run(segments, logs, airs, starts)
        first = segments.predicted(run[:, :, 0], nuisance)
        slopes = [np.zeros((len(one), self.size)) for one in first]
        moved = nuisance + _STEP * np.eye(segments.nuisances)
        columns = [(n, run[:, :, n + 1], nuisance) for n in range(count)]
        columns += [(own.start + n, run[:, :, count + 1 + n], nuisance) for n in range(OF_RUN)]
        columns += [(own.start + n, run[:, :, 0], moved[n]) for n in range(OF_RUN, segments.nuisances)]
        for column, output, changed in columns:
            for slope, one, other in zip(slopes, segments.predicted(output, changed), first, strict=True):
                slope[:, column] = (one - other) / _STEP
        other_starts = segments.predicted(run[:, :, -1], nuisance)
        for slope, one, other, segment in zip(slopes, other_starts, first, segments.segment, strict=True):
            slope[np.arange(len(one)), begun.start + segment] = (one - other) / _STEP
        return [one - other for one, other in zip(first, segments.measured, strict=True)], slopes

    def guess_wind(self, x: Floats) -> None:
        """Take the wind of each voyage that fits best, since derivatives do not lead from one direction to
        another.
        """
        count, turns = len(self.keys), np.exp(0.25j * math.pi * np.arange(8))
        around = np.concatenate([[0.0], 0.6 * turns, 1.2 * turns])
        for segments, (own, begun) in zip(self.segmented, self.parts, strict=True):
            winds = np.vstack([x[own][:2], np.column_stack([around.real, around.imag])])
            airs = np.tile(x[own], (len(winds), 1))
            airs[:, :2] = winds
            run = self._run(segments, np.tile(x[:count], (len(winds), 1)), airs, x[begun])
            costs = np.zeros(len(winds))
            for n, output in enumerate(run.transpose(2, 0, 1, 3)):
                found = zip(segments.predicted(output, x[own]), segments.measured, self.noise, strict=True)
                costs[n] = sum(np.log1p(((one - other) / noise) ** 2).sum() for one, other, noise in found)
            x[own.start : own.start + 2] = winds[np.nanargmin(costs)]

    def whitened(self, rows: Sequence[Floats]) -> list[Floats]:
        """Rows of the channels in deviations of white noise."""
        out, numbers = [], chain(*(segments.segment for segments in self.segmented))
        for n, (one, segment) in enumerate(zip(rows, numbers, strict=True)):
            keep = self.correlation[n % len(CHANNELS)]
            white, later = one * math.sqrt(1.0 - keep * keep), np.flatnonzero(np.diff(segment) == 0) + 1
            white[later] = one[later] - keep * one[later - 1]
            out.append(white / (self.noise[n % len(CHANNELS)] * math.sqrt(1.0 - keep * keep)))
        return out

    def learn_noise(self, x: Floats) -> None:
        """Deviation and correlation of each channel from its residuals, robustly."""
        for n in range(len(CHANNELS)):
            row = np.concatenate(self.evaluate(x)[0][n :: len(CHANNELS)])
            if len(row) > 1:
                limit = 3.0 * 1.4826 * np.median(np.abs(row))  # the median of a normal one is 1 / 1.4826
                row = np.clip(row, -limit, limit)
                self.noise[n] = math.sqrt(row @ row / len(row))
                self.correlation[n] = np.clip(row[1:] @ row[:-1] / (row @ row), 0.0, 0.99)

    def solved(self, x: Floats, free: Flags, loss: str) -> Floats:
        """The least squares over the free unknowns."""

        def whole(part: Floats) -> Floats:
            out = x.copy()
            out[free] = part
            return out

        found = least_squares(
            lambda part: np.concatenate([*self.whitened(self.evaluate(whole(part))[0]), part]), x[free],
            lambda part: np.vstack(
                [*(one[:, free] for one in self.whitened(self.evaluate(whole(part))[1])), np.eye(len(part))]
            ),
            loss=loss, f_scale=_LOSS, ftol=_ENOUGH[loss], xtol=1e-4, max_nfev=25, tr_solver="lsmr",
        )  # fmt: skip
        return whole(found.x)

    def information(self, x: Floats) -> Floats:
        """Of all unknowns, what is known beforehand included."""
        information: Floats = np.eye(self.size)
        for row, slope in zip(*(self.whitened(one) for one in self.evaluate(x)), strict=True):
            if len(row):
                information += slope.T @ slope * ((1.0 + (row / _LOSS) ** 2) ** -1.5).mean()  # of soft_l1
        return information


def fit_boat(base: Scenario, voyages: Sequence[Voyage]) -> Fit:
    """Fit a boat to its voyages, and leave at the base boat's value what they do not tell. Not told, too, are
    advances with which the thrust outlasts the torque: no propeller has them.
    """
    segmented = tuple(SegmentedVoyage(voyage, base) for voyage in voyages)
    problem = _Problem(base, segmented)
    x, free, count = np.zeros(problem.size), np.ones(problem.size, dtype=np.bool_), len(problem.keys)
    for loss in ("linear", "soft_l1", "soft_l1"):
        problem.guess_wind(x)
        x = problem.solved(x, free, loss)
        problem.learn_noise(x)
    x = problem.solved(x, free, "soft_l1")
    ends = [problem.keys.index(f"thrusters.propeller.zero_{what}_advance") for what in ("thrust", "torque")]
    most = math.log(
        base.thrusters.propeller.zero_torque_advance / base.thrusters.propeller.zero_thrust_advance
    )
    free[ends] = PRIOR * (x[ends[0]] - x[ends[1]]) < most
    information = problem.information(x)
    covariance = PRIOR**2 * np.asarray(np.linalg.inv(information)[:count, :count], dtype=np.float64)
    while free[:count].any():
        # The worst first: what two tell together, one of them keeps
        alone = np.sqrt(np.diag(np.linalg.inv(information[np.ix_(free, free)])))[: free[:count].sum()]
        if PRIOR * alone.max() <= UNTOLD:
            break
        free[np.flatnonzero(free[:count])[alone.argmax()]] = False
    if not free.all():
        x[~free] = 0.0
        x = problem.solved(x, free, "soft_l1")
    if PRIOR * (x[ends[0]] - x[ends[1]]) >= most:
        x[ends], free[ends] = 0.0, False
        x = problem.solved(x, free, "soft_l1")
    white = problem.whitened(problem.evaluate(x)[0])
    return Fit(
        base, problem.keys, PRIOR * x[:count], free[:count], covariance, segmented,
        tuple(x[own] for own, _ in problem.parts),
        tuple(white[n : n + len(CHANNELS)] for n in range(0, len(white), len(CHANNELS))),
    )  # fmt: skip
