"""Attackers of the shore page, in a process of their own: every attack without a pause.

    python -m benchmarks.shore_attackers http://127.0.0.1:8080 482913 60

They come from addresses of their own (127.0.0.2 and on). Prints how often each has struck, as JSON.
"""

import asyncio
import base64
import json
import os
import secrets
import socket
import sys
from collections import Counter
from collections.abc import Awaitable, Callable
from typing import NamedTuple

_NICE = 5  # they stand for other computers: here they get as much as the page, and less than the boat
_SOCKETS = 500
_HALF_OPEN = 200
_READERS = 32  # that never read
_PATIENCE_S = 5.0
_KEY = base64.b64encode(secrets.token_bytes(16)).decode()


class Target(NamedTuple):
    """The page."""

    port: int
    pin: str

    @property
    def origin(self) -> str:
        """As its pages send it."""
        return f"http://127.0.0.1:{self.port}"


class _Line:
    """A connection from an address."""

    def __init__(self, target: Target, address: int) -> None:
        self._target = target
        self._address = f"127.0.{address // 250}.{2 + address % 250}"
        self._reader: asyncio.StreamReader | None = None
        self._writer: asyncio.StreamWriter | None = None

    async def __aenter__(self) -> "_Line":
        async with asyncio.timeout(_PATIENCE_S):
            self._reader, self._writer = await asyncio.open_connection(
                "127.0.0.1", self._target.port, local_addr=(self._address, 0)
            )
        return self

    async def __aexit__(self, *_: object) -> None:
        if self._writer is not None:
            self._writer.transport.abort()

    async def send(self, data: bytes) -> None:
        """Send."""
        assert self._writer is not None
        self._writer.write(data)
        async with asyncio.timeout(_PATIENCE_S):
            await self._writer.drain()

    async def answer(self) -> tuple[int, dict[str, str]]:
        """Status and headers of an answer whose body is read."""
        assert self._reader is not None
        async with asyncio.timeout(_PATIENCE_S):
            head = (await self._reader.readuntil(b"\r\n\r\n")).decode("latin-1").split("\r\n")
            headers = {name.lower(): text for name, _, text in (line.partition(": ") for line in head[1:])}
            await self._reader.readexactly(int(headers.get("content-length", "0")))
        return int(head[0].split()[1]), headers

    def deafen(self) -> None:
        """Read nothing from now on."""
        assert self._writer is not None
        self._writer.transport.pause_reading()  # type: ignore[attr-defined]
        raw: socket.socket = self._writer.get_extra_info("socket")
        raw.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)

    async def ended(self) -> None:
        """Read until the other side ends it."""
        assert self._reader is not None
        while await self._reader.read(65536):
            pass


def _head(target: Target, method: str, path: str, *lines: str) -> bytes:
    own = (f"Host: 127.0.0.1:{target.port}", f"Origin: {target.origin}")
    return "\r\n".join((f"{method} {path} HTTP/1.1", *own, *lines, "", "")).encode()


def _upgrade(target: Target, *lines: str) -> bytes:
    wanted = ("Upgrade: websocket", "Connection: Upgrade", "Sec-WebSocket-Version: 13")
    return _head(target, "GET", "/live?boat=1", *wanted, f"Sec-WebSocket-Key: {_KEY}", *lines)


def _log_in(target: Target, pin: str) -> bytes:
    body = json.dumps({"pin": pin}).encode()
    kind = ("Content-Type: application/json", f"Content-Length: {len(body)}")
    return _head(target, "POST", "/api/session", *kind) + body


def _frame(text: str) -> bytes:
    """A masked WebSocket frame (RFC 6455, 5.2) of a short text; the mask is 0."""
    data = text.encode()
    assert len(data) < 65536
    size = bytes([0x80 | len(data)]) if len(data) < 126 else b"\xfe" + len(data).to_bytes(2, "big")
    return b"\x81" + size + b"\0\0\0\0" + data


async def _sockets(target: Target, number: int) -> None:
    """Open a socket, and keep it as long as it lasts."""
    async with _Line(target, number % 20) as line:
        await line.send(_upgrade(target))
        await line.ended()


async def _slow_reader(target: Target, number: int) -> None:
    """Open a socket and never read."""
    async with _Line(target, 30 + number % 8) as line:
        await line.send(_upgrade(target))
        line.deafen()
        await asyncio.sleep(_PATIENCE_S)


