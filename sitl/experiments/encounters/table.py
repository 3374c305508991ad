"""All encounters of the avoidance experiment, and their results as a table."""

from collections.abc import Sequence
from statistics import fmean
from typing import Any, Final

from sitl.experiments.encounters.encounter import Encounter
from sitl.experiments.trial import Trial, TrialResult

ENCOUNTERS: Final = (
    *(
        Encounter(kind, current_m_s=current_m_s)
        for kind in ("lone", "gap", "field", "dense")
        for current_m_s in (0.0, 0.5)
    ),
    *(Encounter(kind, speed_m_s) for kind in ("crossing", "head_on") for speed_m_s in (0.2, 0.5, 1.0)),
    Encounter("shore"),
    Encounter("shore", current_m_s=0.5),
)
_HEAD: Final = (
    "| in the way | runs | touched | of these inevitable | unheard | completed | time, times that without | "
    "gave way | found no way | travel a minute | side changes |\n"
    "|---|---|---|---|---|---|---|---|---|---|---|\n"
)


def markdown(trials: Sequence[Trial], results: Sequence[TrialResult]) -> str:
    """A row for each encounter."""
    groups: dict[Encounter, list[TrialResult]] = {}
    for trial, result in zip(trials, results, strict=True):
        groups.setdefault(Encounter(**trial.factors), []).append(result)
    return _HEAD + "".join(f"{_row(encounter, group)}\n" for encounter, group in groups.items())


def summary(trials: Sequence[Trial], results: Sequence[TrialResult]) -> str:
    """Touches of still obstacles, of movers and of the shore, and the time lost in completed runs; how
    calmly what lies still is avoided.
    """
    still: list[TrialResult] = []
    moving: list[TrialResult] = []
    shore: list[TrialResult] = []
    for trial, result in zip(trials, results, strict=True):
        encounter = Encounter(**trial.factors)
        (moving if encounter.speed_m_s else shore if encounter.kind == "shore" else still).append(result)
    inevitable, unheard = (_count(moving, name) for name in ("inevitable", "unheard"))
    return (
        f"still: {_count(still)} touches of {len(still)}; "
        f"movers: {_count(moving)} of {len(moving)}, {inevitable} inevitable, {unheard} unheard; "
        f"shore: {_count(shore)} of {len(shore)}; "
        f"time lost: still {_time_lost(still)}, movers {_time_lost(moving)}, shore {_time_lost(shore)}; "
        f"beside still: motor travel {_travel(still)} a minute, side changes {_changes(still)}"
    )


def run_rows(trials: Sequence[Trial], results: Sequence[TrialResult]) -> list[dict[str, Any]]:
    """Each run with its encounter, seed and figures, for JSON."""
    return [
        {
            "encounter": Encounter(**trial.factors).name,
            "seed": trial.seed,
            "ended": result.ended,
            **result.figures,
        }
        for trial, result in zip(trials, results, strict=True)
    ]


def _count(results: Sequence[TrialResult], figure: str = "touches") -> int:
    return sum(bool(result.figures[figure]) for result in results)


def _time_lost(results: Sequence[TrialResult]) -> str:
    """Relative to the same runs without obstacles."""
    completed = [result for result in results if result.ended == "completed"]
    if not completed:
        return "unknown"
    with_s, alone_s = (sum(one.value(name) for one in completed) for name in ("time_s", "alone_s"))
    return f"{100.0 * (with_s / alone_s - 1.0):.0f} %"


def _travel(results: Sequence[TrialResult]) -> str:
    """Full scales a minute, while the local planner steers."""
    travel, avoiding_s = (
        sum(one.value(name) for one in results) for name in ("avoiding_travel", "avoiding_s")
    )
    return f"{60.0 * travel / avoiding_s:.0f}" if avoiding_s else "unknown"


def _changes(results: Sequence[TrialResult]) -> int:
    return round(sum(one.value("side_changes") for one in results))


def _row(encounter: Encounter, results: Sequence[TrialResult]) -> str:
    touched = [result for result in results if result.figures["touches"]]
    completed = [result for result in results if result.ended == "completed"]
    cells = (
        encounter.name,
        len(results),
        len(touched),
        *(_count(touched, name) if encounter.speed_m_s else "" for name in ("inevitable", "unheard")),
        len(completed),
        f"{fmean(one.value('time_s') / one.value('alone_s') for one in completed):.2f}" if completed else "",
        round(sum(result.value("moves_told") for result in results)),
        round(sum(result.value("no_way_told") for result in results)),
        _travel(results),
        _changes(results),
    )
    return f"| {' | '.join(str(cell) for cell in cells)} |"
