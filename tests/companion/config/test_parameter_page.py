"""The page in docs/ is what the table says."""

import re
from pathlib import Path

import pytest

from companion.app.cli import run_program
from companion.config.compass_rows import MAGNETOMETER_ROWS
from companion.config.parameter_page import parameter_page
from companion.config.parameter_table import ROWS

PAGE = Path(__file__).parents[3] / "docs" / "parameters.md"


def test_the_page_is_up_to_date() -> None:
    assert PAGE.read_text(encoding="utf-8") == parameter_page(), (
        "run: boat-companion params --markdown > docs/parameters.md"
    )


def test_the_page_has_every_parameter_once_and_tables_that_hold_together() -> None:
    lines = [line for line in parameter_page().splitlines() if line.startswith("| `")]
    described = [line for line in lines if line.count("|") in (8, 6)]
    assert sorted(re.findall(r"^\| `(\w+)`", "\n".join(described), re.MULTILINE)) == [
        row.name for row in ROWS
    ]
    of_magnetometer = [line for line in lines if line.count("|") == 7]
    assert [line.split("`")[1] for line in of_magnetometer] == sorted(row.name for row in MAGNETOMETER_ROWS)
    assert {line.count("|") for line in lines} == {8, 7, 6, 3}


def test_the_page_says_once_what_the_numbers_of_each_choice_stand_for() -> None:
    values = [
        line for line in parameter_page().splitlines() if line.startswith("| `") and line.count("|") == 3
    ]
    named = re.findall(r"`(\w+)`", "\n".join(values))
    assert sorted(named) == [row.name for row in ROWS if (row.values or row.bits) and not row.read_only]
    assert len({line.split("|")[2] for line in values}) == len(values)


def test_the_command_prints_the_page(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_program(["params", "--markdown"]) == 0
    assert capsys.readouterr().out == parameter_page()
