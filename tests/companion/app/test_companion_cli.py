import sys
from pathlib import Path

import pytest

from companion.__main__ import main
from companion.config.parameter_table import ROWS

BOAT_TOML = """
links = ["udpin:127.0.0.1:0"]
[parts.motors]
driver = "l298n"
[parts.gnss]
driver = "nmea"
[parts.compass]
driver = "nmea"
"""


def run(monkeypatch: pytest.MonkeyPatch, *arguments: str) -> int:
    """Run the program in this process; its exit code."""
    monkeypatch.setattr(sys, "argv", ["boat-companion", *arguments])
    with pytest.raises(SystemExit) as caught:
        main()
    return int(caught.value.code or 0)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (None, "cannot be read"),
        ("links = [", "not a TOML file"),
        ("[heading]\nkpp = 1", "kpp"),
        ("links = ['udpin::14550']", "parts.motors.driver"),
        (BOAT_TOML.replace("udpin:127.0.0.1:0", "warp:9"), "warp"),
    ],
)
@pytest.mark.parametrize("command", ["check", "run"])
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


def test_every_parameter_is_listed_with_its_meaning(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", "200")
    assert run(monkeypatch, "params") == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines[1:]] == [row.name for row in ROWS]
