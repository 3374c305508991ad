"""All runs of the experiment, over all cores."""

from collections.abc import Callable, Sequence
from itertools import product

from sitl.experiments.paper.conditions import CASES, Method
from sitl.experiments.paper.trial import Sailed, sail_trial
from sitl.run.parallel import in_parallel


def sail_all(
    seeds: Sequence[int],
    workers: int,
    tell: Callable[[], None] = lambda: None,
    cases: Sequence[str] = CASES,
    methods: Sequence[Method] = tuple(Method),
) -> list[Sailed]:
    """Sail every case by every method with every seed, in that order whatever ends first.

    tell: called after each run.

    Raises:
        SailError: a boat would not arm or change mode.
    """
    return in_parallel(sail_trial, list(product(cases, methods, seeds)), workers, tell)
