"""Every program explains itself the same way: -h, --version, and its whole help without arguments."""

import importlib
import socket
import sys
from pathlib import Path

import pytest

from companion.__main__ import main
from companion.cli.interrupts import Run

PROGRAMS = {
    "boat-companion": "companion.__main__",
    "boat-shore": "mission_tools.shore.__main__",
    "boat-sitl": "sitl.__main__",
    "mission-plan": "mission_tools.cli.plan",
    "mission-upload": "mission_tools.cli.upload",
    "mission-download": "mission_tools.cli.download",
    "mission-check": "mission_tools.cli.check",
    "mission-trace": "mission_tools.cli.trace",
    "boat-survey": "mission_tools.cli.survey",
}


def program(name: str) -> Run:
    module = importlib.import_module(PROGRAMS[name])
    run: Run = module.load() if hasattr(module, "load") else module.run_program
    return run


@pytest.mark.parametrize("name", sorted(set(PROGRAMS) - {"boat-shore"}))  # it needs none
def test_without_arguments_the_help_is_printed_as_it_is_formatted(
    name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """To stderr with exit code 2, as click has it: nothing was done."""
    program(name)(["--help"])
    asked_for = capsys.readouterr().out
    assert program(name)([]) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err == asked_for
    assert printed.err.count("\n") > 10


def test_the_simulators_port_is_explained_too(capsys: pytest.CaptureFixture[str]) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", 0))
        port = taken.getsockname()[1]
        assert program("boat-sitl")(["physics", "open", "--port", str(port)]) == 2
    error = capsys.readouterr().err
    assert f"127.0.0.1:{port}" in error
    assert "another program has this port" in error
    assert error.count("\n") == 1


def run(monkeypatch: pytest.MonkeyPatch, *arguments: str) -> int:
    """Run the program in this process; its exit code."""
    monkeypatch.setattr(sys, "argv", ["boat-companion", *arguments])
    with pytest.raises(SystemExit) as caught:
        main()
    return int(caught.value.code or 0)


@pytest.mark.parametrize(
    ("command", "content", "words"),
    [
        ("check", None, "cannot be read"),
        ("check", "links = [", "not a TOML file"),
        ("run", "[heading]\nkpp = 1", "kpp"),
        ("check", "links = ['udpin::14550']", "parts.motors.driver"),
        ("run", 'links = ["warp:9"]', "warp"),
    ],
)
def test_a_bad_configuration_is_one_line_and_exit_code_two(
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    command: str,
    content: str | None,
    words: str,
) -> None:
    monkeypatch.setattr("companion.app.process.signal.signal", lambda *_: None)
    path = tmp_path / "boat.toml"
    if content is not None:
        path.write_text(content, encoding="utf-8")
    assert run(monkeypatch, command, "--config", str(path)) == 2
    error = capsys.readouterr().err
    assert error.startswith("boat-companion: ")
    assert words in error
    assert error.count("\n") == 1
