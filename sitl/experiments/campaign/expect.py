"""Expectations of a campaign's figures.

An expectation fails if any run lacks the figure, for example because it failed: a mean over the remaining
runs would be biased.
"""

import statistics
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import msgspec
from msgspec import field

from companion.config.section import Section

Row = Mapping[str, Any]
Statistic = Literal["mean", "median", "smallest", "largest", "deviation"]

STATISTICS: dict[str, Callable[[Sequence[float]], float]] = {
    "mean": statistics.fmean,
    "median": statistics.median,
    "smallest": min,
    "largest": max,
    "deviation": lambda values: statistics.stdev(values) if len(values) > 1 else 0.0,
}


class Expectation(Section, frozen=True):
    """A bound on a statistic of one figure, over the runs that `where` picks; with `each`, in every group.

    against: which runs to compare with, beside `where`; at_most_times: how many times their figure it may be.
    """

    figure: str
    of: Statistic = "mean"
    where: dict[str, Any] = field(default_factory=dict)
    each: str | tuple[str, ...] = ()
    at_least: float | None = None
    at_most: float | None = None
    against: dict[str, Any] = field(default_factory=dict)
    at_most_times: float | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        if (self.at_most_times is None) is bool(self.against):
            raise ValueError(f"figure {self.figure}: expected at_most_times and against together")
        if self.at_least is None and self.at_most is None and self.at_most_times is None:
            raise ValueError(f"figure {self.figure}: expected at_least, at_most or at_most_times")

    def groups(self, table: Sequence[Row]) -> dict[str, list[Row]]:
        """The runs that `where` picks, by group: the columns of `each` with their values."""
        each = (self.each,) if isinstance(self.each, str) else self.each
        groups: dict[str, list[Row]] = {}
        for row in table:
            if _fits(row, self.where):
                name = ", ".join(f"{column} {row.get(column)}" for column in each)
                groups.setdefault(name, []).append(row)
        return groups


@dataclass(frozen=True, slots=True)
class ExpectationVerdict:
    """One expectation in one group. value: None where some run lacks the figure."""

    what: str
    group: str
    bound: str
    value: float | None
    runs: int
    missing: int
    is_met: bool

    @property
    def found(self) -> str:
        """The value, or in how many runs it is missing, for tables."""
        return f"missing in {self.missing}" if self.value is None else f"{self.value:.4g}"


def judge(expectations: Sequence[Expectation], table: Sequence[Row]) -> list[ExpectationVerdict]:
    """Every expectation's verdicts, in order. table: one row a run, by column."""
    return [verdict for expectation in expectations for verdict in _verdicts(expectation, table)]


def _verdicts(expectation: Expectation, table: Sequence[Row]) -> list[ExpectationVerdict]:
    if expectation.at_most_times is not None:
        wanted = {**expectation.where, **expectation.against}
        base, _ = _value(expectation, [row for row in table if _fits(row, wanted)])
        if base is None:
            return [_verdict(expectation, "no run to compare with", [])]
        most = expectation.at_most_times * base
        expectation = msgspec.structs.replace(expectation, at_most=most, against={}, at_most_times=None)
    groups = expectation.groups(table)
    if not groups:
        return [_verdict(expectation, "no run is like this", [])]
    where = [f"{column} {value}" for column, value in expectation.where.items()]
    return [
        _verdict(expectation, ", ".join([*where, *filter(None, [name])]) or "all runs", rows)
        for name, rows in groups.items()
    ]


def numbers(figure: str, rows: Sequence[Row]) -> list[float]:
    """The figure of each row that has it."""
    return [float(value) for row in rows if isinstance(value := row.get(figure), bool | int | float)]


def _fits(row: Row, where: Mapping[str, Any]) -> bool:
    return all(
        row.get(column) in wanted if isinstance(wanted, list | tuple) else row.get(column) == wanted
        for column, wanted in where.items()
    )


def _verdict(expectation: Expectation, group: str, rows: Sequence[Row]) -> ExpectationVerdict:
    value, missing = _value(expectation, rows)
    low, high = expectation.at_least, expectation.at_most
    is_met = value is not None and (low is None or value >= low) and (high is None or value <= high)
    bounds = ([] if low is None else [f"≥ {low:g}"]) + ([] if high is None else [f"≤ {high:g}"])
    what = f"{expectation.of} {expectation.figure}"
    return ExpectationVerdict(what, group, ", ".join(bounds), value, len(rows), missing, is_met)


def _value(expectation: Expectation, rows: Sequence[Row]) -> tuple[float | None, int]:
    """The statistic, None where some run lacks the figure; how many lack it."""
    values = numbers(expectation.figure, rows)
    missing = len(rows) - len(values)
    return (STATISTICS[expectation.of](values) if values and not missing else None), missing
