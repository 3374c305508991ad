"""The bench: every water of the encounters with every seed, over all cores, and what came out as a table."""

from collections.abc import Callable, Sequence
from itertools import product
from statistics import fmean
from typing import Final

from sitl.experiments.encounters.trial import Trial, Water, sail_encounter
from sitl.run.parallel import in_parallel

WATERS: Final = (
    *(
        Water(kind, current_m_s=current_m_s)
        for kind in ("lone", "gap", "field", "dense")
        for current_m_s in (0.0, 0.5)
    ),
    *(Water(kind, speed_m_s) for kind in ("crossing", "head_on") for speed_m_s in (0.2, 0.5, 1.0)),
    Water("shore"),
    Water("shore", current_m_s=0.5),
)
_HEAD: Final = (
    "| in the way | runs | touched | of these inevitable | completed | time, times that without | "
    '"moves" told | "no way round" told |\n|---|---|---|---|---|---|---|---|\n'
)


def sail_all(
    waters: Sequence[Water],
    seeds: Sequence[int],
    settings: tuple[str, ...],
    workers: int,
    tell: Callable[[], None] = lambda: None,
) -> list[Trial]:
    """Every water with every seed, in that order whatever ends first. tell: called after each run.

    Raises:
        SailError: a boat would not arm or start.
    """
    wanted = [(water, seed, settings) for water, seed in product(waters, seeds)]
    return in_parallel(sail_encounter, wanted, workers, tell)


def markdown(trials: Sequence[Trial]) -> str:
    """A row a water."""
    waters = dict.fromkeys(trial.water for trial in trials)
    rows = (_row(water, [trial for trial in trials if trial.water == water]) for water in waters)
    return _HEAD + "".join(f"{row}\n" for row in rows)


def _row(water: Water, trials: Sequence[Trial]) -> str:
    touched = [trial for trial in trials if trial.touches]
    inevitable = sum(not trial.could_help for trial in touched)
    ratios = [trial.time_s / trial.alone_s for trial in trials if trial.completed]
    cells = (
        water.name,
        len(trials),
        len(touched),
        inevitable if water.speed_m_s else "",
        sum(trial.completed for trial in trials),
        f"{fmean(ratios):.2f}" if ratios else "",
        sum(trial.moves_told for trial in trials),
        sum(trial.no_way_told for trial in trials),
    )
    return f"| {' | '.join(str(cell) for cell in cells)} |"
