"""What a page elsewhere, a stranger on the network or a broken client may send."""

import asyncio
import json
import socket
from typing import Any

import pytest
from aiohttp import ClientWebSocketResponse, WSMsgType, WSServerHandshakeError
from shore_fakes import PIN, Server, run, serving, until

from mission_tools.shore.web.guard import is_own_host, own_names
from mission_tools.shore.web.login.session import READ_ONLY
from mission_tools.shore.web.sockets import MOST_BYTES, MOST_OF_ADDRESS
from mission_tools.station.messages import TextLine

HERE = socket.gethostname().partition(".")[0]
ELSEWHERE = ("https://evil.example", "null", "http://127.0.0.1:1", "http://localhost", "")


async def answer(ws: ClientWebSocketResponse) -> dict[str, Any]:
    while True:
        message: dict[str, Any] = await ws.receive_json()
        if message["type"] == "answer":
            return message


async def status(server: Server, method: str, path: str, **options: Any) -> int:  # noqa: ANN401
    async with server.client.request(method, path, **options) as response:
        return response.status


@pytest.mark.parametrize("origin", [*ELSEWHERE, None])
def test_another_page_neither_posts_nor_opens_a_socket(origin: str | None) -> None:
    async def test() -> None:
        async with serving() as server:
            headers = {} if origin is None else {"Origin": origin}
            assert await status(server, "POST", "/api/session", json={"pin": PIN}, headers=headers) == 403
            assert await status(server, "DELETE", "/api/session", headers=headers) == 403
            with pytest.raises(WSServerHandshakeError) as refused:
                await server.live(headers=headers)
            assert refused.value.status == 403
            assert server.hub.watches == []

    run(test())


def test_a_browser_that_says_cross_site_is_believed() -> None:
    async def test() -> None:
        async with serving() as server:
            headers = server.own | {"Sec-Fetch-Site": "cross-site"}
            assert await status(server, "POST", "/api/session", json={"pin": PIN}, headers=headers) == 403

    run(test())


@pytest.mark.parametrize(
    ("host", "is_own"),
    [
        ("127.0.0.1:8080", True),
        ("[::1]:8080", True),
        ("10.42.0.1", True),
        ("localhost:8080", True),
        (f"{HERE}.local", True),
        (f"{HERE.upper()}.LOCAL:80", True),
        ("mavboat.local", False),
        ("printer.local", False),
        (f"x.{HERE}.local", False),
        ("pond.example", True),
        ("evil.example", False),
        ("mavboat.local.evil.example", False),
        ("local", False),
        ("127.0.0.1.evil.example", False),
        ("", False),
        ("a b", False),
        ("127.0.0.1:8080; script-src *", False),
    ],
)
def test_only_own_names_are_served(host: str, *, is_own: bool) -> None:
    assert is_own_host(host, own_names({"Pond.example"})) is is_own


def test_a_name_that_was_pointed_here_reads_nothing() -> None:
    async def test() -> None:
        async with serving() as server:
            for path in ("/", "/api/session", "/api/chart", "/live"):
                assert await status(server, "GET", path, headers={"Host": "evil.example"}) == 421

    run(test())


@pytest.mark.parametrize(
    "path",
    [
        "/..%2f..%2fpin",
        "/%2e%2e/pin",
        "/..%5cpin",
        "/page/index.html",
        "/.hidden",
        "/index.html%00",
        "/pin",
        "/main.js/",
    ],
)
def test_nothing_but_the_pages_files_is_served(path: str) -> None:
    async def test() -> None:
        async with serving() as server:
            assert await status(server, "GET", path) == 404

    run(test())


BODIES = [
    b"",
    b"{",
    b"[]",
    b'{"pin":1}',
    b'{"pin":"1","more":1}',
    b"\xff\xfe",
    b"[" * 20_000,
    b'{"pin":"\\ud800"}',
]


@pytest.mark.parametrize("body", BODIES, ids=lambda body: repr(body[:12]))
def test_a_broken_body_is_answered_in_words(body: bytes) -> None:
    async def test() -> None:
        async with (
            serving() as server,
            server.client.post("/api/session", data=body, headers=server.own) as told,
        ):
            assert told.status == 400
            assert (await told.json())["error"]

    run(test())


