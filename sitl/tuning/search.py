"""Successive halving: many sets of gains are tried a little, the better half of them more (Jamieson and
Talwalkar, AISTATS 2016). After each round the next one looks closer around the best.

It needs no derivative, forgives noise, and is a function of its seed: the same search again asks for the same
runs under the same numbers, so that those kept from before need not be sailed again.
"""

from collections.abc import Callable, Iterator
from typing import NamedTuple

from sitl.campaign.run import Outcome, Run
from sitl.sensors import generator
from sitl.tuning.gains import Gains, drawn_around
from sitl.tuning.trial import Trials

REACHES = (4.0, 2.0, 1.4)  # of each round: within this factor of the best so far
CANDIDATES = 16
KEPT = 0.4
_MOST_SEEDS = 4

Sail = Callable[[list[Run]], list[Outcome]]


class Standing(NamedTuple):
    """Where a search is: the round, how many sets were just compared, the best of them and its cost."""

    round: int
    compared: int
    best: Gains
    cost: float


def search(
    trials: Trials, first: Gains, seed: int, sail: Sail, candidates: int = CANDIDATES
) -> Iterator[Standing]:
    """The standing after every comparison; the last one's best is the result.

    The gains to begin with are a candidate of every round, so that the result is never worse on the trials.
    sail: the outcomes of runs, in their order.
    """
    number, best = 1, first
    for round_, reach in enumerate(REACHES):
        random = generator(seed, f"tune/{round_}")
        known = [first] if best == first else [first, best]
        field = [*known, *drawn_around(best, reach, candidates - len(known), random)]
        seeds = 1
        while True:
            asked = []
            for gains in field:
                asked.append(trials.runs(gains, range(seed, seed + seeds), number))
                number += len(asked[-1])
            outcomes = iter(sail([run for runs in asked for run in runs]))
            costs = [trials.cost([next(outcomes) for _ in runs]) for runs in asked]
            order = sorted(range(len(field)), key=costs.__getitem__)
            best = field[order[0]]
            yield Standing(round_ + 1, len(field), best, costs[order[0]])
            if len(field) <= 2 or seeds >= _MOST_SEEDS:
                break
            kept = order[: max(2, round(KEPT * len(field)))]
            field = [field[n] for n in kept]
            seeds *= 2
