"""What is looked at while a boat is set up."""

from typing import Final

import msgspec
from aiohttp import web

from companion.shore.web.guard import error
from companion.shore.web.hub import Hub
from companion.shore.web.rows import BOAT, Row, boat_of, json_answer
from companion.shore.words import say


async def _sensors(hub: Hub, request: web.Request) -> web.StreamResponse:
    boat = boat_of(request)
    sensors = hub.boats.sensors(boat)
    if sensors is None:
        return error(404, say("answer.never_heard", n=boat), "")
    return json_answer(msgspec.json.encode(sensors))


ROWS: Final = (Row("GET", f"{BOAT}/sensors", _sensors),)
