"""What a page elsewhere, a stranger on the network or a broken client may send."""

import socket
from typing import Any

import pytest
from aiohttp import WSMsgType, WSServerHandshakeError
from shore_server import PIN, Server, answer, serving, until

from mission_tools.shore.web.guard import is_own_host, own_names
from mission_tools.shore.web.login.session import READ_ONLY
from mission_tools.shore.web.sockets import MOST_BYTES

pytest_plugins = ("server_fixtures",)

HERE = socket.gethostname().partition(".")[0]
ELSEWHERE = ("https://evil.example", "null", "http://127.0.0.1:1", "http://localhost", "")


async def status(server: Server, method: str, path: str, **options: Any) -> int:  # noqa: ANN401
    async with server.client.request(method, path, **options) as response:
        return response.status


async def test_another_page_neither_posts_nor_opens_a_socket(server: Server) -> None:
    cross_site = server.own | {"Sec-Fetch-Site": "cross-site"}
    for headers in ({}, cross_site, *({"Origin": origin} for origin in ELSEWHERE)):
        assert await status(server, "POST", "/api/session", json={"pin": PIN}, headers=headers) == 403
        with pytest.raises(WSServerHandshakeError) as refused:
            await server.live(headers=headers)
        assert refused.value.status == 403
    assert server.hub.watches == []


def test_only_own_names_are_served() -> None:
    own = own_names({"Pond.example"})
    names = (
        "127.0.0.1:8080",
        "[::1]:8080",
        "10.42.0.1",
        "localhost:8080",
        f"{HERE.upper()}.LOCAL:80",
        "pond.example",
    )
    others = (
        "mavboat.local", f"x.{HERE}.local", "evil.example", "mavboat.local.evil.example", "local",
        "127.0.0.1.evil.example", "", "a b", "127.0.0.1:8080; script-src *",
    )  # fmt: skip
    assert [name for name in names if not is_own_host(name, own)] == []
    assert [name for name in others if is_own_host(name, own)] == []


async def test_a_name_that_was_pointed_here_reads_nothing(server: Server) -> None:
    for path in ("/", "/api/session", "/api/chart", "/live"):
        assert await status(server, "GET", path, headers={"Host": "evil.example"}) == 421


async def test_nothing_but_the_pages_files_is_served(server: Server) -> None:
    paths = (
        "/..%2f..%2fpin", "/%2e%2e/pin", "/..%5cpin", "/page/index.html", "/.hidden", "/index.html%00",
        "/pin", "/main.js/",
    )  # fmt: skip
    for path in paths:
        assert await status(server, "GET", path) == 404


async def test_a_flood_of_pins_is_held_up_and_the_right_one_with_it(server: Server) -> None:
    told = [await server.log_in(f"00000{n}") for n in range(8)]
    assert told == [403, 403, 403, 429, 429, 429, 429, 429]
    assert await server.log_in() == 429
    server.clock.at_s += 2.0
    assert await server.log_in() == 200


async def test_without_a_pin_the_page_says_how_to_set_one() -> None:
    async with serving(has_pin=False) as server:
        assert await server.log_in() == 409
        ws = await server.live()
        await ws.send_json({"type": "do", "id": "a", "boat": 1, "what": "arm", "with": {}})
        assert (await answer(ws))["text"] == READ_ONLY
        assert server.boats.asked == []


async def test_the_end_of_a_session_ends_the_rights_of_its_sockets(server: Server) -> None:
    await server.log_in()
    ws = await server.live()
    assert (await ws.receive_json())["role"] == "skipper"
    assert await status(server, "DELETE", "/api/session", headers=server.own) == 200
    await ws.send_json({"type": "do", "id": "a", "boat": 1, "what": "arm", "with": {}})
    assert not (await answer(ws))["ok"]
    assert server.boats.asked == []


async def test_a_malformed_message_does_nothing_and_is_answered(server: Server) -> None:
    await server.log_in()
    ws = await server.live()
    texts = (
        "", "{", "[]", "null", '{"type":"do"}', "[" * 16_000, '{"type":"do","id":"","boat":1,"what":"arm"}',
        '{"type":"do","id":"' + "x" * 65 + '","boat":1,"what":"arm"}', '{"id":"a","boat":1e999,"what":"arm"}',
        '{"type":"do","id":"a","boat":1,"what":"' + "x" * 33 + '"}',
    )  # fmt: skip
    for text in texts:
        await ws.send_str(text)
        assert not (await answer(ws))["ok"]
    assert server.boats.asked == []


@pytest.mark.parametrize("kind", ["long", "binary", "flood"])
async def test_a_socket_that_breaks_the_rules_is_closed(server: Server, kind: str) -> None:
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


async def test_an_id_repeated_on_a_new_socket_is_done_once(server: Server) -> None:
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


async def test_every_response_carries_the_policy(server: Server) -> None:
    for path in ("/", "/main.js", "/api/session", "/api/boats/1/fence", "/nothing"):
        async with server.client.get(path) as told:
            policy = told.headers["Content-Security-Policy"]
            assert "unsafe" not in policy
            assert policy.startswith("default-src 'none'; script-src 'self'; style-src 'self';")
            assert "frame-ancestors 'none'" in policy
            assert told.headers["X-Content-Type-Options"] == "nosniff"
            assert "aiohttp" not in told.headers["Server"]


async def test_a_cookie_is_for_this_site_and_not_for_scripts(server: Server) -> None:
    async with server.client.post("/api/session", json={"pin": PIN}, headers=server.own) as told:
        cookie = told.headers["Set-Cookie"]
    assert "HttpOnly" in cookie
    assert "SameSite=Strict" in cookie
    assert len(cookie.partition("=")[2].partition(";")[0]) >= 22  # 128 bits


async def test_a_search_that_fails_is_answered(server: Server, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> None:
        raise ValueError("a broken map")

    monkeypatch.setattr(server.hub.chart, "way", fail)
    await server.log_in()
    ws = await server.live()
    await ws.send_json({"type": "do", "id": "a", "boat": 1, "what": "route", "with": {"lat": 1, "lon": 2}})
    told = await answer(ws)
    assert (told["ok"], told["text"]) == (False, "The search for a way has failed.")
