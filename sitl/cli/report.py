"""`boat-sitl report`: one page of HTML of a run or of a campaign."""

from pathlib import Path
from typing import Annotated

from companion.cli.command_line import Argument, Option, echo
from companion.cli.output_file import write_text
from sitl.experiments.result_log import ResultLog
from sitl.reports.campaign_page import campaign_page
from sitl.reports.run_page import run_page
from sitl.reports.run_record import load_record


def report(
    source: Annotated[
        Path,
        Argument(metavar="RUN|CAMPAIGN", help="what sail --record has written, or a campaign's folder"),
    ],
    out: Annotated[
        Path | None,
        Option("--out", "-o", metavar="FILE.html", help="the page [beside what it is about]"),
    ] = None,
) -> None:
    """Make one page of HTML, pictures included, of a run or of a campaign, finished or not.

    Example:  boat-sitl sail lake --record out/lake.npz && boat-sitl report out/lake.npz -o out/lake.html
    """
    remark = ""
    if source.is_dir():
        plan, results = ResultLog.read(source)
        text, beside = campaign_page(plan, results), source / "report.html"
        if len(results) < len(plan.runs):
            remark = f" (stopped early: {len(plan.runs) - len(results)} of {len(plan.runs)} runs are missing)"
    else:
        text, beside = run_page(load_record(source)), source.with_suffix(".html")
    page = out or beside
    write_text(page, text)
    echo(f"written: {page}{remark}")
