"""`/api/board/update`: what is taken, what is refused, and that nothing of it stays."""

import asyncio
import io
import json
import os
import shutil
from collections.abc import AsyncIterator, Iterator
from pathlib import Path
from typing import Any

import pytest
from shore_fakes import Server, run, serving, until
from wheels import make_wheel

from companion import __version__
from companion.core.wheel_file import MOST_PACKED_BYTES
from companion.shore.board.tools import BoardTools
from companion.shore.board.update_file import MOST_BYTES, UpdateFolder
from companion.shore.web import update_api

NAME = "mavboat-0.2.0-py3-none-any.whl"
PATH = "/api/board/update"
RESULT = {"state": "done", "version": "0.2.0", "before": "0.1.0", "text": "", "at_s": 1.8e9}


@pytest.fixture
def tools(tmp_path: Path) -> BoardTools:
    folder = tmp_path / "update"
    folder.mkdir()
    return BoardTools(update=UpdateFolder(folder, tmp_path / "result.json"))


@pytest.fixture
def wheel(tmp_path: Path) -> bytes:
    made = make_wheel(tmp_path)
    content = made.read_bytes()
    made.unlink()
    return content


def left(tmp_path: Path) -> list[str]:
    """The files in the folder of updates, and folders that are not `new`."""
    folder = tmp_path / "update"
    every = [Path(at) / name for at, folders, files in os.walk(folder) for name in folders + files]
    return sorted(str(one.relative_to(folder)) for one in every if one != folder / "new")


async def disarmed(server: Server) -> None:
    server.boats.change(armed=False)
    await server.log_in()


async def post(server: Server, content: Any, name: str = NAME, path: str = "") -> tuple[int, dict[str, Any]]:  # noqa: ANN401
    address = f"{PATH}{path}"
    parameters = {} if path else {"name": name}
    async with server.client.post(address, params=parameters, data=content, headers=server.own) as answer:
        return answer.status, await answer.json()


async def state(server: Server) -> dict[str, Any]:
    async with server.client.get(PATH) as answer:
        assert answer.status == 200
        told: dict[str, Any] = await answer.json()
        return told


def test_a_wheel_waits_with_its_version_until_it_is_installed(
    tmp_path: Path, tools: BoardTools, wheel: bytes
) -> None:
    async def test() -> None:
        async with serving(board=tools) as server:
            await disarmed(server)
            nothing = {"waiting": None, "is_running": False, "result": None, "trouble": None}
            assert await state(server) == nothing | {"present": __version__}
            status, told = await post(server, wheel)
            assert (status, told) == (200, {"name": NAME, "version": "0.2.0", "present": __version__})
            assert left(tmp_path) == [f"new/{NAME}"]
            assert (tmp_path / "update" / "new" / NAME).read_bytes() == wheel
            assert (await state(server))["waiting"] == {"name": NAME, "version": "0.2.0"}
            status, told = await post(server, b"", path="/install")
            assert (status, told["is_running"]) == (200, True)
            assert left(tmp_path) == [f"new/{NAME}", "start"]
            assert (tmp_path / "update" / "start").read_bytes() == b""
            assert (await post(server, wheel))[0] == 409
            assert (await post(server, b"", path="/install"))[0] == 409

    run(test())


def test_a_second_wheel_takes_the_place_of_the_first(tmp_path: Path, tools: BoardTools, wheel: bytes) -> None:
    other = make_wheel(tmp_path, version="0.3.0")

    async def test() -> None:
        async with serving(board=tools) as server:
            await disarmed(server)
            await post(server, wheel)
            assert (await post(server, other.read_bytes(), other.name))[0] == 200
            assert left(tmp_path) == [f"new/{other.name}"]
            async with server.client.delete(PATH, headers=server.own) as answer:
                assert (await answer.json())["waiting"] is None
            assert left(tmp_path) == []
            assert (await post(server, b"", path="/install"))[0] == 409
            assert left(tmp_path) == []

    run(test())


