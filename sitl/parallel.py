"""Worker processes of this machine, and many runs by them in the order in which they were asked for."""

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from typing import TypeVar

from companion import garbage

Outcome = TypeVar("Outcome")


def worker_pool(size: int) -> ProcessPoolExecutor:
    """So many workers, each a fresh interpreter."""
    return ProcessPoolExecutor(size, multiprocessing.get_context("spawn"), initializer=_sign_on)


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
    with worker_pool(workers) as executor:
        under_way = [executor.submit(sail, *one) for one in wanted]
        try:
            for future in as_completed(under_way):
                future.result()
                tell()
        except BaseException:
            executor.shutdown(cancel_futures=True)
            raise
    return [future.result() for future in under_way]


def _sign_on() -> None:
    """A worker leaves Ctrl-C to whoever hands out the work, and does not outlive them."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_leave_with_parent, daemon=True).start()
    garbage.settle()


def _leave_with_parent() -> None:
    """A parent that was killed calls nobody off; its queue alone would keep the worker for ever."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
