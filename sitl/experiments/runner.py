"""The runner of every experiment: trials on the processes of this machine or on a Dask cluster."""

import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, wait
from contextlib import contextmanager
from itertools import islice

from companion.cli.program_end import how_to_install
from companion.core.errors import BoatError, ConfigError, LinkError
from sitl.experiments.result_log import ResultLog
from sitl.experiments.trial import Task, Trial, TrialResult, attempt
from sitl.experiments.worker_processes import worker_pool

_QUEUED_PER_WORKER = 2  # one running and one waiting


class TrialPool:
    """An executor, and how many trials it runs at a time."""

    def __init__(self, executor: Executor, size: int) -> None:
        self.executor = executor
        self._size = size

    def run(self, task: Task, trials: Iterable[Trial]) -> Iterator[TrialResult]:
        """Every trial's result, in the order in which they end.

        Raises:
            BoatError: a worker died.
        """
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

    advance: called after each trial. is_strict: a trial that is refused or fails ends the experiment.

    Raises:
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
    executor = worker_pool(size)
    try:
        yield TrialPool(executor, size)
    except BaseException:
        executor.terminate()
        raise
    executor.shutdown()


@contextmanager
def cluster_pool(address: str) -> Iterator[TrialPool]:
    """The workers of a Dask cluster, on which this package is installed.

    Raises:
        ConfigError: Dask is not installed here.
        LinkError: no scheduler answers at the address.
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
