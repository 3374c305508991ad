"""`boat-sitl tune`: PID gains for a boat, found by sailing."""

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import msgspec
import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn
from rich.table import Table

from sitl.campaign.campaign import Campaign
from sitl.campaign.ledger import Ledger
from sitl.campaign.run import Outcome, Run
from sitl.campaign.workers import Crew, cores, local_crew
from sitl.scenario import load_scenario
from sitl.tuning.gains import Gains, gains_of, parameter_file
from sitl.tuning.search import CANDIDATES, Standing, search
from sitl.tuning.trial import Trials

_CHECK_SEEDS = 4  # other seeds than those of the search
_CHECK_AT = 1_000_000  # where the numbers of their runs begin


def tune(
    boat: Annotated[str, typer.Argument(metavar="BOAT", help="lake, pool, or a boat's .toml file")],
    out: Annotated[
        Path | None, typer.Option("--out", "-o", metavar="DIR", help="where results go [out/tune-BOAT]")
    ] = None,
    workers: Annotated[int | None, typer.Option(min=1, metavar="N", help="processes [all cores]")] = None,
    seed: Annotated[int, typer.Option(help="of the search and of its runs")] = 9001,
    candidates: Annotated[int, typer.Option(min=4, help="sets of gains a round")] = CANDIDATES,
) -> None:
    """Find the gains of heading and speed by a campaign, and write them as a parameter file.

    Tries sets of gains on a course of sharp and gentle corners, in still water and in currents, and looks
    closer around the best (successive halving). Prints figures before and after, on seeds that the search has
    not seen. After Ctrl-C the same command goes on where it stopped.

    A ground station loads tuned.parm; so does the boat, as params.parm in its storage folder.

    Example:  boat-sitl tune lake -o out/tune-lake
    """
    console = Console(highlight=False, soft_wrap=True)
    model = boat if not boat.endswith(".toml") else str(Path(boat).resolve())
    scenario = load_scenario("open", [f"boat.model={model}"])
    folder = out or Path("out") / f"tune-{Path(boat).stem}"
    folder.mkdir(parents=True, exist_ok=True)
    trials = Trials(model, scenario.vehicle, scenario.frame, folder)
    before = gains_of(scenario.vehicle)
    plan = Campaign(
        f"tune {boat}", "tune", (), (), _fingerprint(boat, before, seed, candidates, scenario.hull)
    )
    console.print(f"tune {boat}: search with seeds from {seed}, check with seeds from {seed + 100}")
    with Ledger(folder, plan) as ledger, local_crew(workers or cores()) as crew:
        try:
            after, rows = _search(trials, before, seed, candidates, ledger, crew, console)
        except KeyboardInterrupt:
            console.print(f"{len(ledger.outcomes)} runs are kept: the same command goes on")
            raise
    _print(before, after, rows, console)
    path = folder / "tuned.parm"
    path.write_text(parameter_file(after, [f"gains of {boat}, found with seed {seed}"]), encoding="utf-8")
    console.print(f"written: {path}")


def _search(
    trials: Trials, before: Gains, seed: int, candidates: int, ledger: Ledger, crew: Crew, console: Console
) -> tuple[Gains, list[tuple[str, list[Outcome], float]]]:
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn())
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as progress:
        task = progress.add_task("tuning", total=None)

        def sail(runs: list[Run]) -> list[Outcome]:
            left = [run for run in runs if run.number not in ledger.outcomes]
            progress.update(task, total=len(runs), completed=len(runs) - len(left))
            for outcome in crew.sail(left):
                ledger.add(outcome)
                progress.advance(task)
            return [ledger.outcomes[run.number] for run in runs]

        standing: Standing | None = None
        for standing in search(trials, before, seed, sail, candidates):
            console.print(f"round {standing.round}: best of {standing.compared} costs {standing.cost:.3f}")
        after = before if standing is None else standing.best
        return after, _checked(trials, {"before": before, "after": after}, seed + 100, sail)


def _checked(
    trials: Trials, named: dict[str, Gains], seed: int, sail: Callable[[list[Run]], list[Outcome]]
) -> list[tuple[str, list[Outcome], float]]:
    """Outcomes and cost on seeds that the search has not seen."""
    rows = []
    for place, (name, gains) in enumerate(named.items()):
        first = _CHECK_AT * (place + 1)
        outcomes = sail(trials.runs(gains, range(seed, seed + _CHECK_SEEDS), first))
        rows.append((name, outcomes, trials.cost(outcomes)))
    return rows


def _print(
    before: Gains, after: Gains, rows: list[tuple[str, list[Outcome], float]], console: Console
) -> None:
    figures = ("cross_track_rms_m", "cross_track_max_m", "overshoot_m", "command_travel_per_s", "time_s")
    table = Table("", *(name for name, _, _ in rows), box=None)
    for path in before:
        table.add_row(path, f"{before[path]:g}", f"{after[path]:g}")
    table.add_row("cost", *(f"{cost:.3f}" for _, _, cost in rows))
    for figure in figures:
        table.add_row(figure, *(_mean(outcomes, figure) for _, outcomes, _ in rows))
    console.print(table)


def _mean(outcomes: list[Outcome], figure: str) -> str:
    values = [value for o in outcomes if isinstance(value := o.figures.get(figure), float)]
    return f"{sum(values) / len(values):.3g}" if len(values) == len(outcomes) else "–"


def _fingerprint(*parts: object) -> str:
    return hashlib.sha256(msgspec.json.encode(parts, order="deterministic")).hexdigest()