@pytest.mark.parametrize(
    "name",
    ["", "x", "mavboat.whl.exe", "../mavboat-0.2.0-py3-none-any.whl", "/etc/passwd.whl", "a/b.whl", "..whl",
     "a\\b.whl", "a\nb.whl", "a\x00.whl", "\u202e.whl", ".whl", "-rf.whl", "m" * 120 + ".whl", "bøat.whl"],
)  # fmt: skip
def test_a_name_that_is_not_a_wheels_is_refused(
    tmp_path: Path, tools: BoardTools, wheel: bytes, name: str
) -> None:
    async def test() -> None:
        async with serving(board=tools) as server:
            await disarmed(server)
            status, told = await post(server, wheel, name)
            assert (status, told["key"]) == (400, "board.update.name")

    run(test())
    assert left(tmp_path) == []


def test_what_is_no_right_wheel_is_refused_in_one_sentence(
    tmp_path: Path, tools: BoardTools, wheel: bytes
) -> None:
    async def test() -> None:
        async with serving(board=tools) as server:
            await disarmed(server)
            await post(server, wheel)
            for content, name in [
                (b"", NAME),
                (b"PK" * 5000, NAME),
                (wheel[:-9], NAME),
                (wheel, "other-1-py3-none-any.whl"),
            ]:
                status, told = await post(server, content, name)
                assert status == 400
                assert told["error"].startswith(f"{name}: ")
                assert "\n" not in told["error"]

    run(test())
    assert left(tmp_path) == [f"new/{NAME}"], "the wheel before still waits"


@pytest.mark.parametrize("is_told", [True, False])
def test_a_file_that_is_too_large_is_not_kept(tmp_path: Path, tools: BoardTools, is_told: bool) -> None:
    sent = 0

    async def parts() -> AsyncIterator[bytes]:
        nonlocal sent
        while sent < 4 * MOST_BYTES:
            sent += 1_000_000
            yield bytes(1_000_000)

    async def test() -> None:
        async with serving(board=tools) as server:
            await disarmed(server)
            content: Any = io.BytesIO(bytes(MOST_BYTES + 1)) if is_told else parts()
            try:
                status, told = await post(server, content)
                assert (status, told["key"]) == (413, "board.update.large")
            except ConnectionError:  # it closes while the client still sends
                assert not is_told
            await until(lambda: left(tmp_path) == [])

    run(test())
    assert sent < 4 * MOST_BYTES
    assert MOST_BYTES == MOST_PACKED_BYTES


