"""docs/first-day.md: its commands, keys and parameters exist."""

import re
from pathlib import Path

from companion.app.cli import program
from companion.app.init.questions import value_at
from companion.cli.command_line import command_parser
from companion.config.boat_config import BoatConfig
from companion.config.parameter_table import ROWS

PAGE = (Path(__file__).parents[3] / "docs" / "first-day.md").read_text(encoding="utf-8")


def test_every_command_and_option_of_the_page_exists() -> None:
    commands = program.by_name()
    used = re.findall(r"(?:boat-companion|\$B) ([a-z-]+)((?:[^\n`#|;&]|\\\n)*)", PAGE)
    assert len(used) > 8
    for name, rest in used:
        assert name in commands, name
        known = set(command_parser("boat-companion", commands[name])._option_string_actions)
        assert set(re.findall(r"(?<!\S)--[a-z-]+", rest)) <= known, (name, rest)


def test_every_key_and_parameter_of_the_page_exists() -> None:
    keys = re.findall(r"`([a-z]+(?:\.[a-z_]+)+)`", PAGE)
    assert len(keys) > 8
    for key in keys:
        if not key.endswith((".toml", ".txt", ".local")):
            value_at(BoatConfig(), key)
    names = set(re.findall(r"`([A-Z]{2,}_[A-Z_0-9]+)`", PAGE))
    assert names <= {row.name for row in ROWS}
