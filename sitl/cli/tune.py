"""`boat-sitl tune`: PID gains for a boat, found by simulation."""

import hashlib
import json
from contextlib import closing
from pathlib import Path
from typing import Annotated

import msgspec
from rich.console import Console
from rich.table import Table

from companion.cli.command_line import Argument, Option, echo
from companion.cli.output_file import output_folder, write_text
from companion.core.errors import BoatError
from sitl.cli.arguments import Workers
from sitl.cli.progress import progress_bar
from sitl.experiments.campaign.campaign import Campaign
from sitl.experiments.mission_trial import run_mission
from sitl.experiments.result_log import ResultLog
from sitl.experiments.runner import TrialPool, cores, local_pool, run_trials
from sitl.experiments.trial import Trial, TrialResult
from sitl.experiments.tuning.picture import draw_search
from sitl.experiments.tuning.problem import Gains, TuningProblem, gains_of, parameter_file
from sitl.experiments.tuning.search import (
    CANDIDATES,
    REACHES,
    GainComparison,
    Ranking,
    compare,
    search,
)
from sitl.scenarios.scenario import load_scenario
from sitl.world.sampling import MOST_SEED

_CHECK_SEEDS = 8  # not those of the search
_CHECK_AT = 1_000_000  # the first number of these trials
_FIGURES = ("kept_rms_m", "kept_max_m", "overshoot_m", "command_travel_per_s", "time_s")


class TuneError(BoatError):
    """The boat does not complete the course."""


def tune(
    boat: Annotated[
        str, Argument(metavar="BOAT", help="lake, pool, kit, catamaran, rudder, or a boat's .toml file")
    ],
    out: Annotated[
        Path | None, Option("--out", "-o", metavar="DIR", help="where results go [out/tune-BOAT]")
    ] = None,
    workers: Workers = None,
    seed: Annotated[int, Option(least=0, most=MOST_SEED, help="of the search and its runs")] = 9001,
    candidates: Annotated[int, Option(least=4, most=100_000, help="sets of gains per round")] = CANDIDATES,
    as_json_text: Annotated[
        bool, Option("--json", help="gains, verdict and figures as JSON on stdout")
    ] = False,
) -> None:
    """Tune the gains of heading and speed, and write them as a parameter file.

    Compares sets of gains on a course of sharp and gentle corners, in still water and in currents, and
    searches closer around the best (successive halving). Then checks the best against the boat's own on
    seeds that the search did not use; gains that are not significantly better are rejected. After Ctrl-C the
    same command continues.

    A ground station loads tuned.parm; so does the boat, as params.parm in its storage folder. tuning.png
    shows the search. Exit code 1 if the boat does not complete the course with the gains that are written.

    Example:  boat-sitl tune lake -o out/tune-lake
    """
    console = Console(stderr=as_json_text, highlight=False, soft_wrap=True)
    model = boat if not boat.endswith(".toml") else str(Path(boat).resolve())
    scenario = load_scenario("open", [f"boat.model={model}"])
    folder = out or Path("out") / f"tune-{Path(boat).stem}"
    output_folder(folder)
    problem = TuningProblem(model, scenario.vehicle, scenario.frame, folder)
    before = gains_of(scenario.vehicle)
    parts = (boat, before, seed, candidates, scenario.hull, scenario.thrusters)
    fingerprint = hashlib.sha256(msgspec.json.encode(parts, order="deterministic")).hexdigest()
    plan = Campaign(f"tune {boat}", "tune", (), (), fingerprint)
    console.print(f"tune {boat}: search with seeds from {seed}, check with seeds from {seed + 100}")
    with closing(ResultLog(folder, plan)) as log, local_pool(workers or cores()) as pool:
        if log.results:
            console.print(f"{len(log.results)} runs are there from before")
        try:
            rankings, checked = _search_and_check(problem, before, seed, candidates, pool, log, console)
        except KeyboardInterrupt:
            console.print(f"{len(log.results)} runs are kept: the same command continues")
            raise
    best = rankings[-1].best
    verdict = compare(problem.ratios(checked["after"], checked["before"]))
    taken = best if verdict.is_better else before
    path = folder / "tuned.parm"
    word = "found" if verdict.is_better else "its own: no better ones were found"
    write_text(path, parameter_file(taken, [f"gains of {boat}, {word} with seed {seed}"]))
    draw_search(rankings, verdict, f"gains of {boat}", folder / "tuning.png")
    if not as_json_text:
        _print(before, best, verdict, checked, console)
        console.print(f"written: {path}, {folder / 'tuning.png'}")
    figures = _figures(boat, seed, before, best, verdict, checked, path)
    results = checked["after" if verdict.is_better else "before"]
    lost = sum(result.ended != "completed" for result in results)
    if lost:
        why = f"{lost} of {len(results)} runs with the gains in {path} are not completed"
        raise TuneError(why).with_figures(figures)
    if as_json_text:
        echo(json.dumps(figures, indent=2))