async def _pins_of_one(target: Target, number: int) -> None:  # noqa: ARG001
    async with _Line(target, 40) as line:
        while True:
            await line.send(_log_in(target, "000001"))
            await line.answer()


async def _pins_of_many(target: Target, number: int) -> None:  # noqa: ARG001
    async with _Line(target, 250 + secrets.randbelow(20_000)) as line:
        await line.send(_log_in(target, "000002"))
        await line.answer()


async def _large_body(target: Target, number: int) -> None:
    async with _Line(target, 50 + number) as line:
        await line.send(_head(target, "POST", "/api/session", "Content-Length: 1000000000"))
        while True:
            await line.send(b"x" * 65536)


async def _half_open(target: Target, number: int) -> None:
    """Half a request, and then a byte now and then."""
    async with _Line(target, 60 + number % 10) as line:
        await line.send(b"GET / HTTP/1.1\r\nHost: ")
        while True:
            await asyncio.sleep(1.0)
            await line.send(b"x")


async def _cross_site(target: Target, number: int) -> None:  # noqa: ARG001
    async with _Line(target, 80) as line:
        while True:
            await line.send(_upgrade(target).replace(b"Origin: http://127.0.0.1", b"Origin: http://evil"))
            await line.answer()


async def _with_cookie(target: Target, number: int) -> None:
    """Whoever knows the PIN: requests over a socket as fast as they go."""
    async with _Line(target, 81 + number) as line:
        await line.send(_log_in(target, target.pin))
        _, headers = await line.answer()
        cookie = headers.get("set-cookie", "").partition(";")[0]
        await line.send(_upgrade(target, f"Cookie: {cookie}"))
        await line.answer()
        reading = asyncio.create_task(line.ended())
        try:
            for count in range(10**9):
                goal = {"lat": 48.0, "lon": 12.0}
                ask = {"type": "do", "id": f"{number}-{count}", "boat": 1, "what": "route", "with": goal}
                await line.send(_frame(json.dumps(ask)))
                await asyncio.sleep(0)
        finally:
            reading.cancel()


async def _gets(target: Target, number: int) -> None:
    """The largest answers, one after the other on one connection."""
    paths = ("/api/chart", "/api/boats/1/track", "/main.js", "/api/boats", "/nothing")
    async with _Line(target, 90 + number) as line:
        while True:
            for path in paths:
                await line.send(_head(target, "GET", path))
                await line.answer()


async def _broken(target: Target, number: int) -> None:
    """Bytes that are no HTTP."""
    async with _Line(target, 100 + number) as line:
        await line.send(os.urandom(2000) + b"\r\n\r\n")
        await line.ended()


Attack = Callable[[Target, int], Awaitable[None]]
ATTACKS: dict[Attack, int] = {  # how many of each at the same time
    _sockets: _SOCKETS,
    _slow_reader: _READERS,
    _pins_of_one: 4,
    _pins_of_many: 4,
    _large_body: 4,
    _half_open: _HALF_OPEN,
    _cross_site: 2,
    _with_cookie: 4,
    _gets: 8,
    _broken: 4,
}


async def attack(target: Target, seconds: float) -> Counter[str]:
    """Every attack, again and again; how often each has begun."""
    struck: Counter[str] = Counter()

    async def again(one: Attack, number: int) -> None:
        while True:
            struck[one.__name__.strip("_")] += 1
            try:
                await one(target, number)
            except (OSError, TimeoutError, asyncio.IncompleteReadError, asyncio.LimitOverrunError):
                await asyncio.sleep(0.001)

    tasks = [asyncio.create_task(again(one, n)) for one, count in ATTACKS.items() for n in range(count)]
    await asyncio.sleep(seconds)
    for task in tasks:
        task.cancel()
    ends = await asyncio.gather(*tasks, return_exceptions=True)
    failed = [end for end in ends if end is not None and not isinstance(end, asyncio.CancelledError)]
    assert not failed, failed[0]
    return struck


def main(origin: str, pin: str, seconds: float) -> None:
    """Attack."""
    os.nice(_NICE)
    target = Target(int(origin.rstrip("/").rpartition(":")[2]), pin)
    sys.stdout.write(json.dumps(asyncio.run(attack(target, seconds))) + "\n")


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], float(sys.argv[3]))
