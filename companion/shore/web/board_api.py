"""The boat's own computer: its configuration."""

import asyncio
from typing import Final

import msgspec
from aiohttp import web

from companion import __version__
from companion.core.errors import BoatError, ConfigError
from companion.shore.board.config_check import check_text
from companion.shore.board.config_file import ChangedError, encode
from companion.shore.web.board_tools import BOARD
from companion.shore.web.guard import error
from companion.shore.web.hub import Hub
from companion.shore.web.rows import Row, json_answer, read_body
from companion.shore.web.update_api import ROWS as UPDATE_ROWS
from companion.shore.web.wifi_api import ROWS as WIFI_ROWS
from companion.shore.words import say

_MOST_REQUEST_BYTES: Final = 400_000  # 64 kB of text, with every character escaped
_NO_CONFIG: Final = say("board.no_config")


class _Text(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """replaced: the hash of the text that it replaces."""

    text: str
    replaced: str = ""


async def _board(_hub: Hub, request: web.Request) -> web.StreamResponse:
    """What can be done here."""
    tools = request.app[BOARD]
    works = {
        "config": tools.config is not None,
        "wifi": tools.wifi is not None,
        "update": tools.update is not None,
    }
    return web.json_response(works | {"version": __version__})


async def _config(_hub: Hub, request: web.Request) -> web.StreamResponse:
    file = request.app[BOARD].config
    if file is None:
        return error(404, _NO_CONFIG, say("board.with_config"))
    try:
        now = await asyncio.to_thread(file.read, int(request.match_info.get("number", "0")))
        kept = await asyncio.to_thread(file.kept)
    except BoatError as refused:
        return error(500, refused.args[0], "")
    return json_answer(msgspec.json.encode({"config": now, "kept": kept, "name": str(file.path)}))


async def _check(_hub: Hub, request: web.Request) -> web.StreamResponse:
    return await _checked(request, is_saved=False)


async def _save(_hub: Hub, request: web.Request) -> web.StreamResponse:
    return await _checked(request, is_saved=True)


async def _checked(request: web.Request, *, is_saved: bool) -> web.StreamResponse:
    """Check a text by the boat's program, and save it if it passes."""
    tools = request.app[BOARD]
    if tools.config is None:
        return error(404, _NO_CONFIG, say("board.with_config"))
    try:
        asked = msgspec.json.decode(await read_body(request, _MOST_REQUEST_BYTES), type=_Text)
        encode(asked.text)
    except (msgspec.DecodeError, RecursionError, UnicodeError):
        return error(400, say("board.expected"), '{"text": "…", "replaced": "…"}')
    except ConfigError as refused:
        return error(413, refused.args[0], "")
    if tools.busy.locked():
        return error(503, say("board.busy"), "", {"Retry-After": "2"})
    try:
        async with tools.busy:
            complaint = await check_text(asked.text, tools.check)
            if complaint is not None:
                return json_answer(msgspec.json.encode({"ok": False, "complaints": [complaint]}))
            if not is_saved:
                return web.json_response({"ok": True, "complaints": []})
            now = await asyncio.to_thread(tools.config.write, asked.text, asked.replaced)
    except ChangedError as refused:
        return error(409, refused.args[0], "")
    except BoatError as refused:
        return error(500, refused.args[0], "")
    return web.json_response({"ok": True, "complaints": [], "hash": now.hash})


ROWS: Final = (
    Row("GET", "/api/board", _board, needs="pin"),
    Row("GET", "/api/board/config", _config, needs="pin"),
    Row("GET", "/api/board/config/{number:[1-5]}", _config, needs="pin"),
    Row("POST", "/api/board/config/check", _check, needs="disarmed"),
    Row("POST", "/api/board/config", _save, needs="disarmed"),
    *WIFI_ROWS,
    *UPDATE_ROWS,
)
