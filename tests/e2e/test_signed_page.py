"""`boat-shore --sign-key` on a boat that takes nothing without a signature."""

import asyncio
from pathlib import Path

import pytest
from aiohttp import ClientSession, CookieJar
from patience import JOB_S
from programs import RunBoat, RunProgram

from mission_tools.shore.web.login.pin_file import PinFile

pytestmark = pytest.mark.realtime
pytest_plugins = ("program_fixtures",)

PIN = "48291375"


async def asked(page: str, what: str) -> tuple[bool, str]:
    """A request of a browser with the PIN, and its answer."""
    origin = {"Origin": page}
    async with ClientSession(cookie_jar=CookieJar(unsafe=True), headers=origin) as web:
        async with web.post(f"{page}/api/session", json={"pin": PIN}) as told:
            assert told.status == 200
        async with asyncio.timeout(JOB_S), web.ws_connect(f"{page}/live?boat=1") as live:
            while (await live.receive_json())["type"] != "state":
                pass
            await live.send_json({"type": "do", "id": what, "boat": 1, "what": what, "with": {}})
            while (answer := await live.receive_json())["type"] != "answer":
                pass
    return answer["ok"], answer["text"]


def test_hold_and_arm_are_answered_on_a_link_that_asks_for_signatures(
    running_boat: RunBoat, run_program: RunProgram, tmp_path: Path
) -> None:
    key, pin = tmp_path / "boat.key", tmp_path / "pin"
    key.write_text("correct-horse\n", encoding="utf-8")
    key.chmod(0o600)
    boat = running_boat("open", "--sign-key", str(key))
    PinFile(pin).write(PIN)
    shore = run_program(
        "boat-shore", "--connect", f"tcp:127.0.0.1:{boat.port}", "--listen", "127.0.0.1:0",
        "--pin-file", str(pin), "--sign-key", str(key),
    )  # fmt: skip
    page = shore.wait_for(r"^the page: (http://\S+)/$")[1]
    assert asyncio.run(asked(page, "hold"))[0]
    assert asyncio.run(asked(page, "disarm"))[0]


def test_a_key_that_others_may_read_is_refused(run_program: RunProgram, tmp_path: Path) -> None:
    key = tmp_path / "boat.key"
    key.write_text("correct-horse\n", encoding="utf-8")
    key.chmod(0o644)
    ended = run_program("boat-shore", "--listen", "127.0.0.1:0", "--sign-key", str(key)).wait(JOB_S)
    assert ended.code == 2
    assert "chmod 600" in ended.err
