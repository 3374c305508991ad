"""A ranger on a serial line that sends frames by itself."""

import select
import time
from collections.abc import Callable, Iterator
from typing import Final

from companion.core.errors import HardwareError
from companion.hal.ranging.serial_frames import Decoder, FrameKind, FrameParser
from companion.links.interfaces import Link, Port

_PATIENCE_S: Final = 0.5  # more than the period of the slowest part, and of a servo's step
_POLL_S: Final = 0.05


class SerialRanger:
    """Satisfies `Ranger`. The port reconnects an unplugged part.

    waits: select.select, and its clock.
    """

    def __init__(
        self,
        port: Port,
        kind: FrameKind,
        decode: Decoder,
        max_range_m: float,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.period_s = 0.05
        self._port = port
        self._kind = kind
        self._decode = decode
        self._max_range_m = max_range_m
        self._clock = clock
        self._links: list[Link] = []
        self.parser = FrameParser(kind)

    def ping_m(self) -> float | None:
        """The newest range that has arrived, or the next one; takes up to half a second.

        Raises:
            HardwareError: no frame arrives, or the part is blinded.
        """
        deadline_s = self._clock() + _PATIENCE_S
        while True:
            frames = [frame for chunk in self._receive() for frame in self.parser.feed(chunk)]
            if frames:
                range_m = self._decode(frames[-1])
                return None if range_m is None or range_m > self._max_range_m else range_m
            if self._clock() >= deadline_s:
                raise HardwareError(f"{self._kind.name}: no frames; check its wires and {self._port.name}")
            descriptors = [link.fileno() for link in self._links]
            select.select(descriptors, [], [], _POLL_S)

    def forget(self) -> None:
        """Drop what was measured until now."""
        for _ in self._receive():
            pass
        self.parser.forget()

    def close(self) -> None:
        """Release the port. May be called twice."""
        self._port.close()

    def _receive(self) -> Iterator[bytes]:
        for link in self._port.accept():
            self._links.append(link)
            self.parser.forget()
        for link in self._links:
            yield from link.receive()
        self._links = [link for link in self._links if not link.is_closed]
