"""docs/first-day.md: every PreArm message has a cure, and commands, keys and parameters exist."""

import ast
import inspect
import re
import textwrap
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from companion.app.cli import program
from companion.app.init.questions import value_at
from companion.autopilot.sensor_suite import SensorSuite
from companion.cli.command_line import command_parser
from companion.config.boat_config import BoatConfig
from companion.config.parameter_table import ROWS
from companion.rc.rc_input import RcInput
from companion.vehicle import arming
from companion.vehicle.vehicle import Vehicle

PAGE = (Path(__file__).parents[3] / "docs" / "first-day.md").read_text(encoding="utf-8")
TABLE = PAGE.partition("| message after `PreArm:` | cure |")[2].partition("\n\n")[0]
MESSAGES = [row.split(" | ")[0].removeprefix("| ") for row in TABLE.splitlines()[2:]]

DELEGATED: dict[str, list[Callable[..., str]]] = {  # where the texts after "RC: " and "Compass: " come from
    "RC": [RcInput.fault, RcInput._fault_of],
    "Compass": [SensorSuite.compass_fault],
}


def patterns(source: str) -> Iterator[str]:
    """Regular expressions of the texts in some source, but for docstrings; inserted values match anything."""
    tree = ast.parse(source)
    inner = {
        id(part)
        for node in ast.walk(tree)
        if isinstance(node, ast.JoinedStr)
        for part in ast.walk(node)
        if part is not node
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            inner.add(id(node.value))
    for node in ast.walk(tree):
        if isinstance(node, ast.JoinedStr) and id(node) not in inner:
            parts = (part.value if isinstance(part, ast.Constant) else None for part in node.values)
            yield "".join(".+" if part is None else re.escape(str(part)) for part in parts)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in inner:
            yield re.escape(node.value)


def returned(function: Callable[..., str]) -> Iterator[str]:
    """The texts that a function returns."""
    for node in ast.walk(ast.parse(textwrap.dedent(inspect.getsource(function)))):
        if isinstance(node, ast.Return) and node.value is not None:
            yield from patterns(f"returned = {ast.unparse(node.value)}")


def expected_messages() -> list[str]:
    """What may follow `PreArm:`, as regular expressions."""
    found = list(patterns(inspect.getsource(arming)))
    found += patterns(textwrap.dedent(inspect.getsource(Vehicle.arming_faults)))
    messages = [text for text in found if re.match(r"[A-Z]\w+:\\ ", text)]
    for part, functions in DELEGATED.items():
        messages.remove(rf"{part}:\ .+")
        messages += [rf"{part}:\ {text}" for one in functions for text in returned(one) if text]
    return messages


def test_every_arming_check_is_known_to_this_test() -> None:
    """The messages of another would escape the tests below."""
    known = {function.__name__ for functions in DELEGATED.values() for function in functions}
    called = set(re.findall(r"(\w+)\(", inspect.getsource(Vehicle.arming_faults)))
    called -= {"arming_faults", "bool", "text", "append", "insert"}
    assert {name for name in called if not hasattr(arming, name)} <= known


@pytest.mark.parametrize("message", expected_messages())
def test_every_pre_arm_message_has_a_cure(message: str) -> None:
    assert any(re.fullmatch(message, written) for written in MESSAGES)


@pytest.mark.parametrize("written", MESSAGES)
def test_every_message_of_the_page_exists(written: str) -> None:
    assert any(re.fullmatch(message, written) for message in expected_messages())


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
