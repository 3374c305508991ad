"""`boat-sitl encounters`: the avoidance experiment."""

import json
from pathlib import Path
from typing import Annotated

from rich.console import Console

from companion.cli.command_line import Option, echo
from companion.cli.output_file import write_text
from companion.core.errors import UsageError
from sitl.cli.arguments import Settings, Workers
from sitl.cli.progress import progress_bar
from sitl.experiments.encounters.encounter import (
    SONAR_M,
    Ranger,
    encounter_trials,
    run_encounter,
    second_ranger,
)
from sitl.experiments.encounters.table import ENCOUNTERS, markdown, run_rows, summary
from sitl.experiments.runner import cores, local_pool, run_trials
from sitl.scenarios.layers import parse_overrides
from sitl.scenarios.scenario import load_scenario
from sitl.world.sampling import MOST_SEED


def encounters(
    seeds: Annotated[int, Option(least=1, most=100_000, help="runs of each encounter")] = 10,
    first_seed: Annotated[int, Option(least=1, most=MOST_SEED, help="the first seed")] = 1,
    only: Annotated[
        list[str] | None, Option(metavar="WORD", help="encounters whose name contains this word [all]")
    ] = None,
    sight_m: Annotated[
        float, Option("--sight", least=1.0, most=100.0, help="range of a second ranger; 4: none is fitted")
    ] = SONAR_M,
    ranger: Annotated[Ranger, Option(help="the second ranger: a 2-D scan, or one beam ahead")] = "scan",
    settings: Settings = None,
    out: Annotated[Path | None, Option("--out", "-o", help="write the table to this file, too")] = None,
    as_json: Annotated[bool, Option("--json", help="every run and the summary as JSON on stdout")] = False,
    workers: Workers = None,
) -> None:
    """Run a leg with rocks, walls, shores and moving obstacles that the boat's plan does not know.

    Each run is first made without them, so that a mover can be aimed at the boat. Prints a table and a
    summary. A touch of a mover is inevitable if none of 18,750 manoeuvres, begun 0.3 s after its first
    possible echo, keeps clear, and unheard if none does after the first echo that was heard. Travel
    counts full scales of the busier motor a minute while the boat avoids something, side changes how often
    it reports another side than before.

    Example:  boat-sitl encounters --seeds 5 --only crossing
    A lidar of 12 m:  boat-sitl encounters --seeds 5 --sight 12
    """
    console = Console(stderr=True, highlight=False)
    chosen = [one for one in ENCOUNTERS if not only or any(word in one.name for word in only)]
    if not chosen:
        known = ", ".join(one.name for one in ENCOUNTERS)
        raise UsageError(f"--only {', '.join(only or ())}: expected a part of one of {known}")
    overrides = [*(second_ranger(sight_m, ranger) if sight_m > SONAR_M else ()), *(settings or ())]
    load_scenario("open", overrides)  # a wrong setting is reported before the first run
    trials = encounter_trials(
        chosen, range(first_seed, first_seed + seeds), dict(parse_overrides(overrides).tree)
    )
    with (
        progress_bar(console, "encounters", len(trials)) as advance,
        local_pool(workers or cores()) as pool,
    ):
        results = run_trials(pool, run_encounter, trials, advance=advance, is_strict=True)
    total = summary(trials, results)
    table = f"{markdown(trials, results)}\n{total}\n"
    echo(json.dumps({"summary": total, "runs": run_rows(trials, results)}) if as_json else table)
    if out is not None:
        write_text(out, table)
