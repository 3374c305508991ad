"""`boat-sitl campaign`: the runs of a campaign file, on all cores."""

import dataclasses
import json
from collections import Counter
from collections.abc import Sequence
from contextlib import closing
from pathlib import Path
from typing import Annotated

from rich.console import Console
from rich.table import Table as RichTable

from companion.cli.command_line import Argument, Option, echo
from companion.cli.output_file import write_text
from companion.core.errors import BoatError
from sitl.cli.arguments import Workers
from sitl.cli.progress import progress_bar
from sitl.experiments.campaign.campaign import Campaign, load_campaign
from sitl.experiments.campaign.expect import ExpectationVerdict, judge
from sitl.experiments.campaign.table import tabulate, write_csv, write_parquet
from sitl.experiments.mission_trial import run_mission
from sitl.experiments.result_log import ResultLog
from sitl.experiments.runner import cluster_pool, cores, local_pool, run_trials
from sitl.experiments.trial import TrialResult
from sitl.reports.campaign_page import campaign_page

_MOST_ERRORS = 5


class CampaignError(BoatError):
    """The figures do not meet the expectations of the file."""


def campaign(
    file: Annotated[Path, Argument(metavar="FILE.toml", help="what is run and what varies")],
    out: Annotated[
        Path | None, Option("--out", "-o", metavar="DIR", help="where results go [out/NAME]")
    ] = None,
    workers: Workers = None,
    scheduler: Annotated[
        str | None, Option(metavar="ADDRESS", help="a Dask scheduler, as tcp://10.0.0.5:8786")
    ] = None,
    as_json_text: Annotated[bool, Option("--json", help="verdicts and counts as JSON on stdout")] = False,
) -> None:
    """Run every trial of a campaign file, tabulate the results, and check the file's expectations.

    Writes runs.csv (and runs.parquet where pyarrow is installed) and report.html. Finished runs are stored in
    runs.jsonl: after Ctrl-C the same command continues. The table does not depend on the number of workers,
    byte for byte. Exit code 1 if an expectation is not met.

    Example:  boat-sitl campaign examples/campaigns/courses_calm.toml -o out/calm
    """
    console = Console(stderr=as_json_text, highlight=False, soft_wrap=True)
    plan = load_campaign(file)
    folder = out or Path("out") / file.stem
    with closing(ResultLog(folder, plan)) as log:
        pool = cluster_pool(scheduler) if scheduler is not None else local_pool(workers or cores())
        bar = progress_bar(console, plan.title, len(plan.runs), len(log.results))
        try:
            with bar as advance, pool as trial_pool:
                results = run_trials(trial_pool, run_mission, plan.runs, log, advance)
        except KeyboardInterrupt:
            console.print(f"{len(log.results)} of {len(plan.runs)} runs are kept: the same command continues")
            raise
    table = tabulate(plan, results)
    write_csv(table, folder / "runs.csv")
    write_parquet(table, folder / "runs.parquet")
    write_text(folder / "report.html", campaign_page(plan, results))
    verdicts = judge(plan.expect, table)
    if not as_json_text:
        _print(plan, results, verdicts, console)
        console.print(f"written: {folder / 'runs.csv'}, {folder / 'report.html'}")
    figures = _figures(plan, results, verdicts)
    unmet = sum(not verdict.is_met for verdict in verdicts)
    if unmet:
        why = f"{unmet} of {len(verdicts)} expectations are not met: see {folder}"
        raise CampaignError(why).with_figures(figures)
    if as_json_text:
        echo(json.dumps(figures, indent=2))


def _figures(
    plan: Campaign, results: Sequence[TrialResult], verdicts: Sequence[ExpectationVerdict]
) -> dict[str, object]:
    return {
        "title": plan.title,
        "runs": len(results),
        "ended": Counter(result.ended for result in results),
        "expectations": [dataclasses.asdict(verdict) for verdict in verdicts],
    }


def _print(
    plan: Campaign, results: Sequence[TrialResult], verdicts: Sequence[ExpectationVerdict], console: Console
) -> None:
    ended = ", ".join(f"{count} {how}" for how, count in Counter(o.ended for o in results).items())
    console.print(f"{plan.title}: {len(results)} runs: {ended}")
    if verdicts:
        table = RichTable("expected", "over", "runs", "bound", "found", "", box=None)
        for verdict in verdicts:
            word = "met" if verdict.is_met else "NOT MET"
            table.add_row(verdict.what, verdict.group, str(verdict.runs), verdict.bound, verdict.found, word)
        console.print(table)
    for result in [result for result in results if result.ended == "error"][:_MOST_ERRORS]:
        console.print(f"run {result.number}: {result.why}")
