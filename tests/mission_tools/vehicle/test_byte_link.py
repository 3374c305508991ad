"""Each kind of link that `--sign-key` opens, against plain sockets and a pseudo-terminal."""

import asyncio
import os
import pty
import socket
import tty
from collections.abc import Callable, Coroutine

import pytest

from mission_tools.vehicle.byte_link import ByteLink, open_byte_link

pytestmark = pytest.mark.realtime

PATIENCE_S = 120.0


class Ear:
    """Keeps what arrives; `counts` says what is worth an answer."""

    def __init__(self, counts: Callable[[bytes], bool] = bool) -> None:
        self.heard = b""
        self._counts = counts
        self._news = asyncio.Event()

    def __call__(self, data: bytes) -> bool:
        self.heard += data
        self._news.set()
        return self._counts(data)

    async def wait_for(self, data: bytes) -> None:
        """Until just this has arrived."""
        while self.heard != data:
            self._news.clear()
            await asyncio.wait_for(self._news.wait(), PATIENCE_S)
        self.heard = b""


def run(test: Callable[[], Coroutine[None, None, None]]) -> None:
    asyncio.run(test())


async def hear(far: socket.socket) -> bytes:
    far.setblocking(False)
    return await asyncio.wait_for(asyncio.get_running_loop().sock_recv(far, 100), PATIENCE_S)


async def talk(link: ByteLink, ear: Ear, far: socket.socket) -> None:
    """A word each way, and silence after closing, twice."""
    far.send(b"ahoy")
    await ear.wait_for(b"ahoy")
    link.send(b"aye")
    assert await hear(far) == b"aye"
    link.close()
    link.close()
    link.send(b"anyone?")


def test_it_calls_a_server() -> None:
    async def call() -> None:
        with socket.create_server(("127.0.0.1", 0)) as server:
            ear = Ear()
            link = await open_byte_link(f"tcpout://127.0.0.1:{server.getsockname()[1]}", ear)
            with server.accept()[0] as far:
                await talk(link, ear, far)

    run(call)


def test_it_waits_for_a_caller_and_the_last_one_counts() -> None:
    async def wait() -> None:
        port = free_port(socket.SOCK_STREAM)
        ear = Ear()
        link = await open_byte_link(f"tcpin://127.0.0.1:{port}", ear)
        link.send(b"lost")
        with socket.create_connection(("127.0.0.1", port)) as first:
            first.send(b"one")
            await ear.wait_for(b"one")
            with socket.create_connection(("127.0.0.1", port)) as far:
                await talk(link, ear, far)

    run(wait)


def test_it_calls_by_datagram() -> None:
    async def call() -> None:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as far:
            far.bind(("127.0.0.1", 0))
            ear = Ear()
            link = await open_byte_link(f"udpout://127.0.0.1:{far.getsockname()[1]}", ear)
            link.send(b"hello")
            far.setblocking(False)
            data, peer = await asyncio.get_running_loop().sock_recvfrom(far, 100)
            assert data == b"hello"
            far.connect(peer)
            await talk(link, ear, far)

    run(call)


def test_it_answers_whoever_counts_and_nobody_else() -> None:
    async def wait() -> None:
        port = free_port(socket.SOCK_DGRAM)
        ear = Ear(lambda data: data != b"stranger")
        link = await open_byte_link(f"udpin://127.0.0.1:{port}", ear)
        link.send(b"lost")
        with (
            socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as far,
            socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger,
        ):
            far.connect(("127.0.0.1", port))
            far.send(b"friend")
            await ear.wait_for(b"friend")
            stranger.sendto(b"stranger", ("127.0.0.1", port))
            await ear.wait_for(b"stranger")
            link.send(b"to the friend")
            assert await hear(far) == b"to the friend"
            await talk(link, ear, far)

    run(wait)


def test_it_speaks_over_a_serial_line_and_survives_its_unplugging() -> None:
    async def plug() -> None:
        ours, theirs = pty.openpty()
        tty.setraw(theirs)
        ear = Ear()
        link = await open_byte_link(f"serial://{os.ttyname(theirs)}:57600", ear)
        os.write(ours, b"ahoy")
        await ear.wait_for(b"ahoy")
        link.send(b"aye")
        assert os.read(ours, 100) == b"aye"
        os.close(ours)
        os.close(theirs)
        await asyncio.sleep(0)
        link.send(b"anyone?")
        link.close()
        link.close()

    run(plug)


@pytest.mark.parametrize("url", ["tcpout://127.0.0.1:1", "serial:///dev/none:57600"])
def test_what_cannot_be_opened_is_an_os_error(url: str) -> None:
    async def call() -> None:
        with pytest.raises(OSError):  # noqa: PT011
            await open_byte_link(url, Ear())

    run(call)


def free_port(kind: socket.SocketKind) -> int:
    with socket.socket(socket.AF_INET, kind) as free:
        free.bind(("127.0.0.1", 0))
        return int(free.getsockname()[1])
