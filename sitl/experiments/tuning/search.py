"""Successive halving: many sets of gains are compared on few runs, the better half of them on more (Jamieson
and Talwalkar, AISTATS 2016). Each round after the first searches closer around the best.

The search needs no derivative and tolerates noise. It is a function of its seed: when repeated, it asks for
the same trials under the same numbers, so that stored results are used again.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from statistics import fmean, stdev
from typing import NamedTuple

from sitl.experiments.trial import Trial, TrialResult
from sitl.experiments.tuning.problem import Gains, TuningProblem, drawn_around
from sitl.world.sampling import generator

REACHES = (4.0, 2.0, 1.4)  # per round: gains within this factor of the best
CANDIDATES = 16
KEPT = 0.4
_MOST_SEEDS = 4

RunTrials = Callable[[list[Trial]], list[TrialResult]]


class Ranking(NamedTuple):
    """One comparison: its round, the best gains, and all costs relative to the original ones, in order."""

    round: int
    best: Gains
    ratios: tuple[float, ...]


class _Evaluations:
    """The results of each set of gains so far, seed by seed; no trial is run twice."""

    def __init__(self, problem: TuningProblem, seed: int, run: RunTrials) -> None:
        self._problem = problem
        self._seed = seed
        self._run = run
        self._number = 1
        self._results: dict[tuple[float, ...], list[TrialResult]] = {}

    def ratios(self, field: list[Gains], first: Gains, seeds: int) -> list[float]:
        """The mean cost ratio of each set of gains to the first, over this many seeds."""
        asked: list[tuple[list[TrialResult], list[Trial]]] = []
        for gains in field:
            known = self._results.setdefault(tuple(gains.values()), [])
            unknown = range(self._seed + len(known) // self._problem.trials_per_seed, self._seed + seeds)
            asked.append((known, self._problem.trials(gains, unknown, self._number)))
            self._number += len(asked[-1][1])
        results = iter(self._run([trial for _, trials in asked for trial in trials]))
        for known, trials in asked:
            known.extend(next(results) for _ in trials)
        of_first = self._results[tuple(first.values())]
        count = seeds * self._problem.trials_per_seed
        return [
            fmean(self._problem.ratios(self._results[tuple(gains.values())][:count], of_first))
            for gains in field
        ]


def search(
    problem: TuningProblem, first: Gains, seed: int, run: RunTrials, candidates: int = CANDIDATES
) -> Iterator[Ranking]:
    """The ranking after every comparison; the best of the last one is the result.

    The original gains are in every comparison, so the result is never worse on the trials of the search.
    run: returns the results of trials in their order.
    """
    evaluations, best = _Evaluations(problem, seed, run), first
    for round_, reach in enumerate(REACHES):
        random = generator(seed, f"tune/{round_}")
        known = [first] if best == first else [first, best]
        field = [*known, *drawn_around(best, reach, candidates - len(known), random)]
        seeds = 1
        while True:
            ratios = evaluations.ratios(field, first, seeds)
            order = sorted(range(len(field)), key=ratios.__getitem__)
            best = field[order[0]]
            yield Ranking(round_ + 1, best, tuple(ratios[n] for n in order))
            if len(field) <= 3 or seeds >= _MOST_SEEDS:
                break
            kept = order[: max(2, round(KEPT * len(field)))]
            field = [field[n] for n in kept if field[n] != first]
            field.insert(0, first)
            seeds *= 2


class GainComparison(NamedTuple):
    """ratio: the mean of costs relative to the baseline; uncertainty: two standard errors of that mean."""

    ratio: float
    uncertainty: float

    @property
    def is_better(self) -> bool:
        """Significantly better; a false positive once in forty times."""
        return self.ratio + self.uncertainty < 1.0


def compare(ratios: Sequence[float]) -> GainComparison:
    """ratios: of the costs of at least two runs, in the same water with the same seed."""
    return GainComparison(fmean(ratios), 2.0 * stdev(ratios) / math.sqrt(len(ratios)))
