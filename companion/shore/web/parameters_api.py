"""The parameters of a boat by HTTP: the list, a file to keep, and a comparison with one."""

import asyncio
from typing import Final

import msgspec
from aiohttp import web

from companion.shore.parameters.book import Book, Look
from companion.shore.parameters.document import document
from companion.shore.parameters.metadata import Descriptions, MetadataError
from companion.shore.parameters.packed import read_descriptions
from companion.shore.parameters.param_file import MOST_BYTES, ParamFileError, compare, read_file, write_file
from companion.shore.parameters.values import Value
from companion.shore.web.guard import error
from companion.shore.web.hub import Hub
from companion.shore.web.rows import BOAT, Handler, Row, boat_of, json_answer, read_body
from companion.shore.web.static_files import StaticFile, make_file, respond
from companion.shore.words import say

_JSON: Final = "application/json"
_MOST_KEPT: Final = 4  # packed documents: some 10 kB each


class _Documents:
    """The packed documents by boat. One is built at a time, in a thread."""

    def __init__(self) -> None:
        self._packed: dict[int, tuple[Book, tuple[int, str], StaticFile]] = {}
        self._one = asyncio.Lock()

    async def of(self, boat: int, book: Book) -> StaticFile:
        async with self._one:
            look = await _described(book)
            key = (look.version, look.texts)
            kept = self._packed.pop(boat, None)
            if kept is None or kept[0] is not book or kept[1] != key:
                file = await asyncio.to_thread(_build, look, list(look.values.items()))
                kept = (book, key, file)
            self._packed[boat] = kept
            if len(self._packed) > _MOST_KEPT:
                del self._packed[next(iter(self._packed))]
            return kept[2]


def _build(look: Look, values: list[tuple[str, Value]]) -> StaticFile:
    return make_file(_JSON, document(look, values))


async def _described(book: Book) -> Look:
    """With the texts, once they have come."""
    look = book.look()
    if (packed := look.packed) is None:
        return look
    descriptions: Descriptions | None
    try:
        descriptions = await asyncio.to_thread(read_descriptions, *packed)
    except MetadataError:
        descriptions = None
    book.describe(packed, descriptions)
    return book.look()


def _book(hub: Hub, request: web.Request) -> Book | web.Response:
    """The book of a boat that is downloaded, or what to answer instead."""
    boat = boat_of(request)
    book = hub.boats.parameters(boat)
    if book is None:
        return error(404, say("error.no_boat"), "")
    look = book.look()
    if look.state != "here":
        progress = {"got": look.got, "count": look.count}
        return web.json_response(progress, status=202, headers={"Retry-After": "1"})
    return book


def _list() -> Handler:
    documents = _Documents()

    async def handle(hub: Hub, request: web.Request) -> web.StreamResponse:
        book = _book(hub, request)
        if isinstance(book, web.Response):
            return book
        return respond(request, await documents.of(boat_of(request), book))

    return handle


async def _save(hub: Hub, request: web.Request) -> web.StreamResponse:
    book = _book(hub, request)
    if isinstance(book, web.Response):
        return error(503, say("error.no_parameters"), "", {"Retry-After": "1"})
    boat, values = boat_of(request), list(book.look().values.items())
    content = await asyncio.to_thread(write_file, values, f"Parameters of boat {boat}")
    headers = {"Content-Disposition": f'attachment; filename="boat-{boat}.param"'}
    return web.Response(body=content, content_type="text/plain", charset="utf-8", headers=headers)


async def _compare(hub: Hub, request: web.Request) -> web.StreamResponse:
    content = await read_body(request, MOST_BYTES)
    book = _book(hub, request)
    if isinstance(book, web.Response):
        return error(503, say("error.no_parameters"), "", {"Retry-After": "1"})
    look = await _described(book)
    values = dict(look.values)
    try:
        file = await asyncio.to_thread(read_file, content)
    except ParamFileError as refused:
        return error(400, refused.text, "")
    found = await asyncio.to_thread(compare, file, values, look.descriptions)
    return json_answer(msgspec.json.encode(found))


ROWS: Final = (
    Row("GET", f"{BOAT}/parameters", _list(), "pin"),
    Row("GET", f"{BOAT}/parameters.param", _save, "pin"),
    Row("POST", f"{BOAT}/parameters/compare", _compare, "pin"),
)
