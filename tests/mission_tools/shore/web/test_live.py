"""`/live`: what viewers get, at whatever speed they read."""

from typing import Any

from aiohttp import ClientWebSocketResponse
from shore_server import Server, until

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
