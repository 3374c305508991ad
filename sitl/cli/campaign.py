"""`boat-sitl campaign`: many runs from one file, over all cores."""

import dataclasses
import json
from collections import Counter
from collections.abc import Sequence
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table as RichTable

from companion.core.errors import BoatError
from companion.core.output_file import write_text
from sitl.cli.arguments import Workers
from sitl.experiments.campaign.campaign import Campaign, load_campaign
from sitl.experiments.campaign.expect import ExpectationVerdict, judge
from sitl.experiments.campaign.ledger import Ledger
from sitl.experiments.campaign.run import Outcome
from sitl.experiments.campaign.table import tabulate, write_csv, write_parquet
from sitl.experiments.campaign.workers import Crew, cluster_crew, cores, local_crew
from sitl.reports.campaign_page import campaign_page

_MOST_ERRORS = 5


class CampaignError(BoatError):
    """The campaign is over and its figures are not what its file expects."""


def campaign(
    file: Annotated[Path, typer.Argument(metavar="FILE.toml", help="what is sailed and what varies")],
    out: Annotated[
        Path | None, typer.Option("--out", "-o", metavar="DIR", help="where results go [out/NAME]")
    ] = None,
    workers: Workers = None,
    scheduler: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="a Dask scheduler, as tcp://10.0.0.5:8786")
    ] = None,
    as_json_text: Annotated[
        bool, typer.Option("--json", help="verdicts and counts as JSON on stdout")
    ] = False,
) -> None:
    """Sail every run of a campaign file, tabulate them, and hold them to what the file expects.

    Writes runs.csv (and runs.parquet where pyarrow is installed) and report.html. Finished runs are kept in
    runs.jsonl: after Ctrl-C the same command goes on where it stopped. The table is the same to the byte for
    any number of workers. Exit code 1 if an expectation is not met.

    Example:  boat-sitl campaign examples/campaigns/courses_calm.toml -o out/calm
    """
    console = Console(stderr=as_json_text, highlight=False, soft_wrap=True)
    plan = load_campaign(file)
    folder = out or Path("out") / file.stem
    with Ledger(folder, plan) as ledger:
        crew = cluster_crew(scheduler) if scheduler is not None else local_crew(workers or cores())
        try:
            _sail(plan, ledger, crew, console)
        except KeyboardInterrupt:
            console.print(
                f"{len(ledger.outcomes)} of {len(plan.runs)} runs are kept: the same command goes on"
            )
            raise
        outcomes = ledger.in_order()
    table = tabulate(plan, outcomes)
    write_csv(table, folder / "runs.csv")
    write_parquet(table, folder / "runs.parquet")
    write_text(folder / "report.html", campaign_page(plan, outcomes))
    verdicts = judge(plan.expect, table)
    if as_json_text:
        typer.echo(_as_json(plan, outcomes, verdicts))
    else:
        _print(plan, outcomes, verdicts, console)
        console.print(f"written: {folder / 'runs.csv'}, {folder / 'report.html'}")
    unmet = sum(not verdict.is_met for verdict in verdicts)
    if unmet:
        raise CampaignError(f"{unmet} of {len(verdicts)} expectations are not met: see {folder}")


def _sail(plan: Campaign, ledger: Ledger, crew: AbstractContextManager[Crew], console: Console) -> None:
    """Whatever has not been sailed yet, with a progress bar where there is a person to see it."""
    left = [run for run in plan.runs if run.number not in ledger.outcomes]
    if not left:
        return
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as progress:
        task = progress.add_task(plan.title, total=len(plan.runs), completed=len(ledger.outcomes))
        with crew as sailors:
            for outcome in sailors.sail(left):
                ledger.add(outcome)
                progress.advance(task)


def _as_json(plan: Campaign, outcomes: Sequence[Outcome], verdicts: Sequence[ExpectationVerdict]) -> str:
    tree = {
        "title": plan.title,
        "runs": len(outcomes),
        "ended": Counter(outcome.ended for outcome in outcomes),
        "expectations": [dataclasses.asdict(verdict) for verdict in verdicts],
    }
    return json.dumps(tree, indent=2)


def _print(
    plan: Campaign, outcomes: Sequence[Outcome], verdicts: Sequence[ExpectationVerdict], console: Console
) -> None:
    ended = ", ".join(f"{count} {how}" for how, count in Counter(o.ended for o in outcomes).items())
    console.print(f"{plan.title}: {len(outcomes)} runs: {ended}")
    if verdicts:
        table = RichTable("expected", "over", "runs", "bound", "found", "", box=None)
        for verdict in verdicts:
            table.add_row(*verdict_cells(verdict))
        console.print(table)
    for outcome in [outcome for outcome in outcomes if outcome.ended == "error"][:_MOST_ERRORS]:
        console.print(f"run {outcome.number}: {outcome.why}")


def verdict_cells(verdict: ExpectationVerdict) -> tuple[str, ...]:
    """One verdict as the cells of a table."""
    value = f"{verdict.value:.4g}" if verdict.value is not None else f"missing in {verdict.missing}"
    word = "met" if verdict.is_met else "NOT MET"
    return verdict.what, verdict.group, str(verdict.runs), verdict.bound, value, word
