"""The boat's logs by HTTP: the list, a log as the boat sends it, its voyage, and its chart of depths."""

import asyncio
import re
from typing import Any, Final

import msgspec
from aiohttp import web

from mission_tools.shore.web.guard import error
from mission_tools.shore.web.hub import Hub
from mission_tools.shore.web.logs.charts import FILES
from mission_tools.shore.web.logs.stream import LogLostError, LogStream
from mission_tools.shore.web.logs.voyages import MOST_DOWNLOADS, Lost, Waiting
from mission_tools.shore.web.rows import BOAT, Row, boat_of, json_answer
from mission_tools.station.messages import LogFile
from mission_tools.station.words import say

STALLED_S: Final = 60.0  # a browser that takes nothing for so long has gone
_SOON: Final = {"Retry-After": "1"}
_PAGE_POLICY: Final = "default-src 'none'; style-src 'unsafe-inline'; img-src data:; sandbox"
"""chart.html has its style and pictures inside, and no script."""
_LOG: Final = f"{BOAT}/logs/{{name:[0-9]{{1,9}}\\.[Bb][Ii][Nn]}}"


async def _list(hub: Hub, request: web.Request) -> web.StreamResponse:
    boat = boat_of(request)
    heard = hub.boats.get(boat)
    if heard is None:
        return error(404, say("answer.never_heard", n=boat), "")
    heard.logs.request()
    if heard.logs.logs is None:
        return error(503, heard.logs.failure or say("log.fetching"), "", _SOON)
    fetched = hub.logs.fetched(boat)
    rows: list[dict[str, Any]] = [
        {"name": log.name, "bytes": log.bytes, "at_s": log.at_s, "fetched_bytes": fetched.get(log.name)}
        for log in heard.logs.logs
    ]
    return json_answer(msgspec.json.encode(rows))


async def _download(hub: Hub, request: web.Request) -> web.StreamResponse:
    boat, log = boat_of(request), _find(hub, request)
    if log is None:
        return _unknown()
    with hub.logs.download(boat, log.name) as stream:
        if stream is None:
            return error(503, say("log.downloads", n=MOST_DOWNLOADS), "", {"Retry-After": "10"})
        try:
            size = await stream.opened()
        except LogLostError as lost:
            return error(502, lost.text, "")
        return await _send(request, stream, size, f"boat{boat}-{log.name}")


async def _send(request: web.Request, stream: LogStream, size: int, name: str) -> web.StreamResponse:
    response = web.StreamResponse()
    response.content_type = "application/octet-stream"
    response.content_length = size
    response.headers["Content-Disposition"] = f'attachment; filename="{name}"'
    await response.prepare(request)
    try:
        async for part in stream.parts():
            async with asyncio.timeout(STALLED_S):
                await response.write(part)
    except (LogLostError, TimeoutError, ConnectionError):
        # The browser notices that the bytes are fewer than announced
        if request.transport is not None:
            request.transport.abort()
        return response
    await response.write_eof()
    return response


async def _voyage(hub: Hub, request: web.Request) -> web.StreamResponse:
    log = _find(hub, request)
    return _unknown() if log is None else _told(hub.logs.voyages.get(boat_of(request), log))


def _told(state: Waiting | Lost | bytes) -> web.Response:
    if isinstance(state, Waiting):
        return web.json_response({"step": state.step, "share": round(state.share, 3)}, status=202)
    if isinstance(state, Lost):
        return error(422, state.text, "")
    return json_answer(state)


async def _chart(hub: Hub, request: web.Request) -> web.StreamResponse:
    """Begin, and tell how far it is; or cancel."""
    if request.method == "DELETE":
        hub.charts.cancel(boat_of(request), request.match_info["name"])
        return web.json_response({})
    log = _find(hub, request)
    return _unknown() if log is None else _told(hub.charts.get(boat_of(request), log))


async def _chart_file(hub: Hub, request: web.Request) -> web.StreamResponse:
    boat, name, product = boat_of(request), request.match_info["name"], request.match_info["file"]
    path = hub.charts.file(boat, name, product)
    if path is None:
        return error(404, say("depths.gone"), "")
    headers = {"Content-Disposition": f'attachment; filename="boat{boat}-{name.partition(".")[0]}-{product}"'}
    if product == "chart.html":
        headers = {"Content-Security-Policy": _PAGE_POLICY}
    return web.FileResponse(path, headers=headers)


def _find(hub: Hub, request: web.Request) -> LogFile | None:
    """A log that the boat has listed."""
    boat = hub.boats.get(boat_of(request))
    logs = [] if boat is None else boat.logs.logs or []
    return next((log for log in logs if log.name == request.match_info["name"]), None)


def _unknown() -> web.Response:
    return error(404, say("log.unknown"), say("log.unknown.expected"))


ROWS: Final = (
    Row("GET", f"{BOAT}/logs", _list),
    Row("GET", _LOG, _download, "pin"),
    Row("GET", f"{_LOG}/voyage", _voyage, "pin"),
    Row("POST", f"{_LOG}/chart", _chart, "pin"),
    Row("DELETE", f"{_LOG}/chart", _chart, "pin"),
    Row("GET", f"{_LOG}/chart/{{file:{'|'.join(map(re.escape, FILES))}}}", _chart_file, "pin"),
)
