"""All runs of the experiment, over all cores."""

import multiprocessing
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from itertools import product

from companion import garbage
from sitl.paper.conditions import CASES, Method
from sitl.paper.trial import Sailed, sail_trial


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
    wanted = list(product(cases, methods, seeds))
    done: dict[tuple[str, Method, int], Sailed] = {}
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(workers, context, initializer=garbage.settle) as executor:
        under_way = {executor.submit(sail_trial, *one): one for one in wanted}
        try:
            for future in as_completed(under_way):
                done[under_way[future]] = future.result()
                tell()
        except BaseException:
            executor.shutdown(cancel_futures=True)
            raise
    return [done[one] for one in wanted]
