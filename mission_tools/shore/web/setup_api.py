"""What is looked at while a boat is set up."""

from typing import Final

import msgspec
from aiohttp import web

from mission_tools.shore.web.guard import error
from mission_tools.shore.web.hub import Hub
from mission_tools.shore.web.rows import BOAT, Row, boat_of, json_answer
from mission_tools.station.words import say


async def _sensors(hub: Hub, request: web.Request) -> web.StreamResponse:
    boat = boat_of(request)
    sensors = hub.boats.sensors(boat)
    if sensors is None:
        return error(404, say("answer.never_heard", n=boat), "")
    return json_answer(msgspec.json.encode(sensors))


ROWS: Final = (Row("GET", f"{BOAT}/sensors", _sensors),)
