"""A campaign as a table with a row for each run, in order; equal campaigns give equal bytes."""

import csv
import importlib
import importlib.util
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from companion.cli.output_file import output_file
from sitl.experiments.campaign.campaign import Campaign
from sitl.experiments.trial import Trial, TrialResult

Table = list[dict[str, Any]]


def tabulate(campaign: Campaign, results: Sequence[TrialResult]) -> Table:
    """One dictionary a run: what it was, how it ended, its figures. Every row has every column."""
    runs = {run.number: run for run in campaign.runs}
    rows = [_row(runs[result.number], result) for result in results]
    columns = dict.fromkeys(column for row in rows for column in row)
    return [{column: row.get(column) for column in columns} for row in rows]


def _row(run: Trial, result: TrialResult) -> dict[str, Any]:
    named = {name: value for name in ("case", "course", "mission") if (value := getattr(run, name))}
    factors = {name: _plain(value) for name, value in run.factors.items()}
    ended = {"ended": result.ended, "completed": False, **result.figures}
    ended |= {"touched": "; ".join(result.touched), "why": result.why}
    return {"run": run.number, "scenario": run.scenario, **named, "seed": run.seed, **factors, **ended}


def write_csv(table: Table, path: Path) -> None:
    """Write the table; what is missing is empty. Raises OutputError: it cannot be written."""
    with output_file(path) as aside, aside.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(table[0] if table else ())
        writer.writerows([_cell(value) for value in row.values()] for row in table)


def write_parquet(table: Table, path: Path) -> bool:
    """Write the table as Parquet where pyarrow is installed; whether it was."""
    if importlib.util.find_spec("pyarrow") is None:
        return False
    arrow, parquet = importlib.import_module("pyarrow"), importlib.import_module("pyarrow.parquet")
    rows = [{name: _plain(value) for name, value in row.items()} for row in table]
    with output_file(path) as aside:
        parquet.write_table(arrow.Table.from_pylist(rows), aside)
    return True


def _cell(value: object) -> object:
    if isinstance(value, bool):
        return int(value)
    return f"{value:.9g}" if isinstance(value, float) else value


def _plain(value: object) -> object:
    """Lists and tables as text: a column has one type."""
    return value if value is None or isinstance(value, bool | int | float | str) else str(value)
