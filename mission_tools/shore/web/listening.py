"""The server on its port, until a signal ends it."""

import asyncio
import logging
import signal
from collections.abc import Callable
from typing import Final

from aiohttp import web

from companion.core.errors import ConfigError, LinkError
from mission_tools.shore.web.connections.access_control import AccessControl
from mission_tools.shore.web.server import HUB, POLLING

IDLE_S: Final = 15.0  # without a whole request
_LINGERING_S: Final = 1.0  # for the rest of a body that was refused
_GRACE_S: Final = 2.0  # for responses under way when the server ends
_MOST_LINE: Final = 4096
_LOG: Final = logging.getLogger("boat-shore.http")
_LOG.propagate = False  # aiohttp logs each broken request with a traceback and its bytes; `guard` logs faults
_LOG.addHandler(logging.NullHandler())
_SIGNALS: Final = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


def parse_listen(text: str) -> tuple[str, int]:
    """HOST:PORT, or [ADDRESS]:PORT; else a ConfigError."""
    host, colon, port = text.rpartition(":")
    host = host.removeprefix("[").removesuffix("]")
    if not colon or not host or not port.isdecimal() or int(port) > 65535:
        raise ConfigError(f"--listen {text!r}: expected HOST:PORT, such as 127.0.0.1:8080 or 0.0.0.0:80")
    return host, int(port)


class Listening:
    """An application on a port."""

    def __init__(self, app: web.Application) -> None:
        self._app = app
        self._runner = web.AppRunner(
            app,
            access_log=None,
            logger=_LOG,
            keepalive_timeout=IDLE_S,
            lingering_time=_LINGERING_S,
            shutdown_timeout=_GRACE_S,
            max_line_size=_MOST_LINE,
            max_field_size=_MOST_LINE,
        )
        self._server: asyncio.Server | None = None

    async def open(self, host: str, port: int) -> int:
        """Begin; returns the port's number. LinkError if it cannot be opened."""
        await self._runner.setup()
        hub = self._app[HUB]
        access_control = AccessControl(self._runner.server, hub.sessions.is_known, hub.clock.now_s)
        loop = asyncio.get_running_loop()
        try:
            self._server = await loop.create_server(access_control.open, host, port, backlog=64)
        except OSError as error:
            await self._runner.cleanup()
            why = (error.strerror or str(error)).rpartition(": ")[2]  # asyncio puts the address before it
            raise LinkError(f"cannot listen on {host}:{port}: {why[:1].upper()}{why[1:]}") from None
        number: int = self._server.sockets[0].getsockname()[1]
        return number

    async def close(self) -> None:
        if self._server is not None:
            self._server.close()
        await self._runner.cleanup()


async def serve(app: web.Application, host: str, port: int, on_open: Callable[[int], None]) -> None:
    """Serve until SIGINT, SIGTERM or SIGHUP. A second signal is left to the system's own way."""
    loop = asyncio.get_running_loop()
    ended = asyncio.Event()

    def on_signal(number: int) -> None:
        loop.remove_signal_handler(number)
        signal.signal(number, signal.SIG_DFL)
        ended.set()

    listening = Listening(app)
    number = await listening.open(host, port)
    for one in _SIGNALS:
        if signal.getsignal(one) is not signal.SIG_IGN:  # as a script that starts it in the background has it
            loop.add_signal_handler(one, on_signal, one)
    try:
        on_open(number)
        polling = app[POLLING]
        polling.add_done_callback(lambda _: ended.set())
        await ended.wait()
        if polling.done():
            polling.result()  # raises what ended it
    finally:
        await listening.close()
