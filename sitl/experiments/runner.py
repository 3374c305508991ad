"""The runner of every experiment: trials on the processes of this machine or on a Dask cluster."""

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ProcessPoolExecutor, wait
from contextlib import contextmanager
from itertools import islice
from multiprocessing import resource_tracker
from typing import Any, TypeVar

from companion.app import garbage_collection as garbage
from companion.cli.program_end import how_to_install
from companion.core.errors import BoatError, ConfigError, LinkError
from sitl.experiments.result_log import ResultLog
from sitl.experiments.trial import Task, Trial, TrialResult, attempt

_QUEUED_PER_WORKER = 2  # one running and one waiting


class TrialPool:
    """An executor, and how many trials it runs at a time."""

    def __init__(self, executor: Executor, size: int) -> None:
        self.executor = executor
        self._size = size

    def run(self, task: Task, trials: Iterable[Trial]) -> Iterator[TrialResult]:
        """Every trial's result, in the order in which they end. Raises BoatError: a worker died."""
        waiting = iter(trials)
        running = {
            self.executor.submit(attempt, task, trial)
            for trial in islice(waiting, _QUEUED_PER_WORKER * self._size)
        }
        while running:
            done, running = wait(running, return_when=FIRST_COMPLETED)
            running |= {self.executor.submit(attempt, task, trial) for trial in islice(waiting, len(done))}
            for future in done:
                error = future.exception()
                if error is not None:
                    raise BoatError(
                        f"a worker failed ({error!r}); finished runs are kept, the same command continues"
                    )
                yield future.result()


def run_trials(
    pool: TrialPool,
    task: Task,
    trials: Sequence[Trial],
    log: ResultLog | None = None,
    advance: Callable[[], None] = lambda: None,
    is_strict: bool = False,
) -> list[TrialResult]:
    """Results in the order of the trials. Trials whose result is in the log are not run again.

    advance: called after each trial. is_strict: a trial that is refused or fails ends the experiment. Raises
    BoatError: a worker died, or a trial failed where none may.
    """
    finished = {} if log is None else dict(log.results)
    for result in pool.run(task, [trial for trial in trials if trial.number not in finished]):
        if is_strict and result.ended in ("refused", "error"):
            raise BoatError(result.traceback or result.why)
        finished[result.number] = result
        if log is not None:
            log.add(result)
        advance()
    return [finished[trial.number] for trial in trials]


def cores() -> int:
    """How many cores this process may use."""
    return len(os.sched_getaffinity(0))


@contextmanager
def local_pool(size: int) -> Iterator[TrialPool]:
    """A pool of processes of this machine. Leaving it early abandons unfinished trials."""
    executor = WorkerPool(size, multiprocessing.get_context("spawn"), initializer=_initialize)
    try:
        yield TrialPool(executor, size)
    except BaseException:
        executor.terminate()
        raise
    executor.shutdown()


@contextmanager
def cluster_pool(address: str) -> Iterator[TrialPool]:
    """The workers of a Dask cluster, on which this package is installed.

    Raises ConfigError: Dask is not installed here; LinkError: no scheduler answers at the address.
    """
    try:
        from distributed import Client  # noqa: PLC0415 (an extra)
    except ImportError:
        raise ConfigError(f"--scheduler needs Dask: {how_to_install('cluster')}") from None
    try:
        client = Client(address, timeout="10s")
    except (OSError, TimeoutError, ValueError) as error:
        raise LinkError(f"--scheduler {address}: {str(error) or 'no answer'}") from None
    with client:
        size = max(1, sum(client.ncores().values()))
        yield TrialPool(client.get_executor(pure=False), size)


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
