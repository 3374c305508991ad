"""The HTTP interface as a table: method, path, handler, and what it needs."""

import asyncio
import hashlib
from collections.abc import Awaitable, Callable
from typing import Final

import msgspec
from aiohttp import web

from mission_tools.geojson import feature
from mission_tools.shore.web.guard import cookie_name, cookie_of, error, peer_of
from mission_tools.shore.web.hub import Hub
from mission_tools.shore.web.login.session import LIFE_S, LoginRefused
from mission_tools.shore.web.logs_api import ROWS as LOGS
from mission_tools.shore.web.parameters_api import ROWS as PARAMETERS
from mission_tools.shore.web.plan_api import ROWS as PLAN_ROWS
from mission_tools.shore.web.rows import BOAT, Handler, Row, boat_of, json_answer, read_body
from mission_tools.shore.web.static_files import StaticFile, make_file, respond
from mission_tools.station.items import Kind
from mission_tools.station.words import say

_GEOJSON: Final = "application/geo+json"


class _Pin(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    pin: str


async def _session(hub: Hub, request: web.Request) -> web.StreamResponse:
    role = hub.sessions.role(cookie_of(request), hub.clock.now_s())
    text = "" if role == "skipper" else hub.sessions.refusal()
    return web.json_response({"role": role, "has_pin": hub.sessions.has_pin, "text": text})


async def _log_in(hub: Hub, request: web.Request) -> web.StreamResponse:
    try:
        pin = msgspec.json.decode(await read_body(request), type=_Pin).pin
    except (msgspec.DecodeError, RecursionError, UnicodeError):
        return error(400, say("pin.expected"), '{"pin": "…"}')
    opened = await hub.sessions.open(pin, peer_of(request), hub.clock.now_s())
    if isinstance(opened, LoginRefused):
        if opened.wait_s is None:
            return error(409, opened.text, "")
        wait = {"Retry-After": str(int(opened.wait_s) + 1)} if opened.wait_s > 0.0 else None
        return error(403 if wait is None or not opened.is_held_up else 429, opened.text, "", wait)
    response = web.json_response({"role": "skipper", "has_pin": True, "text": ""})
    response.set_cookie(
        cookie_name(request), opened, max_age=int(LIFE_S), path="/", httponly=True, samesite="Strict"
    )
    return response


async def _log_out(hub: Hub, request: web.Request) -> web.StreamResponse:
    hub.sessions.close(cookie_of(request))
    response = web.json_response({"role": "viewer", "has_pin": hub.sessions.has_pin, "text": ""})
    response.del_cookie(cookie_name(request), path="/", httponly=True, samesite="Strict")
    return response


async def _boats(hub: Hub, _request: web.Request) -> web.StreamResponse:
    return json_answer(msgspec.json.encode(hub.boats.names()))


def _chart() -> Handler:
    packed: dict[bytes, StaticFile] = {}  # of the one chart, by its hash

    async def handle(hub: Hub, request: web.Request) -> web.StreamResponse:
        content = await asyncio.to_thread(hub.chart.geojson)
        key = hashlib.sha256(content).digest()
        if key not in packed:
            file = await asyncio.to_thread(make_file, _GEOJSON, content)
            packed.clear()
            packed[key] = file
        return respond(request, packed[key])

    return handle


def _items(kind: Kind) -> Handler:
    async def handle(hub: Hub, request: web.Request) -> web.StreamResponse:
        items = hub.boats.items(boat_of(request), kind)
        if items is None:
            return error(503, say("error.no_list", kind=kind), "", {"Retry-After": "1"})
        return json_answer(msgspec.json.encode(items), _GEOJSON)

    return handle


async def _track(hub: Hub, request: web.Request) -> web.StreamResponse:
    boat = hub.boats.get(boat_of(request))
    points = [] if boat is None else boat.view.track.points
    return json_answer(msgspec.json.encode(feature("LineString", points)), _GEOJSON)


async def _sensors(hub: Hub, request: web.Request) -> web.StreamResponse:
    boat = boat_of(request)
    sensors = hub.boats.sensors(boat)
    if sensors is None:
        return error(404, say("answer.never_heard", n=boat), "")
    return json_answer(msgspec.json.encode(sensors))


TABLE: Final = (
    Row("GET", "/api/session", _session),
    Row("POST", "/api/session", _log_in),
    Row("DELETE", "/api/session", _log_out),
    Row("GET", "/api/chart", _chart()),
    Row("GET", "/api/boats", _boats),
    Row("GET", f"{BOAT}/mission", _items("mission")),
    Row("GET", f"{BOAT}/fence", _items("fence")),
    Row("GET", f"{BOAT}/rally", _items("rally")),
    Row("GET", f"{BOAT}/track", _track),
    Row("GET", f"{BOAT}/sensors", _sensors),
    *LOGS,
    *PLAN_ROWS,
    *PARAMETERS,
)


def add_routes(app: web.Application, hub: Hub) -> None:
    """Add the table's routes."""
    for row in TABLE:
        app.router.add_route(row.method, row.path, _bound(hub, row))


def _bound(hub: Hub, row: Row) -> Callable[[web.Request], Awaitable[web.StreamResponse]]:
    async def handle(request: web.Request) -> web.StreamResponse:
        is_skipper = hub.sessions.role(cookie_of(request), hub.clock.now_s()) == "skipper"
        if row.needs != "nothing" and not is_skipper:
            return error(403, hub.sessions.refusal(), "")
        return await row.handler(hub, request)

    return handle