def test_a_large_body_is_refused_before_it_is_read() -> None:
    async def test() -> None:
        async with serving() as server:
            assert (
                await status(server, "POST", "/api/session", data=b"x" * 100_000, headers=server.own) == 413
            )

    run(test())


def test_a_flood_of_pins_is_held_up_and_the_right_one_with_it() -> None:
    async def test() -> None:
        async with serving() as server:
            told = [await server.log_in(f"00000{n}") for n in range(8)]
            assert told == [403, 403, 403, 429, 429, 429, 429, 429]
            assert await server.log_in() == 429
            server.clock.at_s += 2.0
            assert await server.log_in() == 200

    run(test())


def test_without_a_pin_the_page_says_how_to_set_one() -> None:
    async def test() -> None:
        async with serving(has_pin=False) as server:
            assert await server.log_in() == 409
            ws = await server.live()
            await ws.send_json({"type": "do", "id": "a", "boat": 1, "what": "arm", "with": {}})
            assert (await answer(ws))["text"] == READ_ONLY
            assert server.boats.asked == []

    run(test())


def test_a_viewer_is_refused_with_words() -> None:
    async def test() -> None:
        async with serving() as server:
            ws = await server.live()
            for what in ("stop", "route", "arm"):
                await ws.send_json({"type": "do", "id": what, "boat": 1, "what": what, "with": {}})
                told = await answer(ws)
                assert (told["id"], told["ok"]) == (what, False)
                assert "PIN" in told["text"]
            assert server.boats.asked == []

    run(test())


def test_the_end_of_a_session_ends_the_rights_of_its_sockets() -> None:
    async def test() -> None:
        async with serving() as server:
            await server.log_in()
            ws = await server.live()
            assert (await ws.receive_json())["role"] == "skipper"
            assert await status(server, "DELETE", "/api/session", headers=server.own) == 200
            await ws.send_json({"type": "do", "id": "a", "boat": 1, "what": "arm", "with": {}})
            assert not (await answer(ws))["ok"]
            assert server.boats.asked == []

    run(test())


MESSAGES = [
    "",
    "{",
    "[]",
    "null",
    '{"type":"do"}',
    "[" * 16_000,
    '{"type":"do","id":"","boat":1,"what":"arm"}',
    '{"type":"do","id":"' + "x" * 65 + '","boat":1,"what":"arm"}',
    '{"id":"a","boat":1e999,"what":"arm"}',
]


@pytest.mark.parametrize("text", MESSAGES, ids=lambda text: repr(text[:20]))
def test_a_malformed_message_does_nothing_and_is_answered(text: str) -> None:
    async def test() -> None:
        async with serving() as server:
            await server.log_in()
            ws = await server.live()
            await ws.send_str(text)
            assert not (await answer(ws))["ok"]
            assert server.boats.asked == []

    run(test())


@pytest.mark.parametrize("kind", ["long", "binary", "flood"])
def test_a_socket_that_breaks_the_rules_is_closed(kind: str) -> None:
    async def test() -> None:
        async with serving() as server:
            ws = await server.live()
            if kind == "long":
                await ws.send_str("x" * (MOST_BYTES + 1))
            elif kind == "binary":
                await ws.send_bytes(b"x")
            else:
                for _ in range(100):
                    await ws.send_str("{}")
            while (await ws.receive()).type not in (WSMsgType.CLOSE, WSMsgType.CLOSED, WSMsgType.ERROR):
                pass
            await until(lambda: server.hub.watches == [])

    run(test())


def test_of_500_sockets_a_few_open_and_a_skipper_still_finds_room() -> None:
    async def test() -> None:
        async with serving() as server:
            opened = 0
            codes = set()
            for _ in range(500):
                server.clock.at_s += 0.1
                try:
                    await server.live()
                    opened += 1
                except WSServerHandshakeError as refused:
                    codes.add(refused.status)
            assert codes == {503}
            assert opened == MOST_OF_ADDRESS
            assert len(server.hub.watches) == MOST_OF_ADDRESS
            assert await server.log_in() == 200
            ws = await server.live()
            assert (await ws.receive_json())["role"] == "skipper"
            server.tick()
            assert server.boats.polls == 1

    run(test())


