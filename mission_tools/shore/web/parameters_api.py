"""The parameters of a boat by HTTP: the list, a file to keep, and a comparison with one."""

import asyncio
from typing import Final

import msgspec
from aiohttp import web

from mission_tools.shore.web.guard import error
from mission_tools.shore.web.hub import Hub
from mission_tools.shore.web.rows import BOAT, Handler, Row, boat_of, json_answer, read_body
from mission_tools.shore.web.static_files import StaticFile, make_file, respond
from mission_tools.station.parameters.metadata import Descriptions, MetadataError, read_descriptions
from mission_tools.station.parameters.param_file import (
    MOST_BYTES,
    ParamFileError,
    compare,
    read_file,
    write_file,
)
from mission_tools.station.parameters.parameter_table import ParameterTable, TableSnapshot, document
from mission_tools.station.parameters.values import Value
from mission_tools.station.words import say

_JSON: Final = "application/json"
_MOST_KEPT: Final = 4  # packed documents: some 10 kB each


class _Documents:
    """The packed documents by boat. One is built at a time, in a thread."""

    def __init__(self) -> None:
        self._packed: dict[int, tuple[ParameterTable, tuple[int, str], StaticFile]] = {}
        self._one = asyncio.Lock()

    async def of(self, boat: int, table: ParameterTable) -> StaticFile:
        async with self._one:
            snapshot = await _described(table)
            key = (snapshot.version, snapshot.texts)
            kept = self._packed.pop(boat, None)
            if kept is None or kept[0] is not table or kept[1] != key:
                file = await asyncio.to_thread(_build, snapshot, list(snapshot.values.items()))
                kept = (table, key, file)
            self._packed[boat] = kept
            if len(self._packed) > _MOST_KEPT:
                del self._packed[next(iter(self._packed))]
            return kept[2]


def _build(snapshot: TableSnapshot, values: list[tuple[str, Value]]) -> StaticFile:
    return make_file(_JSON, document(snapshot, values))


async def _described(table: ParameterTable) -> TableSnapshot:
    """With the texts, once they have come."""
    snapshot = table.snapshot()
    if (packed := snapshot.packed) is None:
        return snapshot
    descriptions: Descriptions | None
    try:
        descriptions = await asyncio.to_thread(read_descriptions, *packed)
    except MetadataError:
        descriptions = None
    table.describe(packed, descriptions)
    return table.snapshot()


def _table(hub: Hub, request: web.Request) -> ParameterTable | web.Response:
    """The table of a boat that is downloaded, or what to answer instead."""
    boat = hub.boats.get(boat_of(request))
    if boat is None:
        return error(404, say("error.no_boat"), "")
    table = boat.parameters
    snapshot = table.snapshot()
    if snapshot.state != "here":
        progress = {"got": snapshot.got, "count": snapshot.count}
        return web.json_response(progress, status=202, headers={"Retry-After": "1"})
    return table


def _list() -> Handler:
    documents = _Documents()

    async def handle(hub: Hub, request: web.Request) -> web.StreamResponse:
        table = _table(hub, request)
        if isinstance(table, web.Response):
            return table
        return respond(request, await documents.of(boat_of(request), table))

    return handle


async def _save(hub: Hub, request: web.Request) -> web.StreamResponse:
    table = _table(hub, request)
    if isinstance(table, web.Response):
        return error(503, say("error.no_parameters"), "", {"Retry-After": "1"})
    boat, values = boat_of(request), list(table.snapshot().values.items())
    content = await asyncio.to_thread(write_file, values, f"Parameters of boat {boat}")
    headers = {"Content-Disposition": f'attachment; filename="boat-{boat}.param"'}
    return web.Response(body=content, content_type="text/plain", charset="utf-8", headers=headers)


async def _compare(hub: Hub, request: web.Request) -> web.StreamResponse:
    content = await read_body(request, MOST_BYTES)
    table = _table(hub, request)
    if isinstance(table, web.Response):
        return error(503, say("error.no_parameters"), "", {"Retry-After": "1"})
    snapshot = await _described(table)
    values = dict(snapshot.values)
    try:
        file = await asyncio.to_thread(read_file, content)
    except ParamFileError as refused:
        return error(400, refused.text, "")
    found = await asyncio.to_thread(compare, file, values, snapshot.descriptions)
    return json_answer(msgspec.json.encode(found))


ROWS: Final = (
    Row("GET", f"{BOAT}/parameters", _list(), "pin"),
    Row("GET", f"{BOAT}/parameters.param", _save, "pin"),
    Row("POST", f"{BOAT}/parameters/compare", _compare, "pin"),
)
