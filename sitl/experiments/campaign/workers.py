"""Who sails the runs: processes of this machine, or a Dask cluster, behind one executor interface."""

import os
from collections.abc import Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from contextlib import contextmanager
from itertools import islice

from companion.core.errors import BoatError, ConfigError, LinkError
from sitl.experiments.campaign.run import Outcome, Run, sail_run
from sitl.run.parallel import worker_pool

_AHEAD = 2  # runs handed over for each worker: one under way and one that waits


class Crew:
    """An executor, and how many runs it can have under way."""

    def __init__(self, executor: Executor, size: int) -> None:
        self.size = size
        self._executor = executor

    def sail(self, runs: Iterable[Run]) -> Iterator[Outcome]:
        """Every run's outcome, as they come.

        Raises:
            BoatError: a worker has died.
        """
        waiting = iter(runs)
        under_way = {self._submit(run) for run in islice(waiting, _AHEAD * self.size)}
        while under_way:
            done, under_way = wait(under_way, return_when=FIRST_COMPLETED)
            under_way |= {self._submit(run) for run in islice(waiting, len(done))}
            for future in done:
                error = future.exception()
                if error is not None:
                    raise BoatError(
                        f"a worker failed ({error!r}); finished runs are kept, the same command goes on"
                    )
                yield future.result()

    def _submit(self, run: Run) -> "Future[Outcome]":
        return self._executor.submit(sail_run, run)


def cores() -> int:
    """How many cores this process may use."""
    return len(os.sched_getaffinity(0))


@contextmanager
def local_crew(size: int) -> Iterator[Crew]:
    """So many processes of this machine. Leaving early gives up what has not ended."""
    executor = worker_pool(size)
    try:
        yield Crew(executor, size)
    except BaseException:
        executor.terminate()
        raise
    executor.shutdown()


@contextmanager
def cluster_crew(address: str) -> Iterator[Crew]:
    """The workers of a Dask cluster, on which this package is installed.

    Raises:
        ConfigError: Dask is not installed here.
        LinkError: nobody answers at the address.
    """
    try:
        from distributed import Client  # noqa: PLC0415 (an extra)
    except ImportError:
        raise ConfigError("--scheduler needs Dask: pip install 'mavboat[cluster]'") from None
    try:
        client = Client(address, timeout="10s")
    except (OSError, TimeoutError, ValueError) as error:
        raise LinkError(f"--scheduler {address}: {str(error) or 'no answer'}") from None
    with client:
        size = max(1, sum(client.ncores().values()))
        yield Crew(client.get_executor(pure=False), size)
