"""Every program explains itself the same way: -h, --version, and its whole help without arguments."""

import importlib
import socket

import pytest

from companion import __version__
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
}
programs = pytest.mark.parametrize("name", PROGRAMS)


def program(name: str) -> Run:
    run: Run = importlib.import_module(PROGRAMS[name]).load()
    return run


@programs
def test_the_version_is_one_line(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert program(name)(["--version"]) == 0
    assert capsys.readouterr().out == f"{__version__}\n"


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
