"""The page on failsafes names every condition with its parameters."""

import re
from pathlib import Path

from companion.config.parameter_table import ROWS as PARAMETERS
from companion.failsafe.table import ROWS

PAGE = Path(__file__).parents[3] / "docs" / "failsafes.md"
LINES = {line.split("|")[1].strip(): line for line in PAGE.read_text("utf-8").splitlines() if line[:1] == "|"}


def test_every_condition_has_its_line_with_the_parameter_of_its_action() -> None:
    parameter_of = {row.path: row.name for row in PARAMETERS if row.path}
    for row in ROWS:
        line = LINES[str(row.condition.name)]
        assert f"`{parameter_of[f'failsafe.{row.action}']}`" in line


def test_the_page_names_no_parameter_that_is_not_there() -> None:
    names = {row.name for row in PARAMETERS}
    named = set(re.findall(r"`([A-Z]+_[A-Z_]+)`", PAGE.read_text("utf-8")))
    assert named - names <= {"SMART_RTL", "MISSION_START"}
