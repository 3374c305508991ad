"""The port, its connections, and the program's own words."""

import io
import socket
import subprocess
import sys
from pathlib import Path

import pytest
from shore_server import PAGE, PIN, FakeBoats, FakeChart, FakeClock

from companion.core.errors import ConfigError, LinkError
from mission_tools.shore.command_line import SHOW, read_arguments
from mission_tools.shore.program import default_pin_file, run_program
from mission_tools.shore.web.listening import Listening, parse_listen
from mission_tools.shore.web.login.pin_file import PinFile
from mission_tools.shore.web.login.session import Sessions
from mission_tools.shore.web.server import make_app

pytest_plugins = ("server_fixtures",)


def listening(folder: Path) -> Listening:
    for name, text in PAGE.items():
        (folder / name).write_text(text, encoding="utf-8")
    sessions = Sessions(PinFile(folder / "none"))
    return Listening(make_app(FakeBoats(), FakeChart(), sessions, folder, FakeClock(), is_polling=False))


@pytest.mark.parametrize("text", ["8080", ":8080", "host:http", "host:65536", "[::1]"])
def test_a_wrong_address_is_refused(text: str) -> None:
    assert parse_listen("[::1]:65535") == ("::1", 65535)
    with pytest.raises(ConfigError, match="expected HOST:PORT"):
        parse_listen(text)


async def test_a_port_in_use_is_named(tmp_path: Path) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        with pytest.raises(LinkError, match=f"127.0.0.1:{port}: Address already in use"):
            await listening(tmp_path).open("127.0.0.1", port)


def test_the_program_sets_a_pin_from_standard_input(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("sys.stdin", io.StringIO(f"{PIN}\n"))
    assert run_program(["pin", "--pin-file", str(tmp_path / "pin")]) == 0
    assert PinFile(tmp_path / "pin").line() is not None
    assert PIN not in capsys.readouterr().out
    monkeypatch.setattr("sys.stdin", io.StringIO("123\n"))
    assert run_program(["pin", "--pin-file", str(tmp_path / "pin")]) == 2


def test_a_person_tells_the_pin_twice(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    told = iter((PIN, "482914", PIN, PIN))
    monkeypatch.setattr("sys.stdin.isatty", lambda: True)
    monkeypatch.setattr("getpass.getpass", lambda _: next(told))
    pin = PinFile(tmp_path / "pin")
    assert run_program(["pin", "--pin-file", str(pin.path)]) == 2
    assert "the same PIN twice" in capsys.readouterr().err
    assert pin.line() is None
    assert run_program(["pin", "--pin-file", str(pin.path)]) == 0
    assert pin.line() is not None


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (["--foo"], "No such option: --foo"),
        (["pin", "foo"], "No such command: foo"),
        (["pin", "--listen", "127.0.0.1:0"], "No such option: --listen"),
        (["--system-id", "255"], "'255' is not in 1..254"),
    ],
)
def test_a_mistake_in_the_command_line_is_named(
    arguments: list[str], named: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_program(arguments) == 2
    told = capsys.readouterr()
    assert told.out == ""
    assert named in told.err
    assert told.err.endswith("--help)\n")
    assert told.err.count("\n") == 1


def test_the_page_is_for_this_computer_and_its_boat_unless_told_otherwise(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    given = read_arguments([])
    assert (given.command, given.connect, given.listen) == (SHOW, "tcp:127.0.0.1:5760", "127.0.0.1:8080")
    assert (given.system_id, given.hosts, given.chart, given.pin_file) == (250, [], None, None)
    given = read_arguments(["--host", "a", "--host", "b", "--system-id", "254"])
    assert (given.hosts, given.system_id) == (["a", "b"], 254)
    assert read_arguments(["pin"]).command == "pin"
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    assert default_pin_file() == tmp_path / "mavboat" / "shore-pin"
    monkeypatch.delenv("XDG_STATE_HOME")
    assert default_pin_file() == Path("~/.local/state/mavboat/shore-pin").expanduser()


def test_the_server_keeps_nothing_in_memory_that_it_does_not_use() -> None:
    """Of 60 MB with three viewers; a new import that costs much shows here first."""
    ask = "import mission_tools.shore.program, sys; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", ask], capture_output=True, text=True, check=True)
    heavy = {"companion.boat", "companion.config.boat_config", "lxml", "numpy", "rich"}
    assert set(done.stdout.split()).isdisjoint(heavy), set(done.stdout.split()) & heavy


def test_what_pin_checks_in_several_threads_need_is_given_back() -> None:
    code = """
import asyncio, re, pathlib
from mission_tools.shore import memory_use
from mission_tools.shore.web.login.pin_file import hashed

def resident_kb():
    return int(re.search(r"VmRSS:\\s+(\\d+)", pathlib.Path("/proc/self/status").read_text())[1])

async def check():
    for _ in range(2):
        await asyncio.gather(*(asyncio.to_thread(hashed, "482913") for _ in range(4)))

memory_use.settle()
before_kb = resident_kb()
asyncio.run(check())
print(resident_kb() - before_kb)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert int(done.stdout) < 4_000  # four checks took 33,000 and kept them


def test_wrong_usage_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run_program(["--listen", "nonsense"]) == 2
    assert run_program(["--map", str(tmp_path / "none.geojson"), "--listen", "127.0.0.1:0"]) == 2
    assert run_program(["--connect", "nonsense", "--listen", "127.0.0.1:0"]) == 2
    assert capsys.readouterr().err.count("\n") == 3
