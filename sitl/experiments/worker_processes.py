"""Worker processes of this machine that do not react to Ctrl-C and end with their parent."""

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import resource_tracker
from typing import Any, TypeVar

from companion.app import garbage_collection as garbage

T = TypeVar("T")


class WorkerPool(ProcessPoolExecutor):
    """Workers with SIGINT blocked: only the parent process handles it."""

    def submit(self, fn: Callable[..., T], /, *args: Any, **kwargs: Any) -> "Future[T]":  # noqa: ANN401
        """As the executor's, which starts workers here."""
        with _interrupts_deferred():
            return super().submit(fn, *args, **kwargs)

    def terminate(self) -> None:
        """End all workers at once and abandon their work."""
        for worker in multiprocessing.active_children():
            worker.terminate()
        self.shutdown(cancel_futures=True)


def worker_pool(size: int) -> WorkerPool:
    """A pool of fresh interpreters."""
    return WorkerPool(size, multiprocessing.get_context("spawn"), initializer=_initialize)


@contextmanager
def _interrupts_deferred() -> Iterator[None]:
    """Start processes with SIGINT blocked; in this process it is delivered on exit.

    A fresh interpreter imports for a second before it could ignore the signal by itself, and an interrupted
    start prints a traceback. Only in the main thread, which receives the signals.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    resource_tracker.ensure_running()  # started later, it would unblock the signal
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


def _initialize() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_exit_with_parent, daemon=True).start()
    garbage.settle()


def _exit_with_parent() -> None:
    """The queue alone would keep a worker alive after its parent was killed."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
