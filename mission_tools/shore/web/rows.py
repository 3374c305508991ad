"""What the rows of the HTTP interface are made of."""

import asyncio
from collections.abc import Awaitable, Callable
from typing import Final, Literal, NamedTuple

from aiohttp import web

from mission_tools.shore.web.hub import Hub

BOAT: Final = "/api/boats/{boat:[0-9]{1,3}}"
MOST_BODY_BYTES: Final = 64_000
_BODY_S: Final = 10.0  # for a body to arrive

Handler = Callable[[Hub, web.Request], Awaitable[web.StreamResponse]]
Needs = Literal["nothing", "pin"]


class Row(NamedTuple):
    """A line of the table."""

    method: str
    path: str
    handler: Handler
    needs: Needs = "nothing"


async def read_body(
    request: web.Request, most_bytes: int = MOST_BODY_BYTES, within_s: float = _BODY_S
) -> bytes:
    """The whole body; HTTPRequestTimeout or HTTPRequestEntityTooLarge if it is too slow or too long."""
    body = bytearray()
    try:
        async with asyncio.timeout(within_s):
            async for chunk in request.content.iter_any():
                body += chunk
                if len(body) > most_bytes:
                    raise web.HTTPRequestEntityTooLarge(most_bytes, len(body))
    except TimeoutError:
        raise web.HTTPRequestTimeout from None
    return bytes(body)


def boat_of(request: web.Request) -> int:
    """The boat that the path names."""
    return int(request.match_info["boat"])


def json_answer(content: bytes, kind: str = "application/json") -> web.Response:
    """A response, packed if the browser takes it."""
    response = web.Response(body=content, content_type=kind)
    response.enable_compression()
    return response
