"""WebSocket `/live?boat=1`."""

import asyncio
import contextlib
import socket
from collections import Counter
from typing import Final

from aiohttp import WSCloseCode, WSMsgType, web

from mission_tools.shore.web.connections.rates import Bucket, Rate
from mission_tools.shore.web.connections.throttle import network_of
from mission_tools.shore.web.guard import cookie_of, error, peer_of
from mission_tools.shore.web.hub import Hub, Watch
from mission_tools.station.words import say

MOST_SOCKETS: Final = 32
MOST_OF_ADDRESS: Final = 8
MOST_BYTES: Final = 16_384
_SEND_BUFFER_BYTES: Final = 32_768  # the kernel's own would hold minutes of states
_OFTEN: Final = Rate(burst=30, per_s=10.0)  # messages of a socket, and pongs
_CLOSE_S: Final = 2.0


class _Open:
    """A socket of the table."""

    def __init__(self, ws: web.WebSocketResponse, network: str, watch: Watch) -> None:
        self.ws = ws
        self.network = network
        self.watch = watch
        self.transport: asyncio.Transport | None = None

    def abort(self) -> None:
        """Close without waiting for a peer that may not read."""
        if self.transport is not None:
            self.transport.abort()


class Sockets:
    """The open WebSockets, and their limits."""

    def __init__(self, hub: Hub) -> None:
        self._hub = hub
        self._open: list[_Open] = []

    async def handle(self, request: web.Request) -> web.StreamResponse:
        """Serve one socket until it closes."""
        boat = request.query.get("boat", "")
        if boat and not (boat.isascii() and boat.isdigit() and 1 <= int(boat[:4]) <= 255):
            return error(400, say("error.no_boat"), "boat=1 to 255")
        ws = web.WebSocketResponse(
            max_msg_size=MOST_BYTES, compress=False, autoping=False, timeout=_CLOSE_S, autoclose=True
        )
        if not ws.can_prepare(request).ok:
            return error(426, say("error.no_socket"), "")
        token = cookie_of(request)
        network = network_of(peer_of(request))
        is_skipper = self._hub.sessions.role(token, self._hub.clock.now_s()) == "skipper"
        if not self._make_room(network, token if is_skipper else None):
            return error(
                503,
                say("error.too_many"),
                say("error.too_many.expected", all=MOST_SOCKETS, own=MOST_OF_ADDRESS),
            )
        one = _Open(ws, network, self._hub.open(int(boat) if boat else None, token))
        self._open.append(one)
        try:
            with contextlib.suppress(ConnectionResetError):  # the page has left before it was answered
                await ws.prepare(request)
                await self._serve(request, one)
        finally:
            self._open.remove(one)
            self._hub.close(one.watch)
        return ws if ws.prepared else error(400, say("error.left"), "")

    def _make_room(self, network: str, session: str | None) -> bool:
        """Whether there is room.

        For a skipper a viewer's socket is closed, or else the oldest of the same session: a phone that loses
        its link again and again leaves some behind. session: a skipper's token.
        """
        live = [one for one in self._open if one.transport is None or not one.transport.is_closing()]
        is_full = len(live) >= MOST_SOCKETS
        if not is_full and Counter(one.network for one in live)[network] < MOST_OF_ADDRESS:
            return True
        if session is None:
            return False
        near = [one for one in live if is_full or one.network == network]
        viewers = [one for one in near if self._hub.role(one.watch) == "viewer"]
        own = [one for one in near if one.watch.token == session]
        for one in (*viewers, *own):
            one.abort()
            return True
        return False

    async def _serve(self, request: web.Request, one: _Open) -> None:
        transport = request.transport
        if transport is None:
            return
        one.transport = transport
        transport.set_write_buffer_limits(high=MOST_BYTES)
        raw: socket.socket | None = transport.get_extra_info("socket")
        if raw is not None:
            raw.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, _SEND_BUFFER_BYTES)
        sender = asyncio.create_task(self._send(one))
        try:
            await self._receive(one)
        finally:
            sender.cancel()
            await asyncio.gather(sender, return_exceptions=True)

    async def _receive(self, one: _Open) -> None:
        clock = self._hub.clock
        viewer = one.watch.viewer
        rate = Bucket(_OFTEN, clock.now_s())
        pongs = Bucket(_OFTEN, clock.now_s())
        async for message in one.ws:
            now_s = clock.now_s()
            if message.type is WSMsgType.PONG:
                if not pongs.allows(now_s):
                    break
                viewer.on_pong(now_s)
                one.watch.wake.set()
                continue
            if not rate.allows(now_s):
                break
            if message.type is WSMsgType.PING:
                await one.ws.pong(message.data)
            elif message.type is WSMsgType.TEXT:
                self._hub.on_text(one.watch, message.data)
            else:
                break
        if not one.ws.closed:
            await one.ws.close(code=WSCloseCode.POLICY_VIOLATION, message=b"too many or wrong messages")

    async def _send(self, one: _Open) -> None:
        try:
            while True:
                await one.watch.wake.wait()
                one.watch.wake.clear()
                texts, is_pinged = one.watch.viewer.take(self._hub.clock.now_s())
                for text in texts:
                    await one.ws.send_str(text)
                if is_pinged:
                    await one.ws.ping()
        except ConnectionError:
            one.abort()

    def drop_lost(self, now_s: float) -> None:
        """Close the sockets that nobody reads. Call every second or so."""
        for one in self._open:
            if one.watch.viewer.is_lost(now_s):
                one.abort()

    async def close(self) -> None:
        """Tell the pages that the server ends."""
        closing = [
            one.ws.close(code=WSCloseCode.GOING_AWAY, message=b"the server ends")
            for one in self._open
            if one.ws.prepared
        ]
        await asyncio.gather(*closing, return_exceptions=True)
