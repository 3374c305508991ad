"""Each row of the table does what its scenario says, and mutants of the table are noticed."""

import math
from collections.abc import Iterator
from typing import Any

import pytest
from failsafe_scenarios import CONFIG, LOITER, NONE, RTL, SCENARIOS, Run, check, with_hull

from companion.config.boat_config import with_value
from companion.failsafe import conditions, guards
from companion.failsafe.table import ROWS, Condition, Row


@pytest.mark.parametrize("condition", Condition, ids=lambda one: one.name)
def test_the_row_does_what_its_scenario_says(condition: Condition) -> None:
    check(condition)


def changed(row: Row) -> Iterator[tuple[str, Row]]:
    """Mutants of a row."""
    for name in ("after", "clear_s", "relapse_s"):
        value = getattr(row, name)
        if isinstance(value, float) and 0.0 < value < math.inf:
            for factor in (2.0, 0.5):
                mutant: dict[str, Any] = {name: factor * value}
                yield f"{name} times {factor:g}", row._replace(**mutant)
    for at, step in enumerate(row.then):
        if isinstance(step.after, float):
            longer = step._replace(after=2.0 * step.after)
            yield f"step {at} doubled", row._replace(then=(*row.then[:at], longer, *row.then[at + 1 :]))
        yield f"step {at} deleted", row._replace(then=row.then[:at] + row.then[at + 1 :])
    guard = row.guard
    yield "disarmed flipped", row._replace(guard=guard._replace(disarmed=not guard.disarmed))
    for name, modes in (
        ("all", guards.ALL_MODES),
        ("position", guards.POSITION_MODES),
        ("autonomous", guards.AUTONOMOUS_MODES),
    ):
        if modes != guard.modes:
            yield f"modes {name}", row._replace(guard=guard._replace(modes=modes))
    yield "text of its end", row._replace(over=row.over + "!")


def unspared(row: Row) -> Row:
    spares = guards.never if row.guard.spares is not guards.never else guards.on_way_home
    return row._replace(guard=row.guard._replace(spares=spares))


def mutants() -> Iterator[tuple[Condition, str, tuple[Row, ...]]]:
    """Tables with one row deleted or changed."""
    for at, row in enumerate(ROWS):
        yield row.condition, "deleted", ROWS[:at] + ROWS[at + 1 :]
        for name, mutant in changed(row):
            if name == "text of its end" and row.clear_s == math.inf:
                continue
            yield row.condition, name, (*ROWS[:at], mutant, *ROWS[at + 1 :])
        retreats = SCENARIOS[row.condition].action in (RTL, LOITER, NONE)
        if retreats:
            yield row.condition, "spares flipped", (*ROWS[:at], unspared(row), *ROWS[at + 1 :])
        if row.is_slow:
            yield row.condition, "not slow", (*ROWS[:at], row._replace(is_slow=False), *ROWS[at + 1 :])


@pytest.mark.parametrize(
    ("condition", "rows"),
    [pytest.param(one, rows, id=f"{one.name} {name}") for one, name, rows in mutants()],
)
def test_every_mutant_of_a_row_is_noticed(condition: Condition, rows: tuple[Row, ...]) -> None:
    with pytest.raises((AssertionError, ValueError, StopIteration)):
        check(condition, rows)


THRESHOLDS = [(one, path) for one, scenario in SCENARIOS.items() for path in scenario.thresholds]


@pytest.mark.parametrize(("condition", "path"), THRESHOLDS, ids=lambda one: getattr(one, "name", one))
def test_every_doubled_threshold_is_noticed(condition: Condition, path: str) -> None:
    section, field = path.split(".")
    value = getattr(getattr(CONFIG, section), field)
    with pytest.raises(AssertionError):
        check(condition, config=with_value(CONFIG, path, 2 * value))


@pytest.mark.parametrize("condition", [Condition.LEAK, Condition.TOO_HOT], ids=lambda one: one.name)
def test_a_doubled_age_of_the_hull_sensor_is_noticed(
    condition: Condition, monkeypatch: pytest.MonkeyPatch
) -> None:
    stale = with_hull(age_s=5.1, is_wet=True, celsius=86.0)
    assert Run(condition, ROWS, CONFIG).live(stale, 20.0) == []
    monkeypatch.setattr(conditions, "_STALE_S", 10.0)
    assert Run(condition, ROWS, CONFIG).live(stale, 20.0)


def test_every_condition_has_one_row_and_one_scenario() -> None:
    assert sorted(row.condition for row in ROWS) == sorted(Condition) == sorted(SCENARIOS)