def test_an_upload_that_stalls_is_ended(
    tmp_path: Path, tools: BoardTools, wheel: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(update_api, "SILENCE_S", 0.05)

    async def parts() -> AsyncIterator[bytes]:
        yield wheel[:100]
        await asyncio.Event().wait()

    async def test() -> None:
        async with serving(board=tools) as server:
            await disarmed(server)
            status, _ = await post(server, parts())
            assert status == 408

    run(test())
    assert left(tmp_path) == []


def test_an_upload_that_trickles_is_ended(
    tmp_path: Path, tools: BoardTools, wheel: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(update_api, "UPLOAD_S", 0.2)

    async def parts() -> AsyncIterator[bytes]:
        for one in wheel:
            yield bytes([one])
            await asyncio.sleep(0.01)

    async def test() -> None:
        async with serving(board=tools) as server:
            await disarmed(server)
            assert (await post(server, parts()))[0] == 408

    run(test())
    assert left(tmp_path) == []


def test_an_upload_that_breaks_off_leaves_nothing_and_frees_the_next(
    tmp_path: Path, tools: BoardTools, wheel: bytes
) -> None:
    async def test() -> None:
        async with serving(board=tools) as server:
            await disarmed(server)
            gate = asyncio.Event()

            async def parts() -> AsyncIterator[bytes]:
                yield wheel[:100]
                await gate.wait()
                yield wheel[100:]

            first = asyncio.create_task(post(server, parts()))
            await until(lambda: any(one.endswith(".whl") for one in left(tmp_path)))
            status, told = await post(server, wheel)
            assert (status, told["key"]) == (409, "board.update.busy")
            first.cancel()
            await asyncio.gather(first, return_exceptions=True)
            await until(lambda: left(tmp_path) == [])
            assert (await post(server, wheel))[0] == 200

    run(test())
    assert left(tmp_path) == [f"new/{NAME}"]


def test_what_a_power_cut_left_is_removed_by_the_next_upload(
    tmp_path: Path, tools: BoardTools, wheel: bytes
) -> None:
    stale = tmp_path / "update" / ".upload-x"
    stale.mkdir()
    (stale / NAME).write_bytes(b"half")

    async def test() -> None:
        async with serving(board=tools) as server:
            await disarmed(server)
            assert (await post(server, wheel))[0] == 200

    run(test())
    assert left(tmp_path) == [f"new/{NAME}"]


def test_neither_a_viewer_nor_anybody_while_armed_updates(
    tmp_path: Path, tools: BoardTools, wheel: bytes
) -> None:
    async def every(server: Server) -> Iterator[int]:
        found = [(await post(server, wheel))[0], (await post(server, b"", path="/install"))[0]]
        async with server.client.delete(PATH, headers=server.own) as answer:
            return iter([*found, answer.status])

    async def test() -> None:
        async with serving(board=tools) as server:
            server.boats.change(armed=False)
            assert list(await every(server)) == [403] * 3
            async with server.client.get(PATH) as answer:
                assert answer.status == 403
            await server.log_in()
            server.boats.change(armed=True)
            assert list(await every(server)) == [409] * 3

    run(test())
    assert left(tmp_path) == []


def test_without_a_folder_the_page_says_how_to_allow_it(wheel: bytes) -> None:
    async def test() -> None:
        async with serving() as server:
            await disarmed(server)
            status, told = await post(server, wheel)
            assert status == 404
            assert "boat-companion install --page --page-updates" in told["error"]
            async with server.client.get("/api/board") as answer:
                assert (await answer.json())["update"] is False

    run(test())


def test_a_folder_that_is_gone_is_named(tmp_path: Path, tools: BoardTools, wheel: bytes) -> None:
    async def test() -> None:
        async with serving(board=tools) as server:
            await disarmed(server)
            shutil.rmtree(tmp_path / "update")
            status, told = await post(server, wheel)
            assert status == 500
            assert str(tmp_path / "update") in told["error"]

    run(test())


def test_the_installers_result_is_told(tmp_path: Path, tools: BoardTools) -> None:
    async def test() -> None:
        async with serving(board=tools) as server:
            await disarmed(server)
            (tmp_path / "result.json").write_text(json.dumps(RESULT), encoding="utf-8")
            told = await state(server)
            assert (told["result"], told["is_running"]) == (RESULT, False)
            (tmp_path / "result.json").write_text(json.dumps(RESULT | {"state": "running"}), encoding="utf-8")
            assert (await state(server))["is_running"] is True

    run(test())


@pytest.mark.parametrize(
    "content",
    [b"", b"[]", b"{}", b"\xff", b'{"state": "fine"}', b'{"state": "done", "version": 2}', b"[" * 9000,
     b'{"state": "done", "text": "' + b"x" * 20_000 + b'"}', b'{"state": "done", "at_s": NaN}'],
)  # fmt: skip
def test_a_result_that_is_not_as_expected_is_named(tmp_path: Path, tools: BoardTools, content: bytes) -> None:
    (tmp_path / "result.json").write_bytes(content)

    async def test() -> None:
        async with serving(board=tools) as server:
            await disarmed(server)
            told = await state(server)
            assert told["result"] is None
            assert told["trouble"]["key"] == "board.update.damaged"

    run(test())


def test_a_result_that_is_a_link_or_a_pipe_is_not_followed(tmp_path: Path, tools: BoardTools) -> None:
    secret = tmp_path / "secret"
    secret.write_text(json.dumps(RESULT), encoding="utf-8")

    async def test() -> None:
        async with serving(board=tools) as server:
            await disarmed(server)
            (tmp_path / "result.json").symlink_to(secret)
            assert (await state(server))["result"] is None
            (tmp_path / "result.json").unlink()
            os.mkfifo(tmp_path / "result.json")
            assert (await state(server))["trouble"]["key"] == "board.update.damaged"

    run(test())
