"""Plans over HTTP: compute, read from a file, download."""

import asyncio
from collections.abc import Awaitable
from typing import Final, TypeVar

import msgspec
from aiohttp import web

from companion.core.errors import StorageError
from mission_tools.shore.plans.plan_request import PlanRequestError, parse_wish
from mission_tools.shore.plans.plan_service import FORMATS, MOST_BYTES, File
from mission_tools.shore.plans.process import PlannerBusyError, PlannerError, PlannerMissingError
from mission_tools.shore.web.guard import error
from mission_tools.shore.web.hub import Hub
from mission_tools.shore.web.rows import BOAT, Handler, Row, boat_of, json_answer, read_body
from mission_tools.station.words import say

_LOOK_S: Final = 0.5  # between looks whether the page is still there
_READ_S: Final = 60.0  # for a file of 2 MB over a bad Wi-Fi
_KINDS: Final = "|".join(FORMATS)

Done = TypeVar("Done")


def _answered(work: Handler) -> Handler:
    """What the work gives, or why it gives nothing."""

    async def answer(hub: Hub, request: web.Request) -> web.StreamResponse:
        try:
            return await _while_open(request, work(hub, request))
        except PlanRequestError as refused:
            return error(422, refused.args[0], refused.expected)
        except PlannerError as refused:
            return error(422, refused.args[0], "")
        except PlannerMissingError as refused:
            return error(503, refused.args[0], "")
        except (PlannerBusyError, StorageError) as refused:
            return error(503, refused.args[0], "", {"Retry-After": "5"})

    return answer


async def _while_open(request: web.Request, work: Awaitable[Done]) -> Done:
    """Cancel the work once the page has left."""
    task = asyncio.ensure_future(work)
    try:
        while not task.done():
            await asyncio.wait((task,), timeout=_LOOK_S)
            if request.transport is None or request.transport.is_closing():
                break
        else:
            return task.result()
    finally:
        if not task.done():
            task.cancel()
            await asyncio.gather(task, return_exceptions=True)
    raise ConnectionResetError


@_answered
async def _plan(hub: Hub, request: web.Request) -> web.StreamResponse:
    plan = await hub.plans.plan(boat_of(request), parse_wish(await read_body(request)))
    return json_answer(msgspec.json.encode(plan))


@_answered
async def _import(hub: Hub, request: web.Request) -> web.StreamResponse:
    body = await read_body(request, MOST_BYTES, _READ_S)
    plan = await hub.plans.read(boat_of(request), request.query.get("name", ""), body)
    return json_answer(msgspec.json.encode(plan))


@_answered
async def _file(hub: Hub, request: web.Request) -> web.StreamResponse:
    file = await hub.plans.file(request.match_info["id"], request.match_info["kind"])
    return error(404, say("planner.no_plan"), "") if file is None else _download(file)


@_answered
async def _on_board(hub: Hub, request: web.Request) -> web.StreamResponse:
    file = await hub.plans.on_board(boat_of(request), request.match_info["kind"])
    return error(404, say("planner.no_mission"), "") if file is None else _download(file)


def _download(file: File) -> web.Response:
    """The name is letters, digits and hyphens (`file_name`)."""
    response = web.Response(body=file.content, content_type=file.kind)
    response.headers["Content-Disposition"] = f'attachment; filename="{file.name}"'
    response.enable_compression()
    return response


ROWS: Final = (
    Row("POST", f"{BOAT}/plan", _plan, "pin"),
    Row("POST", f"{BOAT}/plan/import", _import, "pin"),
    Row("GET", f"/api/plans/{{id:[A-Za-z0-9_-]{{1,64}}}}.{{kind:{_KINDS}}}", _file, "pin"),
    Row("GET", f"{BOAT}/mission.{{kind:{_KINDS}}}", _on_board, "pin"),
)
