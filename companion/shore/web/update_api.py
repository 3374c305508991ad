"""An update from a wheel file: uploaded, shown with its version, installed or dropped."""

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable
from typing import Final

import msgspec
from aiohttp import web

from companion import __version__
from companion.core.errors import BoatError
from companion.shore.board.update_file import (
    MOST_BYTES,
    TooLargeError,
    UpdateFolder,
    UpdateRefusedError,
    WrongWheelError,
)
from companion.shore.web.board_tools import BOARD
from companion.shore.web.guard import error
from companion.shore.web.hub import Hub
from companion.shore.web.rows import Handler, Row, json_answer
from companion.shore.words import say

UPLOAD_S: Final = 300.0  # 30 MB at 1 Mbit/s
SILENCE_S: Final = 20.0

Act = Callable[[UpdateFolder, web.Request], Awaitable[web.StreamResponse]]


async def _chunks(request: web.Request) -> AsyncIterator[bytes]:
    """The body as it comes.

    Raises:
        HTTPRequestTimeout: it stalls.
    """
    parts = request.content.iter_any().__aiter__()
    while True:
        try:
            async with asyncio.timeout(SILENCE_S):
                chunk = await anext(parts)
        except StopAsyncIteration:
            return
        except TimeoutError:
            raise web.HTTPRequestTimeout from None
        yield chunk


async def _upload(folder: UpdateFolder, request: web.Request) -> web.StreamResponse:
    if (request.content_length or 0) > MOST_BYTES:
        raise TooLargeError(say("board.update.large", n=MOST_BYTES // 1_000_000))
    try:
        async with asyncio.timeout(UPLOAD_S):
            wheel = await folder.receive(request.query.get("name", ""), _chunks(request))
    except TimeoutError:
        raise web.HTTPRequestTimeout from None
    except (ConnectionError, web.RequestPayloadError):  # nobody reads this
        raise web.HTTPBadRequest from None
    told = {"name": wheel.name, "version": wheel.version, "present": __version__}
    return web.json_response(told)


async def _state(folder: UpdateFolder, _request: web.Request) -> web.StreamResponse:
    return json_answer(msgspec.json.encode(await asyncio.to_thread(folder.state)))


async def _install(folder: UpdateFolder, request: web.Request) -> web.StreamResponse:
    await asyncio.to_thread(folder.install)
    return await _state(folder, request)


async def _drop(folder: UpdateFolder, request: web.Request) -> web.StreamResponse:
    await asyncio.to_thread(folder.drop)
    return await _state(folder, request)


def _answering(act: Act) -> Handler:
    async def handle(_hub: Hub, request: web.Request) -> web.StreamResponse:
        folder = request.app[BOARD].update
        if folder is None:
            return error(404, say("board.update.off"), "")
        try:
            return await act(folder, request)
        except TooLargeError as refused:
            return error(413, refused.args[0], "")
        except WrongWheelError as refused:
            return error(400, refused.args[0], "")
        except UpdateRefusedError as refused:
            return error(409, refused.args[0], "")
        except BoatError as refused:
            return error(500, refused.args[0], "")

    return handle


ROWS: Final = (
    Row("GET", "/api/board/update", _answering(_state), needs="pin"),
    Row("POST", "/api/board/update", _answering(_upload), needs="disarmed"),
    Row("POST", "/api/board/update/install", _answering(_install), needs="disarmed"),
    Row("DELETE", "/api/board/update", _answering(_drop), needs="disarmed"),
)
