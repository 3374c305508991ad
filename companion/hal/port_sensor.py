"""A sensor that sends bytes over a port, read in a thread."""

import select
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable
from typing import Protocol, TypeVar

from companion.hal.background import BackgroundSensor, Reading
from companion.links.interfaces import Link, Port

Reading_co = TypeVar("Reading_co", covariant=True)
_PATIENCE_S = 0.2  # longest wait for bytes, and period of reconnection attempts


class PortSensor(ABC, BackgroundSensor[Reading]):
    """Keeps the latest reading. The port reconnects an unplugged part.

    rest_s: minimum time between reads, for a part whose every byte would wake the thread. patience_s: longest
    wait for bytes, for a part that is spoken to.
    """

    def __init__(
        self, port: Port, now: Callable[[], float], rest_s: float = 0.0, patience_s: float = _PATIENCE_S
    ) -> None:
        super().__init__(self._wait_and_step, port.name, now, port.close)
        self._port = port
        self._rest_s = rest_s
        self._patience_s = patience_s
        self._links: list[Link] = []

    @abstractmethod
    def _decode(self, chunk: bytes, time_s: float) -> Iterable[Reading]:
        """The readings that these bytes complete."""

    @abstractmethod
    def _forget(self) -> None:
        """Drop a partial message, after a reconnect."""

    def step(self) -> None:
        """Process received bytes. Never waits."""
        for link in self._port.accept():
            self._links.append(link)
            self._forget()
        for link in self._links:
            for chunk in link.receive():
                for reading in self._decode(chunk, self._now()):
                    self._latest = reading
        self._links = [link for link in self._links if not link.is_closed]

    def _wait_and_step(self) -> float:
        waiting = {link.fileno() for link in self._links} | {self._port.fileno()}
        waiting.discard(-1)
        if waiting:
            select.select(list(waiting), [], [], self._patience_s)
        self.step()
        return self._rest_s if waiting else self._patience_s


class Parser(Protocol[Reading_co]):
    """Makes readings of bytes. feed: of what has arrived, the latest; None if they complete none."""

    def feed(self, data: bytes, time_s: float, /) -> Reading_co | None: ...
    def forget(self) -> None: ...


class ParsedSensor(PortSensor[Reading]):
    """One that only speaks. Satisfies `companion.hal.interfaces.Sensor`."""

    def __init__(
        self, port: Port, now: Callable[[], float], parser: Parser[Reading], rest_s: float = 0.0
    ) -> None:
        super().__init__(port, now, rest_s)
        self.parser = parser

    def _decode(self, chunk: bytes, time_s: float) -> Iterable[Reading]:
        reading = self.parser.feed(chunk, time_s)
        return () if reading is None else (reading,)

    def _forget(self) -> None:
        self.parser.forget()
