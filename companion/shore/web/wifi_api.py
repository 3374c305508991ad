"""The boat's Wi-Fi: networks, joining, forgetting, and the boat's own network."""

from collections.abc import Awaitable, Callable
from typing import Final, TypeVar

import msgspec
from aiohttp import web

from companion.shore.board.nmcli import NmcliError
from companion.shore.board.wifi import Wifi, WifiRefusedError
from companion.shore.web.board_tools import BOARD
from companion.shore.web.guard import error
from companion.shore.web.hub import Hub
from companion.shore.web.rows import Handler, Row, json_answer, read_body
from companion.shore.words import say

_MOST_BYTES: Final = 4096
_T = TypeVar("_T")


class _Join(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    name: str
    security: str
    password: str = ""


class _Connection(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    uuid: str


class _Hotspot(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    on: bool
    password: str = ""


async def _state(_hub: Hub, request: web.Request) -> web.StreamResponse:
    wifi = request.app[BOARD].wifi
    if wifi is None:
        return error(404, say("board.no_wifi"), "")
    try:
        return json_answer(msgspec.json.encode(await wifi.state()))
    except NmcliError as refused:
        return error(502, refused.args[0], "")


async def _join(wifi: Wifi, asked: _Join) -> None:
    wifi.join(asked.name, asked.security, asked.password)


async def _forget(wifi: Wifi, asked: _Connection) -> None:
    await wifi.forget(asked.uuid)


async def _use(wifi: Wifi, asked: _Connection) -> None:
    await wifi.use(asked.uuid)


async def _hotspot(wifi: Wifi, asked: _Hotspot) -> None:
    if asked.on:
        wifi.start_hotspot(asked.password)
    else:
        wifi.stop_hotspot()


def _asking(kind: type[_T], act: Callable[[Wifi, _T], Awaitable[None]]) -> Handler:
    async def handle(_hub: Hub, request: web.Request) -> web.StreamResponse:
        wifi = request.app[BOARD].wifi
        if wifi is None:
            return error(404, say("board.no_wifi"), "")
        try:
            asked = msgspec.json.decode(await read_body(request, _MOST_BYTES), type=kind)
            await act(wifi, asked)
        except (msgspec.DecodeError, RecursionError, UnicodeError):
            return error(400, say("board.wifi.expected"), "")
        except WifiRefusedError as refused:
            return error(409, refused.args[0], "")
        except NmcliError as refused:
            return error(502, refused.args[0], "")
        return json_answer(msgspec.json.encode(wifi.change))

    return handle


ROWS: Final = (
    Row("GET", "/api/board/wifi", _state, needs="pin"),
    Row("POST", "/api/board/wifi/join", _asking(_Join, _join), needs="disarmed"),
    Row("POST", "/api/board/wifi/use", _asking(_Connection, _use), needs="disarmed"),
    Row("POST", "/api/board/wifi/forget", _asking(_Connection, _forget), needs="disarmed"),
    Row("POST", "/api/board/wifi/hotspot", _asking(_Hotspot, _hotspot), needs="disarmed"),
)
