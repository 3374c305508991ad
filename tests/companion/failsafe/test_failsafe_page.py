"""The page on failsafes says of every row what the table says."""

import re
from pathlib import Path

import pytest

from companion.config.boat_config import BoatConfig
from companion.config.parameter_table import ROWS as PARAMETERS
from companion.failsafe.actions import Action
from companion.failsafe.table import ROWS, Condition, Row
from companion.guidance.stall_detector import HELD_S, STALL_S

PAGE = Path(__file__).parents[3] / "docs" / "failsafes.md"
TABLE_LINES = [line for line in PAGE.read_text("utf-8").splitlines() if line.startswith("|")]
CELLS = {
    cells[0]: cells for cells in ([cell.strip() for cell in line.split("|")[1:-1]] for line in TABLE_LINES)
}
SETTING = BoatConfig().failsafe
WORDS = {
    Action.NONE: "tell only",
    Action.RTL: "RTL",
    Action.LOITER_OR_HOLD: "LOITER",
    Action.SMART_RTL_OR_RTL: "SMART_RTL",
    Action.DISARM: "disarm",
    Action.CLEAR_PROPELLERS: "clear the propellers",
    Action.CHECK_MOTORS: "check the motors",
    Action.UNGROUND: "get off the shore",
}
# What counts the time itself, before its row fires at once
OWN_DELAYS_S = {
    Condition.OPERATOR_LOST: SETTING.gcs_timeout_s,
    Condition.PLANNER_LOST: SETTING.planner_timeout_s,
    Condition.SONAR_LOST: SETTING.sonar_timeout_s,
    Condition.STUCK: STALL_S,
    Condition.NO_HEADWAY: STALL_S,
    Condition.AGROUND: HELD_S,
}


def seconds(value: float | str) -> float:
    return float(getattr(SETTING, value)) if isinstance(value, str) else value


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row.condition.name)
def test_every_row_is_on_the_page_with_its_times_action_and_parameter(row: Row) -> None:
    _, after, action, then, ends, parameters = CELLS[str(row.condition.name)]
    after_s = OWN_DELAYS_S.get(row.condition, seconds(row.after))
    assert after == (f"{after_s:g} s" if after_s else "at once")
    assert action == WORDS[Action(getattr(SETTING, row.action))]
    assert ends == ("by BATTERY_RESET" if row.clear_s == float("inf") else f"{row.clear_s:g} s")
    assert bool(then) is bool(row.then)
    if len(row.then) == 1:
        step = row.then[0]
        then_action = getattr(SETTING, step.action) if isinstance(step.action, str) else step.action
        assert then == f"{Action(then_action).name.partition('_OR_')[0]} after {seconds(step.after):g} s"
    parameter_of = {parameter.path: parameter.name for parameter in PARAMETERS if parameter.path}
    assert f"`{parameter_of[f'failsafe.{row.action}']}`" in parameters


def test_the_page_names_no_parameter_that_is_not_there() -> None:
    names = {row.name for row in PARAMETERS}
    named = set(re.findall(r"`([A-Z]+_[A-Z_]+)`", PAGE.read_text("utf-8")))
    assert named - names <= {"SMART_RTL", "MISSION_START"}
