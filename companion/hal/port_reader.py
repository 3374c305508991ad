"""A part that sends bytes over a port, read in a thread."""

import select
from collections.abc import Callable

from companion.hal.background import Background
from companion.hal.interfaces import Link, Port

_PATIENCE_S = 0.2  # longest wait for bytes, and period of reconnection attempts


class PortReader:
    """Passes each chunk to `take`, with its time; `begin` is called after a reconnect.

    The port reconnects an unplugged part. rest_s: minimum time between reads, for a part whose every byte
    would wake the thread.
    """

    def __init__(
        self,
        port: Port,
        now: Callable[[], float],
        take: Callable[[bytes, float], object],
        begin: Callable[[], object],
        rest_s: float = 0.0,
    ) -> None:
        self._port = port
        self._now = now
        self._on_chunk = take
        self._on_open = begin
        self._rest_s = rest_s
        self._links: list[Link] = []
        self._background = Background(self._wait_and_step, port.name)

    def start(self) -> None:
        """Begin to read in a thread."""
        self._background.start()

    def step(self) -> None:
        """Process received bytes. Never waits."""
        for link in self._port.accept():
            self._links.append(link)
            self._on_open()  # drop a partial sentence
        for link in self._links:
            for chunk in link.receive():
                self._on_chunk(chunk, self._now())
        self._links = [link for link in self._links if not link.is_closed]

    def close(self) -> None:
        """Stop the thread and close the port. May be called twice."""
        self._background.close()
        self._port.close()

    def _wait_and_step(self) -> float:
        waiting = {link.fileno() for link in self._links} | {self._port.fileno()}
        waiting.discard(-1)
        if waiting:
            select.select(list(waiting), [], [], _PATIENCE_S)
        self.step()
        return self._rest_s if waiting else _PATIENCE_S
