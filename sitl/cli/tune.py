"""`boat-sitl tune`: PID gains for a boat, found by sailing."""

import hashlib
import json
from pathlib import Path
from typing import Annotated

import msgspec
import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table

from companion.core.errors import BoatError
from companion.core.output_file import output_folder, write_text
from sitl.cli.arguments import Workers
from sitl.experiments.campaign.campaign import Campaign
from sitl.experiments.campaign.ledger import Ledger
from sitl.experiments.campaign.run import Outcome, Run
from sitl.experiments.campaign.workers import Crew, cores, local_crew
from sitl.experiments.tuning.gains import Gains, gains_of, parameter_file
from sitl.experiments.tuning.picture import draw_search
from sitl.experiments.tuning.search import CANDIDATES, REACHES, Sail, Standing, search
from sitl.experiments.tuning.trial import Trials
from sitl.experiments.tuning.verdict import TuningVerdict, judge
from sitl.scenarios.scenario import load_scenario
from sitl.world.sensors.sampling import MOST_SEED

_CHECK_SEEDS = 8  # other seeds than those of the search
_CHECK_AT = 1_000_000  # where the numbers of their runs begin
_FIGURES = ("kept_rms_m", "kept_max_m", "overshoot_m", "command_travel_per_s", "time_s")

Found = tuple[list[Standing], dict[str, list[Outcome]]]


class TuneError(BoatError):
    """The boat does not sail the course."""


def tune(
    boat: Annotated[str, typer.Argument(metavar="BOAT", help="lake, pool, kit, or a boat's .toml file")],
    out: Annotated[
        Path | None, typer.Option("--out", "-o", metavar="DIR", help="where results go [out/tune-BOAT]")
    ] = None,
    workers: Workers = None,
    seed: Annotated[int, typer.Option(min=0, max=MOST_SEED, help="of the search and of its runs")] = 9001,
    candidates: Annotated[int, typer.Option(min=4, max=100_000, help="sets of gains a round")] = CANDIDATES,
    as_json_text: Annotated[
        bool, typer.Option("--json", help="gains, verdict and figures as JSON on stdout")
    ] = False,
) -> None:
    """Find the gains of heading and speed by a campaign, and write them as a parameter file.

    Tries sets of gains on a course of sharp and gentle corners, in still water and in currents, and looks
    closer around the best (successive halving). Then sails the best and the boat's own on seeds that the
    search has not seen; what is not better there beyond doubt is not taken. After Ctrl-C the same command
    goes on where it stopped.

    A ground station loads tuned.parm; so does the boat, as params.parm in its storage folder. tuning.png
    shows the search. Exit code 1 if the boat does not complete the course with the gains that are written.

    Example:  boat-sitl tune lake -o out/tune-lake
    """
    console = Console(stderr=as_json_text, highlight=False, soft_wrap=True)
    model = boat if not boat.endswith(".toml") else str(Path(boat).resolve())
    scenario = load_scenario("open", [f"boat.model={model}"])
    folder = out or Path("out") / f"tune-{Path(boat).stem}"
    output_folder(folder)
    trials = Trials(model, scenario.vehicle, scenario.frame, folder)
    before = gains_of(scenario.vehicle)
    plan = Campaign(
        f"tune {boat}", "tune", (), (), _fingerprint(boat, before, seed, candidates, scenario.hull)
    )
    console.print(f"tune {boat}: search with seeds from {seed}, check with seeds from {seed + 100}")
    with Ledger(folder, plan) as ledger, local_crew(workers or cores()) as crew:
        if ledger.outcomes:
            console.print(f"{len(ledger.outcomes)} runs are there from before")
        try:
            standings, checked = _sail_all(trials, before, seed, candidates, ledger, crew, console)
        except KeyboardInterrupt:
            console.print(f"{len(ledger.outcomes)} runs are kept: the same command goes on")
            raise
    best = standings[-1].best
    verdict = judge(trials.ratios(checked["after"], checked["before"]))
    taken = best if verdict.is_better else before
    path = folder / "tuned.parm"
    word = "found" if verdict.is_better else "its own: no better ones were found"
    write_text(path, parameter_file(taken, [f"gains of {boat}, {word} with seed {seed}"]))
    draw_search(standings, verdict, f"gains of {boat}", folder / "tuning.png")
    if as_json_text:
        typer.echo(_as_json(boat, seed, before, best, verdict, checked, path))
    else:
        _print(before, best, verdict, checked, console)
        console.print(f"written: {path}, {folder / 'tuning.png'}")
    outcomes = checked["after" if verdict.is_better else "before"]
    lost = sum(outcome.ended != "completed" for outcome in outcomes)
    if lost:
        raise TuneError(f"{lost} of {len(outcomes)} runs with the gains in {path} are not completed")


