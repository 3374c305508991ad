"""Successive halving: many sets of gains are tried a little, the better half of them more (Jamieson and
Talwalkar, AISTATS 2016). After each round the next one looks closer around the best.

It needs no derivative, forgives noise, and is a function of its seed: the same search again asks for the same
runs under the same numbers, so that those kept from before need not be sailed again.
"""

from collections.abc import Callable, Iterator
from statistics import fmean
from typing import NamedTuple

from sitl.experiments.campaign.run import Outcome, Run
from sitl.experiments.tuning.gains import Gains, drawn_around
from sitl.experiments.tuning.trial import Trials
from sitl.world.sensors import generator

REACHES = (4.0, 2.0, 1.4)  # of each round: within this factor of the best so far
CANDIDATES = 16
KEPT = 0.4
_MOST_SEEDS = 4

Sail = Callable[[list[Run]], list[Outcome]]


class Standing(NamedTuple):
    """Where a search is: the round, the best set of those just compared, and the costs of all of them over
    those of the gains to begin with, lowest first.
    """

    round: int
    best: Gains
    ratios: tuple[float, ...]


class _Tried:
    """What each set of gains has come to so far, seed by seed: nothing is sailed twice."""

    def __init__(self, trials: Trials, seed: int, sail: Sail) -> None:
        self._trials = trials
        self._seed = seed
        self._sail = sail
        self._number = 1
        self._outcomes: dict[tuple[float, ...], list[Outcome]] = {}

    def ratios(self, field: list[Gains], first: Gains, seeds: int) -> list[float]:
        """The mean ratio of each set of gains to the first, over so many seeds."""
        asked: list[tuple[list[Outcome], list[Run]]] = []
        for gains in field:
            known = self._outcomes.setdefault(tuple(gains.values()), [])
            unknown = range(self._seed + len(known) // self._trials.waters, self._seed + seeds)
            asked.append((known, self._trials.runs(gains, unknown, self._number)))
            self._number += len(asked[-1][1])
        outcomes = iter(self._sail([run for _, runs in asked for run in runs]))
        for known, runs in asked:
            known.extend(next(outcomes) for _ in runs)
        of_first = self._outcomes[tuple(first.values())]
        count = seeds * self._trials.waters
        return [
            fmean(self._trials.ratios(self._outcomes[tuple(gains.values())][:count], of_first))
            for gains in field
        ]


def search(
    trials: Trials, first: Gains, seed: int, sail: Sail, candidates: int = CANDIDATES
) -> Iterator[Standing]:
    """The standing after every comparison; the last one's best is the result.

    The gains to begin with are in every comparison, so that the result is never worse on the trials.
    sail: the outcomes of runs, in their order.
    """
    tried, best = _Tried(trials, seed, sail), first
    for round_, reach in enumerate(REACHES):
        random = generator(seed, f"tune/{round_}")
        known = [first] if best == first else [first, best]
        field = [*known, *drawn_around(best, reach, candidates - len(known), random)]
        seeds = 1
        while True:
            ratios = tried.ratios(field, first, seeds)
            order = sorted(range(len(field)), key=ratios.__getitem__)
            best = field[order[0]]
            yield Standing(round_ + 1, best, tuple(ratios[n] for n in order))
            if len(field) <= 3 or seeds >= _MOST_SEEDS:
                break
            kept = order[: max(2, round(KEPT * len(field)))]
            field = [field[n] for n in kept if field[n] != first]
            field.insert(0, first)
            seeds *= 2
