"""Many runs over all cores, handed back in the order in which they were asked for."""

import multiprocessing
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from typing import TypeVar

from companion import garbage

Outcome = TypeVar("Outcome")


def in_parallel(
    sail: Callable[..., Outcome],
    wanted: Sequence[tuple[object, ...]],
    workers: int,
    tell: Callable[[], None] = lambda: None,
) -> list[Outcome]:
    """`sail` with every tuple of arguments, in that order whatever ends first. tell: called after each run.

    Raises:
        What a run raises: those that have not begun are given up.
    """
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(workers, context, initializer=garbage.settle) as executor:
        under_way = [executor.submit(sail, *one) for one in wanted]
        try:
            for future in as_completed(under_way):
                future.result()
                tell()
        except BaseException:
            executor.shutdown(cancel_futures=True)
            raise
    return [future.result() for future in under_way]