def _sail_all(
    trials: Trials, before: Gains, seed: int, candidates: int, ledger: Ledger, crew: Crew, console: Console
) -> Found:
    """Search, then sail the best gains and the boat's own on other seeds."""
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as progress:
        task = progress.add_task("", total=None)

        def sail(runs: list[Run]) -> list[Outcome]:
            left = [run for run in runs if run.number not in ledger.outcomes]
            progress.update(task, total=len(runs), completed=len(runs) - len(left))
            for outcome in crew.sail(left):
                ledger.add(outcome)
                progress.advance(task)
            return [ledger.outcomes[run.number] for run in runs]

        standings: list[Standing] = []
        progress.update(task, description=f"round 1 of {len(REACHES)}")
        for standing in search(trials, before, seed, sail, candidates):
            standings.append(standing)
            compared, ratio = len(standing.ratios), standing.ratios[0]
            console.print(
                f"round {standing.round}: best of {compared}: cost relative to baseline {ratio:.3f}"
            )
            progress.update(task, description=f"round {standing.round} of {len(REACHES)}")
        progress.update(task, description="check")
        return standings, _checked(trials, before, standings[-1].best, seed + 100, sail)


def _checked(trials: Trials, before: Gains, after: Gains, seed: int, sail: Sail) -> dict[str, list[Outcome]]:
    """Outcomes on seeds that the search has not seen."""
    seeds = range(seed, seed + _CHECK_SEEDS)
    checked = {"before": sail(trials.runs(before, seeds, _CHECK_AT))}
    same = after == before
    checked["after"] = checked["before"] if same else sail(trials.runs(after, seeds, 2 * _CHECK_AT))
    return checked


def _print(
    before: Gains, after: Gains, verdict: TuningVerdict, checked: dict[str, list[Outcome]], console: Console
) -> None:
    table = Table("", "before", "best found", box=None)
    for path in before:
        table.add_row(path, f"{before[path]:g}", f"{after[path]:g}")
    table.add_row("cost relative to baseline", "1", f"{verdict.ratio:.3f} ± {verdict.doubt:.3f}")
    for figure in _FIGURES:
        table.add_row(figure, *(_told(_mean(outcomes, figure)) for outcomes in checked.values()))
    console.print(table)
    if verdict.is_better:
        console.print(f"the gains found cost {1.0 - verdict.ratio:.0%} less")
    else:
        console.print("no gains were found that are better beyond doubt: the boat keeps its own")


def _as_json(
    boat: str,
    seed: int,
    before: Gains,
    best: Gains,
    verdict: TuningVerdict,
    checked: dict[str, list[Outcome]],
    path: Path,
) -> str:
    tree = {
        "boat": boat,
        "seed": seed,
        "before": before,
        "best": best,
        "is_better": verdict.is_better,
        "ratio": verdict.ratio,
        "doubt": verdict.doubt,
        "figures": {
            name: {figure: _mean(outcomes, figure) for figure in _FIGURES}
            for name, outcomes in checked.items()
        },
        "file": str(path),
    }
    return json.dumps(tree, indent=2)


def _mean(outcomes: list[Outcome], figure: str) -> float | None:
    """None where a run has no such figure."""
    values = [value for o in outcomes if isinstance(value := o.figures.get(figure), float)]
    return sum(values) / len(values) if len(values) == len(outcomes) else None


def _told(value: float | None) -> str:
    return "–" if value is None else f"{value:.3g}"


def _fingerprint(*parts: object) -> str:
    return hashlib.sha256(msgspec.json.encode(parts, order="deterministic")).hexdigest()
