"""A campaign as a page: verdicts, figures by group, pictures, and the runs to look at."""

import json
import shlex
from collections import Counter
from collections.abc import Sequence
from statistics import fmean
from typing import Any

import msgspec

from mission_tools.drawing.report_page import Mark, Page
from sitl.experiments.campaign.campaign import Campaign, leaves
from sitl.experiments.campaign.expect import judge, numbers
from sitl.experiments.campaign.table import Table, tabulate
from sitl.experiments.mission_trial import scenario_of
from sitl.experiments.trial import Trial, TrialResult
from sitl.reports.campaign_pictures import draw_clearances, draw_expectation, draw_tracks
from sitl.reports.labels import label, labelled

_MOST_LISTED = 200
_GROUPED = (
    "completed",
    "time_s",
    "cross_track_rms_m",
    "cross_track_max_m",
    "overshoot_m",
    "cut_m",
    "station_near_share",
    "station_95_m",
    "min_clearance_m",
    "touches",
)


def campaign_page(plan: Campaign, results: Sequence[TrialResult]) -> str:
    """The page, as HTML."""
    table = tabulate(plan, results)
    ended = Counter(result.ended for result in results)
    touching = sum(bool(result.touched) for result in results)
    page = Page(plan.title, f"{len(results)} of {len(plan.runs)} runs of {plan.source}")
    missing = len(plan.runs) - len(results)
    if missing:
        page.warning(
            f"Stopped early: {missing} of {len(plan.runs)} runs are missing, and all figures are of those "
            f"that are finished. The command that began the campaign continues it."
        )
    tiles = [(how, str(count)) for how, count in sorted(ended.items())]
    tiles += [("missing", str(missing))] if missing else []
    page.tiles([*tiles, ("touched something", str(touching))])
    _expectations(page, plan, table)
    _groups(page, plan, results, table)
    clearances = draw_clearances(table)
    if clearances is not None:
        page.heading("Clearance")
        page.picture(clearances, "A dot a run.")
    _runs_to_look_at(page, plan, results, table)
    page.heading("What was sailed")
    page.details("the first run", msgspec.json.format(msgspec.json.encode(plan.runs[0])).decode())
    return page.render()


def _expectations(page: Page, plan: Campaign, table: Table) -> None:
    verdicts = judge(plan.expect, table)
    if not verdicts:
        return
    so_far = " so far" if len(table) < len(plan.runs) else ""
    page.heading("Expectations")
    marks: list[Mark] = ["good" if verdict.is_met else "bad" for verdict in verdicts]
    rows = [
        (
            labelled(verdict.what),
            labelled(verdict.group),
            verdict.runs,
            verdict.bound,
            verdict.found,
            f"met{so_far}" if verdict.is_met else f"not met{so_far}",
        )
        for verdict in verdicts
    ]
    page.table(("expected", "over", "runs", "bound", "found", ""), rows, marks)
    for expectation in plan.expect:
        if expectation.figure != "completed":
            figure = draw_expectation(expectation, table)
            if figure is not None:
                where = ", ".join(f"{label(column)} {value}" for column, value in expectation.where.items())
                caption = f"{label(expectation.figure)}{where and f', {where}'}: a dot a run, a bar the mean."
                page.picture(figure, caption)


def _groups(page: Page, plan: Campaign, results: Sequence[TrialResult], table: Table) -> None:
    """Means by what varies in few steps: voyages, and settings of a grid."""
    columns = [
        name for name in ("scenario", "case", "course", "mission", *plan.factors) if _is_grouping(name, table)
    ]
    figures = [name for name in _GROUPED if any(row.get(name) is not None for row in table)]
    groups: dict[tuple[Any, ...], list[int]] = {}
    for number, row in enumerate(table):
        groups.setdefault(tuple(row.get(name) for name in columns), []).append(number)
    page.heading("Means")
    page.table(
        [*map(label, columns), "runs", *map(label, figures)],
        [
            (*key, len(members), *(_mean(f, [table[n] for n in members]) for f in figures))
            for key, members in groups.items()
        ],
    )
    tracks = draw_tracks(
        [
            (", ".join(str(value) for value in key) or plan.title, [results[n] for n in members])
            for key, members in groups.items()
        ]
    )
    if tracks is not None:
        page.heading("Tracks")
        page.picture(tracks, "The true tracks, laid over each other; red: not completed.", is_vector=False)


def _runs_to_look_at(page: Page, plan: Campaign, results: Sequence[TrialResult], table: Table) -> None:
    """Runs that touched something or did not complete, each with its fault and how to sail it again."""
    runs = {run.number: run for run in plan.runs}
    odd = [
        (runs[result.number], result, row)
        for result, row in zip(results, table, strict=True)
        if result.touched or result.ended != "completed"
    ]
    page.heading("Runs to look at")
    if not odd:
        missing = len(plan.runs) - len(results)
        which = f"every run that was sailed ({missing} are missing)" if missing else "every run"
        page.paragraph(f"None: {which} was completed, and nothing was touched.")
        return
    by_fault = Counter(str(row.get("fault") or "none") for _, result, row in odd if result.touched)
    if by_fault:
        page.paragraph("Touched, by fault: " + ", ".join(f"{what} {n}" for what, n in by_fault.most_common()))
    marks: list[Mark] = ["bad" if result.touched or result.ended == "error" else "" for _, result, _ in odd]
    page.table(
        ("run", "ended", "fault", "touched", "inevitable", "why", "again"),
        [
            (
                run.number,
                result.ended,
                row.get("fault") or "",
                "; ".join(result.touched),
                row.get("inevitable") or "",
                result.why,
                again(run),
            )
            for run, result, row in odd[:_MOST_LISTED]
        ],
        marks[:_MOST_LISTED],
    )
    for run, result, _ in odd[:_MOST_LISTED]:
        if result.traceback:
            page.details(f"run {run.number}: traceback", result.traceback)


def again(run: Trial) -> str:
    """The command that sails a run once more."""
    words = ["boat-sitl", "sail", run.scenario, "--seed", str(run.seed)]
    words += ["--case", run.case] if run.case else []
    words += ["--course", run.course] if run.course else []
    words += ["--mission", run.mission] if run.mission else []
    words += ["--fence"] if run.fence else []
    words += ["--linger", f"{run.linger_s:g}"] if run.linger_s else []
    drawn: list[tuple[str, Any]] = []
    if run.below:  # the waves of its seed, unless the scenario has its own
        sea = scenario_of(run).environment
        drawn = [(f"environment.{name}", getattr(sea, name)) for name in run.below["environment"]]
    for key, value in [*leaves(run.settings), *drawn]:
        words += ["--set", f"{key}={json.dumps(value)}"]
    return shlex.join(words)


def _is_grouping(name: str, table: Table) -> bool:
    values = {str(row.get(name)) for row in table}
    return name in table[0] and 1 < len(values) <= 12 if table else False


def _mean(figure: str, rows: Table) -> float | None:
    values = numbers(figure, rows)
    return fmean(values) if values else None
