"""Every row of the HTTP interface: who may ask it, and from where."""

import io
import re

import pytest
from shore_server import Server

from mission_tools.shore.web.api import TABLE
from mission_tools.shore.web.rows import Row

pytest_plugins = ("server_fixtures",)

WRITES = [row for row in TABLE if row.method not in ("GET", "HEAD")]
FOR_THE_PIN = [row for row in TABLE if row.needs != "nothing"]
WITHOUT_THE_PIN = {("POST", "/api/session"), ("DELETE", "/api/session")}  # tell it, and forget the session
ELSEWHERE: tuple[dict[str, str], ...] = ({}, {"Origin": "https://evil.example"}, {"Origin": "null"})


def path_of(row: Row) -> str:
    """A path that the row's pattern takes."""

    def example(match: re.Match[str]) -> str:
        pattern = match[1]
        for text in ("1", "plan", "kml", "12", "a", "1.bin", "chart.png"):
            if re.fullmatch(pattern, text):
                return text
        raise AssertionError(f"{row.path}: no example for {pattern}")

    return re.sub(r"\{\w+\}", "1", re.sub(r"\{\w+:((?:[^{}]|\{[^{}]*\})*)\}", example, row.path))


def named(rows: list[Row]) -> pytest.MarkDecorator:
    return pytest.mark.parametrize("row", rows, ids=[f"{row.method} {row.path}" for row in rows])


async def status(server: Server, row: Row, headers: dict[str, str], body: bytes | io.BytesIO = b"{}") -> int:
    async with server.client.request(row.method, path_of(row), headers=headers, data=body) as told:
        return told.status


@named(WRITES)
async def test_another_page_cannot_ask_it(server: Server, row: Row) -> None:
    await server.log_in()
    server.boats.change(armed=False)
    for headers in ELSEWHERE:
        assert await status(server, row, headers) == 403
    assert await status(server, row, server.own | {"Sec-Fetch-Site": "same-site"}) == 403
    assert await status(server, row, server.own) != 403
    assert server.boats.asked == []


@named(WRITES)
def test_what_changes_something_needs_the_pin(row: Row) -> None:
    assert row.needs != "nothing" or (row.method, row.path) in WITHOUT_THE_PIN


@named(FOR_THE_PIN)
async def test_it_is_refused_without_the_pin(server: Server, row: Row) -> None:
    server.boats.change(armed=False)
    assert await status(server, row, server.own) == 403
    cookie = {"Cookie": f"mavboat-shore-{server.client.port}=AAAAAAAAAAAAAAAAAAAAAA"}
    assert await status(server, row, server.own | cookie) == 403


@named(WRITES)
async def test_a_broken_body_is_answered_and_no_fault(
    server: Server, row: Row, caplog: pytest.LogCaptureFixture
) -> None:
    await server.log_in()
    server.boats.change(armed=False)
    for body in (b"", b"{", b"[" * 30_000, b"\xff" * 100, b'{"text":1}', b"PK\x03\x04", b'{"a":"\\ud800"}'):
        assert await status(server, row, server.own, body) < 500 or path_of(row).startswith("/api/b")
    assert [record.getMessage() for record in caplog.records if record.exc_info] == []


@named(WRITES)
async def test_an_endless_body_is_refused(server: Server, row: Row) -> None:
    await server.log_in()
    server.boats.change(armed=False)
    assert await status(server, row, server.own, io.BytesIO(b"[" * 3_000_000)) in (200, 404, 413, 503)
