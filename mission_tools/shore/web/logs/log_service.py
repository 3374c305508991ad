"""What is under way with the boats' logs: downloads and voyages."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

from mission_tools.shore.clock import Clock
from mission_tools.shore.web.logs.stream import LogStream, fetching
from mission_tools.shore.web.logs.voyages import Voyages
from mission_tools.station.boats import Boats

MOST_DOWNLOADS: Final = 8


class LogService:
    """Logs of all boats."""

    def __init__(self, boats: Boats, clock: Clock) -> None:
        self.voyages = Voyages(boats, clock)
        self._boats = boats
        self._under_way: list[tuple[int, str, LogStream]] = []

    def fetched(self, boat: int) -> dict[str, int]:
        """Bytes of each log that have gone to a browser, while it is downloaded; of several the farthest."""
        return {
            name: stream.sent
            for of, name, stream in sorted(self._under_way, key=lambda one: one[2].sent)
            if of == boat
        }

    @contextmanager
    def download(self, boat: int, name: str) -> Iterator[LogStream | None]:
        """A listed log while it is fetched; None if too many are."""
        found = self._boats.get(boat)
        path = None if found is None else found.logs.path(name)
        if found is None or path is None or len(self._under_way) >= MOST_DOWNLOADS:
            yield None
            return
        with fetching(found.files, path) as stream:
            one = boat, name, stream
            self._under_way.append(one)
            try:
                yield stream
            finally:
                self._under_way.remove(one)
