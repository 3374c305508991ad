"""Twins below the drivers: a clock that is set by hand, a serial line that can be unplugged."""

import contextlib
import os
import pty
import time
import tty
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, TypeVar

from patience import MOMENT_S

from companion.links.memory import MemoryPort, memory_pair
from companion.links.retried import Retried

Part = TypeVar("Part", bound=Retried[Any])
Value = TypeVar("Value")


def opened(part: Part) -> Part:
    """A part after its first attempt."""
    part.attempt()
    return part


def known(value: Value | None) -> Value:
    """What a part has measured by now."""
    assert value is not None
    return value


class HandClock:
    """The boat's clock, moved by the test."""

    def __init__(self) -> None:
        self.now_s = 100.0

    def __call__(self) -> float:
        return self.now_s

    def advance(self, seconds: float) -> None:
        self.now_s += seconds


class MemoryLine:
    """A serial line in memory; the test holds the far end."""

    def __init__(self) -> None:
        self.port = MemoryPort()
        self.plug_in()

    def plug_in(self) -> None:
        near, self.far = memory_pair("line", is_datagram=False)
        self.port.offer(near)

    def say(self, data: bytes) -> None:
        assert self.far.send(data)

    def heard(self) -> bytes:
        return b"".join(self.far.receive())


class PtyLine:
    """A serial device under a stable path; the test holds the far end."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._master = -1
        self.plug_in()

    @property
    def device(self) -> str:
        return str(self.path)

    def plug_in(self) -> None:
        self._master, slave = pty.openpty()
        tty.setraw(slave)
        os.set_blocking(self._master, False)
        self.path.symlink_to(os.ttyname(slave))
        os.close(slave)

    def unplug(self) -> None:
        self.path.unlink(missing_ok=True)
        if self._master >= 0:
            os.close(self._master)
            self._master = -1

    def say(self, data: bytes) -> None:
        """Put bytes on the line; as on a real one, what nobody takes is lost."""
        with contextlib.suppress(BlockingIOError):
            os.write(self._master, data)

    def heard(self) -> bytes:
        try:
            return os.read(self._master, 1 << 20)
        except (BlockingIOError, OSError):
            return b""


def gather(receive: Callable[[], Iterable[bytes]], into: list[bytes]) -> list[bytes]:
    """Append what has arrived; returns the list."""
    into.extend(receive())
    return into


def eventually(condition: Callable[[], object]) -> None:
    """Try a condition until it holds: the kernel's own hand-over between two ends takes a moment."""
    deadline_s = time.monotonic() + MOMENT_S
    while not condition():
        assert time.monotonic() < deadline_s, "it never came about"
        time.sleep(0.0005)
