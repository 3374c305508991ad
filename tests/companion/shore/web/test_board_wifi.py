"""`/api/board/wifi`: who may ask, and what is refused."""

import asyncio
from pathlib import Path

import pytest
from shore_fakes import run, serving
from twins.wifi_air import Air

from companion.shore.board.nmcli import Nmcli
from companion.shore.board.tools import BoardTools
from companion.shore.board.wifi import Wifi

JOIN = {"name": "cafe", "security": "WPA2", "password": "a password"}
PATHS = ("join", "use", "forget", "hotspot")


def board(tmp_path: Path) -> tuple[Air, BoardTools]:
    air = Air(tmp_path / "air")
    air.add("home")
    air.add("cafe", "a password")
    air.know("home", is_active=True)
    return air, BoardTools(wifi=Wifi(Nmcli(str(air.nmcli))))


def test_a_skipper_of_a_disarmed_boat_joins_a_network(tmp_path: Path) -> None:
    air, tools = board(tmp_path)

    async def test() -> None:
        async with serving(board=tools) as server:
            server.boats.change(armed=False)
            await server.log_in()
            async with server.client.post("/api/board/wifi/join", json=JOIN, headers=server.own) as answer:
                assert answer.status == 200
                assert (await answer.json())["stage"] == "changing"
            stage = ""
            while stage != "kept":
                async with server.client.get("/api/board/wifi") as answer:
                    state = await answer.json()
                    stage = state["change"]["stage"]
                await asyncio.sleep(0.01)
            assert [one["name"] for one in state["networks"] if one["is_used"]] == ["cafe"]
            assert "a password" not in str(state)

    run(test())
    assert air.active() == ["cafe"]


def test_viewers_see_no_networks_and_an_armed_boat_stays_in_its_own(tmp_path: Path) -> None:
    air, tools = board(tmp_path)

    async def test() -> None:
        async with serving(board=tools) as server:
            async with server.client.get("/api/board/wifi") as answer:
                assert answer.status == 403
            await server.log_in()
            server.boats.change(armed=True)
            for path in PATHS:
                async with server.client.post(
                    f"/api/board/wifi/{path}", json=JOIN, headers=server.own
                ) as one:
                    assert one.status == 409

    run(test())
    assert not (air.folder / "calls").exists()


@pytest.mark.parametrize(
    "content",
    [b"", b"[]", b'{"name": 1}', b'{"name": "cafe", "security": "WPA2", "argv": "-x"}', b"\xff", b"{" * 4000],
)
def test_malformed_requests_are_refused_in_words(tmp_path: Path, content: bytes) -> None:
    air, tools = board(tmp_path)

    async def test() -> None:
        async with serving(board=tools) as server:
            server.boats.change(armed=False)
            await server.log_in()
            for path in PATHS:
                async with server.client.post(
                    f"/api/board/wifi/{path}", data=content, headers=server.own
                ) as answer:
                    assert answer.status == 400
                    assert (await answer.json())["error"]

    run(test())
    assert not (air.folder / "calls").exists()


def test_a_computer_without_network_manager_says_so() -> None:
    async def test() -> None:
        async with serving(board=BoardTools(wifi=Wifi(Nmcli("/no/nmcli")))) as server:
            server.boats.change(armed=False)
            await server.log_in()
            async with server.client.get("/api/board/wifi") as answer:
                assert answer.status == 502
                assert "needs NetworkManager" in (await answer.json())["error"]

    run(test())
