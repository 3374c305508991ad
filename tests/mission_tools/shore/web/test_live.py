"""`/live`: what viewers get, at whatever speed they read."""

from typing import Any

import pytest
from aiohttp import ClientWebSocketResponse, WSServerHandshakeError
from shore_server import Server, until

from mission_tools.shore.web.feed import LOST_S
from mission_tools.shore.web.server import SOCKETS

pytest_plugins = ("server_fixtures",)


async def heard(ws: ClientWebSocketResponse, kind: str) -> dict[str, Any]:
    """The next message of a type."""
    while True:
        message: dict[str, Any] = await ws.receive_json()
        if message["type"] == kind:
            return message


async def test_a_page_is_greeted_then_gets_the_whole_and_then_differences(server: Server) -> None:
    ws = await server.live()
    hello = await ws.receive_json()
    assert (hello["type"], hello["role"], hello["boats"][0]["id"]) == ("hello", "viewer", 1)
    whole = await ws.receive_json()
    assert (whole["type"], whole["boat"]) == ("state", 1)
    assert whole["patch"]["mode"] == "HOLD"
    server.boats.change(mode="AUTO")
    server.tick()
    assert (await ws.receive_json())["patch"] == {"mode": "AUTO"}
    server.boats.change(place=None)
    server.tick()
    assert (await ws.receive_json())["patch"] == {"place": None}


async def test_a_skipper_asks_and_hears_the_answer(server: Server) -> None:
    assert await server.log_in() == 200
    ws = await server.live()
    assert (await heard(ws, "hello"))["role"] == "skipper"
    await ws.send_json({"type": "do", "id": "a", "boat": 1, "what": "hold", "with": {}})
    await heard(ws, "state")
    await until(lambda: bool(server.boats.asked))
    server.boats.answer_all("Holding.")
    answer = await heard(ws, "answer")
    assert (answer["id"], answer["ok"], answer["text"]) == ("a", True, "Holding.")


async def test_the_sensors_of_a_boat_that_was_heard_are_listed_without_a_pin(server: Server) -> None:
    async with server.client.get("/api/boats/1/sensors") as response:
        (sensor,) = await response.json()
        assert (sensor["name"], sensor["values"]) == ("gnss", {"satellites": 12})
    for boat in ("7", "x", "1000"):
        async with server.client.get(f"/api/boats/{boat}/sensors") as response:
            assert response.status == 404


async def test_a_socket_that_nobody_reads_is_closed(server: Server) -> None:
    ws = await server.live(autoping=False)
    await heard(ws, "state")
    sockets = server.app[SOCKETS]
    sockets.drop_lost(server.clock.at_s + LOST_S - 1.0)
    assert len(server.hub.watches) == 1
    sockets.drop_lost(server.clock.at_s + LOST_S + 1.0)
    await until(lambda: server.hub.watches == [])


async def test_a_socket_names_a_boat_or_gets_the_first(server: Server) -> None:
    ws = await server.live("/live")
    assert (await heard(ws, "state"))["boat"] == 1
    for wrong in ("0", "256", "x", "1e1", "-1"):
        with pytest.raises(WSServerHandshakeError) as refused:
            await server.live(f"/live?boat={wrong}")
        assert refused.value.status == 400
    async with server.client.get("/live", headers=server.own) as told:
        assert told.status == 426
