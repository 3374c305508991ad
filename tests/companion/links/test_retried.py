"""Opening what may not be there yet."""

import threading
from collections.abc import Callable

import pytest
from twins.lines import eventually

from companion.core.errors import ConfigError, HardwareError, LinkError
from companion.core.status_text import Severity
from companion.links.memory import MemoryPort, memory_pair
from companion.links.retried import PACE, Pace, Retried, RetriedPort, await_first

pytestmark = pytest.mark.realtime
QUICK = Pace(0.001, 0.001, 60.0)


class Part:
    """Counts how often it was closed."""

    def __init__(self) -> None:
        self.closed = 0

    def close(self) -> None:
        self.closed += 1


class Socket:
    """Where a part is plugged in, or not."""

    def __init__(self, error: Exception | None = None) -> None:
        self.error = error
        self.part = Part()

    def open(self) -> Part:
        if self.error is not None:
            raise self.error
        return self.part


MISSING = HardwareError("INA219: no answer at I²C address 0x40")


def test_a_minute_without_the_part_is_told_once_and_its_return_once() -> None:
    socket = Socket(MISSING)
    part = Retried("Battery monitor", socket.open)
    assert [part.attempt() for _ in range(7)] == [0.5, 1.0, 2.0, 4.0, 8.0, 8.0, 8.0]
    assert part.fault == str(MISSING)
    assert part.take_texts() == [(Severity.WARNING, f"Battery monitor: {MISSING}")]
    socket.error = None
    assert part.attempt() == 0.0
    assert part.take_texts() == [(Severity.NOTICE, "Battery monitor: opened")]
    assert (part.opened, part.fault) == (socket.part, "")


def test_an_error_that_names_the_part_names_it_once() -> None:
    part = Retried("tcpin:0.0.0.0:5760", Socket(LinkError("tcpin:0.0.0.0:5760: in use")).open)
    part.attempt()
    assert [one.text for one in part.take_texts()] == ["tcpin:0.0.0.0:5760: in use"]
    nameless = Retried("Sonar", Socket(ZeroDivisionError()).open)
    nameless.attempt()
    assert nameless.fault == "ZeroDivisionError"


def test_its_thread_tries_until_the_part_is_there() -> None:
    socket = Socket(MISSING)
    part = Retried("Compass", socket.open, QUICK).start()
    await_first([part], QUICK)
    assert part.opened is None
    assert part.error is MISSING
    socket.error = None
    eventually(lambda: part.opened is socket.part)


def test_a_wrong_configuration_is_no_missing_part() -> None:
    part = Retried("Compass", Socket(ConfigError("parts.compass.port")).open).start()
    with pytest.raises(ConfigError, match=r"parts\.compass\.port"):
        await_first([part], QUICK)


def test_a_wrong_configuration_that_shows_late_ends_the_attempts() -> None:
    socket = Socket(MISSING)
    part = Retried("Compass", socket.open, QUICK).start()
    await_first([part], QUICK)
    part.take_texts()
    socket.error = ConfigError("parts.compass.port")
    eventually(lambda: not any(thread.name == "open Compass" for thread in threading.enumerate()))
    assert part.fault == "parts.compass.port"


class Slow:
    """Opens when the test lets it."""

    def __init__(self, socket: Socket) -> None:
        self.begun, self.may_end = threading.Event(), threading.Event()
        self._socket = socket

    def open(self) -> Part:
        self.begun.set()
        self.may_end.wait()
        return self._socket.open()


def test_a_part_that_hangs_does_not_hold_up_the_start() -> None:
    assert 3 * PACE.start_s + 0.9 < 2.0, "motors, parts and links, with the imports"
    slow = Slow(Socket())
    part = Retried("Compass", slow.open).start()
    await_first([part], QUICK._replace(start_s=0.01))
    assert (part.opened, part.fault) == (None, "not open yet")
    slow.may_end.set()
    eventually(lambda: part.opened is not None)


def test_a_part_that_opens_after_the_end_is_closed_again() -> None:
    socket = Socket()
    slow = Slow(socket)
    part = Retried("Compass", slow.open).start()
    slow.begun.wait()
    part.close()
    slow.may_end.set()
    eventually(lambda: socket.part.closed == 1)
    assert part.opened is None


def test_closing_closes_what_is_open_and_ends_the_attempts() -> None:
    socket = Socket()
    part = Retried("Compass", socket.open)
    part.attempt()
    part.close()
    assert socket.part.closed == 1
    missing = Retried("Compass", Socket(MISSING).open, QUICK).start()
    missing.close()
    eventually(lambda: not any(thread.name == "open Compass" for thread in threading.enumerate()))


def test_a_port_has_links_once_it_is_open() -> None:
    near, _ = memory_pair()
    ports: list[Callable[[], MemoryPort]] = []

    def open_port() -> MemoryPort:
        if not ports:
            raise LinkError("memory: not there")
        return ports[0]()

    port = RetriedPort("memory", open_port)
    port.attempt()
    assert (port.accept(), port.fileno()) == ([], -1)
    ports.append(lambda: MemoryPort(near))
    port.attempt()
    assert port.accept() == [near]
    port.close()
    assert near.is_closed