def _search_and_check(
    problem: TuningProblem,
    before: Gains,
    seed: int,
    candidates: int,
    pool: TrialPool,
    log: ResultLog,
    console: Console,
) -> tuple[list[Ranking], dict[str, list[TrialResult]]]:
    """Search, then sail with the best gains and those before on seeds that the search did not use."""
    title = ""

    def run(trials: list[Trial]) -> list[TrialResult]:
        done = sum(trial.number in log.results for trial in trials)
        with progress_bar(console, title, len(trials), done) as advance:
            return run_trials(pool, run_mission, trials, log, advance)

    rankings: list[Ranking] = []
    title = f"round 1 of {len(REACHES)}"
    for ranking in search(problem, before, seed, run, candidates):
        rankings.append(ranking)
        compared, ratio = len(ranking.ratios), ranking.ratios[0]
        console.print(f"round {ranking.round}: best of {compared}: cost relative to baseline {ratio:.3f}")
        title = f"round {ranking.round} of {len(REACHES)}"
    title = "check"
    best, seeds = rankings[-1].best, range(seed + 100, seed + 100 + _CHECK_SEEDS)
    checked = {"before": run(problem.trials(before, seeds, _CHECK_AT))}
    same = best == before
    checked["after"] = checked["before"] if same else run(problem.trials(best, seeds, 2 * _CHECK_AT))
    return rankings, checked


def _print(
    before: Gains,
    after: Gains,
    verdict: GainComparison,
    checked: dict[str, list[TrialResult]],
    console: Console,
) -> None:
    table = Table("", "before", "best found", box=None)
    for path in before:
        table.add_row(path, f"{before[path]:g}", f"{after[path]:g}")
    table.add_row("cost relative to baseline", "1", f"{verdict.ratio:.3f} ± {verdict.uncertainty:.3f}")
    for figure in _FIGURES:
        means = [_mean(results, figure) for results in checked.values()]
        table.add_row(figure, *("–" if mean is None else f"{mean:.3g}" for mean in means))
    console.print(table)
    if verdict.is_better:
        console.print(f"the gains found cost {1.0 - verdict.ratio:.0%} less")
    else:
        console.print("no gains were found that are better beyond uncertainty: the boat keeps its own")


def _figures(
    boat: str,
    seed: int,
    before: Gains,
    best: Gains,
    verdict: GainComparison,
    checked: dict[str, list[TrialResult]],
    path: Path,
) -> dict[str, object]:
    return {
        "boat": boat,
        "seed": seed,
        "before": before,
        "best": best,
        "is_better": verdict.is_better,
        "ratio": verdict.ratio,
        "doubt": verdict.uncertainty,
        "figures": {
            name: {figure: _mean(results, figure) for figure in _FIGURES} for name, results in checked.items()
        },
        "file": str(path),
    }


def _mean(results: list[TrialResult], figure: str) -> float | None:
    """None where a run has no such figure."""
    values = [value for o in results if isinstance(value := o.figures.get(figure), float)]
    return sum(values) / len(values) if len(values) == len(results) else None
