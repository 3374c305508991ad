"""`/api/board/config`: what the boat's own program refuses is not saved."""

import sys
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import pytest
from shore_fakes import Server, run, serving

from companion.shore.board.config_check import PROGRAM
from companion.shore.board.config_file import ConfigFile
from companion.shore.board.tools import BoardTools

GOOD = """\
links = ["tcpin:127.0.0.1:0"]
parts.motors.driver = "l298n"
external = { position = 2, heading = 2 }
"""
SAYS = "import sys; sys.stderr.write(sys.argv[1]); sys.exit(int(sys.argv[2]))"


@asynccontextmanager
async def boat(
    folder: Path, *, logs_in: bool = True, check: tuple[str, ...] = PROGRAM
) -> AsyncIterator[Server]:
    """A disarmed boat with its configuration."""
    file = folder / "boat.toml"
    file.write_text(GOOD, encoding="utf-8")
    async with serving(board=BoardTools(config=ConfigFile(file), check=check)) as server:
        server.boats.change(armed=False)
        if logs_in:
            assert await server.log_in() == 200
        yield server


async def post(server: Server, path: str, content: object) -> tuple[int, dict[str, Any]]:
    async with server.client.post(path, json=content, headers=server.own) as response:
        return response.status, await response.json()


async def get(server: Server, path: str = "/api/board/config") -> dict[str, Any]:
    async with server.client.get(path) as response:
        assert response.status == 200
        answer: dict[str, Any] = await response.json()
        return answer


def test_a_wrong_text_is_complained_of_with_its_line_and_not_saved(tmp_path: Path) -> None:
    async def test() -> None:
        async with boat(tmp_path) as server:
            read = (await get(server))["config"]
            assert read["text"] == GOOD
            wrong = GOOD + "\n[heading]\nkp = 'much'\n"
            for path in ("/api/board/config/check", "/api/board/config"):
                status, said = await post(server, path, {"text": wrong, "replaced": read["hash"]})
                assert (status, said["ok"]) == (200, False)
                assert said["complaints"] == [
                    {"line": 6, "text": "Expected `float`, got `str` - at `$.heading.kp`"}
                ]
            assert await get(server) == {"config": read, "kept": [], "name": str(tmp_path / "boat.toml")}

    run(test())


def test_a_right_text_is_checked_without_a_trace_and_saved_with_the_old_one_kept(tmp_path: Path) -> None:
    async def test() -> None:
        async with boat(tmp_path) as server:
            read = (await get(server))["config"]
            text = GOOD + "[heading]\nkp = 2.5\n"
            assert await post(server, "/api/board/config/check", {"text": text}) == (
                200,
                {"ok": True, "complaints": []},
            )
            assert (await get(server))["config"] == read
            status, said = await post(server, "/api/board/config", {"text": text, "replaced": read["hash"]})
            assert (status, said["ok"]) == (200, True)
            now = await get(server)
            assert (now["config"]["text"], now["config"]["hash"]) == (text, said["hash"])
            assert [one["number"] for one in now["kept"]] == [1]
            assert (await get(server, "/api/board/config/1"))["config"]["text"] == GOOD
            status, said = await post(server, "/api/board/config", {"text": GOOD, "replaced": read["hash"]})
            assert (status, (await get(server))["config"]["text"]) == (409, text)
            assert "changed meanwhile" in said["error"]

    run(test())


def test_without_the_pin_nobody_reads_and_while_armed_nobody_writes(tmp_path: Path) -> None:
    async def test() -> None:
        async with boat(tmp_path, logs_in=False) as server:
            for path in ("/api/board", "/api/board/config", "/api/board/config/1"):
                async with server.client.get(path) as response:
                    assert response.status == 403
                    assert "tcpin" not in await response.text()
            for path in ("/api/board/config/check", "/api/board/config"):
                assert (await post(server, path, {"text": GOOD}))[0] == 403
            await server.log_in()
            for armed in (True, None):
                server.boats.change(armed=armed)
                for path in ("/api/board/config/check", "/api/board/config"):
                    assert (await post(server, path, {"text": GOOD}))[0] == 409

    run(test())


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        (b"", 400),
        (b"[1]", 400),
        (b'{"text": 1}', 400),
        (b'{"text": "a", "path": "/etc/passwd"}', 400),
        (b'{"text": "\xfc"}', 400),
        (b'{"text": "\\ud800"}', 400),
        (b"[" * 300_000, 400),
        (b'{"text": "' + b"#" * 64_001 + b'"}', 413),
        (b'{"text": "' + b"#" * 400_001 + b'"}', 413),
    ],
)
def test_what_is_no_configuration_is_refused_in_words(tmp_path: Path, content: bytes, expected: int) -> None:
    async def test() -> None:
        async with (
            boat(tmp_path) as server,
            server.client.post("/api/board/config", data=content, headers=server.own) as response,
        ):
            assert response.status == expected
            assert (await response.json())["error"]
        assert (tmp_path / "boat.toml").read_text("utf-8") == GOOD

    run(test())


@pytest.mark.parametrize("text", ["a\0b", "[" * 64_000, "a." * 32_000, "x = " + "9" * 60_000, "'" * 64_000])
def test_a_hostile_text_is_a_complaint_like_any_other(tmp_path: Path, text: str) -> None:
    async def test() -> None:
        async with boat(tmp_path) as server:
            status, said = await post(server, "/api/board/config/check", {"text": text})
            assert (status, said["ok"]) == (200, False)
            assert said["complaints"][0]["text"].startswith("not a TOML file: ")

    run(test())


@pytest.mark.parametrize(
    ("program", "status", "said"),
    [
        ((sys.executable, "-c", SAYS, "boat-companion: no room\n", "1"), 200, "no room"),
        ((sys.executable, "-c", SAYS, "", "7"), 500, "ended with 7 and did not say why"),
        (("/no/such/program",), 500, "cannot be started: No such file"),
    ],
)
def test_a_check_that_fails_saves_nothing(
    tmp_path: Path, program: tuple[str, ...], status: int, said: str
) -> None:
    async def test() -> None:
        async with boat(tmp_path, check=program) as server:
            now = (await get(server))["config"]
            got = await post(server, "/api/board/config", {"text": "a = 1", "replaced": now["hash"]})
            assert got[0] == status
            assert said in str(got[1])
            assert (await get(server))["config"] == now

    run(test())


def test_elsewhere_than_on_the_boat_there_is_no_configuration() -> None:
    async def test() -> None:
        async with serving() as server:
            server.boats.change(armed=False)
            await server.log_in()
            assert (await get(server, "/api/board"))["config"] is False
            async with server.client.get("/api/board/config") as response:
                assert response.status == 404
            assert (await post(server, "/api/board/config", {"text": GOOD}))[0] == 404

    run(test())
