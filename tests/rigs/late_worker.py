"""A log worker that does its jobs when a test says so."""

from collections import deque

from companion.core.storage import InlineExecutor
from companion.log.sink import Job, Worker


class LateWorker(Worker):
    """Does nothing until told to."""

    def __init__(self, most_jobs: int = 1000) -> None:
        super().__init__(InlineExecutor(), most_jobs=most_jobs)
        self.jobs: deque[Job] = deque()

    def submit(self, job: Job, size_bytes: int = 0) -> bool:
        if len(self.jobs) >= self._most_jobs:
            return False
        self.jobs.append(job)
        return True

    def work(self) -> None:
        while self.jobs:
            self.jobs.popleft()()

    def close(self) -> None:
        self.work()
