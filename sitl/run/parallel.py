"""Worker processes of this machine, and many runs by them in the order in which they were asked for."""

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from multiprocessing import resource_tracker
from typing import Any, TypeVar

from companion.app import garbage_collection as garbage

Outcome = TypeVar("Outcome")


class WorkerPool(ProcessPoolExecutor):
    """Workers that never see Ctrl-C: it is for the process that started them."""

    def submit(self, fn: Callable[..., Outcome], /, *args: Any, **kwargs: Any) -> "Future[Outcome]":  # noqa: ANN401
        """As the executor's; it is here that workers are started."""
        with _interrupts_deferred():
            return super().submit(fn, *args, **kwargs)

    def terminate(self) -> None:
        """End all workers at once: their runs are given up."""
        for worker in multiprocessing.active_children():
            worker.terminate()
        self.shutdown(cancel_futures=True)


def worker_pool(size: int) -> WorkerPool:
    """So many workers, each a fresh interpreter."""
    return WorkerPool(size, multiprocessing.get_context("spawn"), initializer=_sign_on)


@contextmanager
def _interrupts_deferred() -> Iterator[None]:
    """Processes that are started in here have SIGINT blocked; for this one it waits until the end.

    A fresh interpreter imports for a second before it could ignore the signal by itself, and a worker whose
    start is interrupted half-way prints a traceback. Only in the main thread, which is where signals arrive.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    resource_tracker.ensure_running()  # starting it later, it would unblock the signal again
    held: list[int] = []
    before = signal.signal(signal.SIGINT, lambda number, _: held.append(number))
    signal.pthread_sigmask(signal.SIG_BLOCK, (signal.SIGINT,))
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, (signal.SIGINT,))
        signal.signal(signal.SIGINT, before)
        if held:
            signal.raise_signal(signal.SIGINT)


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
            executor.terminate()
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