def test_an_id_repeated_on_a_new_socket_is_done_once() -> None:
    async def test() -> None:
        async with serving() as server:
            await server.log_in()
            request = {"type": "do", "id": "a", "boat": 1, "what": "go", "with": {"lat": 1, "lon": 2}}
            first = await server.live()
            await first.send_json(request)
            await until(lambda: bool(server.boats.asked))
            await first.close()
            again = await server.live()
            await again.send_json(request)
            server.tick()
            await again.send_json({"type": "do", "id": "b", "boat": 1, "what": "hold"})
            await until(lambda: any(one.id == "b" for one, _ in server.boats.asked))
            assert [one.id for one, _ in server.boats.asked] == ["a", "b"]
            server.boats.answer_all("Going.")
            assert {(await answer(again))["id"], (await answer(again))["id"]} == {"a", "b"}

    run(test())


def test_script_in_a_text_is_only_ever_json() -> None:
    async def test() -> None:
        async with serving() as server:
            text = "</script><img src=x onerror=alert(1)>"
            server.boats.change(lines=[TextLine(number=1, at_s=0.0, severity=4, text=text)])
            server.boats.lists["mission"] = {"type": "FeatureCollection", "name": text, "features": []}
            ws = await server.live()
            await ws.receive_json()
            assert (await ws.receive_json())["patch"]["lines"][0]["text"] == text
            async with server.client.get("/api/boats/1/mission") as told:
                assert told.content_type == "application/geo+json"
                assert told.headers["X-Content-Type-Options"] == "nosniff"
                assert json.loads(await told.text())["name"] == text

    run(test())


def test_every_response_carries_the_policy() -> None:
    async def test() -> None:
        async with serving() as server:
            for path in ("/", "/main.js", "/api/session", "/api/boats/1/fence", "/nothing"):
                async with server.client.get(path) as told:
                    policy = told.headers["Content-Security-Policy"]
                    assert "unsafe" not in policy
                    assert policy.startswith("default-src 'none'; script-src 'self'; style-src 'self';")
                    assert "frame-ancestors 'none'" in policy
                    assert told.headers["X-Content-Type-Options"] == "nosniff"
                    assert "aiohttp" not in told.headers["Server"]

    run(test())


def test_a_cookie_is_for_this_site_and_not_for_scripts() -> None:
    async def test() -> None:
        async with serving() as server:
            async with server.client.post("/api/session", json={"pin": PIN}, headers=server.own) as told:
                cookie = told.headers["Set-Cookie"]
            assert "HttpOnly" in cookie
            assert "SameSite=Strict" in cookie
            assert len(cookie.partition("=")[2].partition(";")[0]) >= 22  # 128 bits

    run(test())


def test_a_reader_that_stops_is_closed_and_others_go_on() -> None:
    async def test() -> None:
        async with serving() as server:
            stopped = await server.live()
            reading = await server.live()
            for number in range(200):
                server.boats.change(speed_m_s=float(number))
                server.tick()
                while (await reading.receive_json()).get("patch", {}).get("speed_m_s") != float(number):
                    pass
            assert len(server.hub.watches) == 2
            lost = [watch for watch in server.hub.watches if watch.viewer.is_lost(server.clock.at_s)]
            assert len(lost) == 1
            assert not stopped.closed

    run(test())


def test_a_cached_file_is_not_sent_again() -> None:
    async def test() -> None:
        async with serving() as server:
            async with server.client.get("/main.js", headers={"Accept-Encoding": "gzip"}) as told:
                assert told.headers["Content-Encoding"] == "gzip"
                tag = told.headers["ETag"]
            assert await status(server, "GET", "/main.js", headers={"If-None-Match": tag}) == 304

    run(test())


def test_a_search_that_fails_is_answered(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> None:
        raise ValueError("a broken map")

    async def test() -> None:
        async with serving() as server:
            monkeypatch.setattr(server.hub.chart, "way", fail)
            await server.log_in()
            ws = await server.live()
            await ws.send_json(
                {"type": "do", "id": "a", "boat": 1, "what": "route", "with": {"lat": 1, "lon": 2}}
            )
            told = await answer(ws)
            assert (told["ok"], told["text"]) == (False, "The search for a way has failed.")

    run(test())


def test_asyncio_is_left_clean() -> None:
    """A server that ends closes its sockets."""

    async def test() -> None:
        async with serving() as server:
            ws = await server.live()
        while (await ws.receive()).type not in (WSMsgType.CLOSE, WSMsgType.CLOSING, WSMsgType.CLOSED):
            await asyncio.sleep(0)

    run(test())
