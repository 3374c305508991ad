"""The paper's Table 3, twice: by its own equations, and by the true figures."""

import csv
import dataclasses
import math
import statistics
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from companion.core.output_file import output_file
from sitl.experiments.paper.conditions import CASES, RUNS, Method
from sitl.experiments.paper.trial import Trial

STEP_CM = 0.15  # the paper's d
STEPS_PER_S = 30.0  # the paper's n; its text says 31, its table was made with 30

PRINTED_CM = {
    "1": (261.0, 220.5),
    "2": (144.0, 127.35),
    "3": (97.2, 85.5),
    "4": (86.85, 78.3),
    "5": (82.8, 70.65),
}
"""Path lengths of the paper's Table 3, A* and A*+PID."""
PRINTED_S = {"1": (58.0, 49.0), "2": (32.0, 28.3), "3": (21.6, 19.0), "4": (19.3, 17.4), "5": (18.4, 15.7)}
"""Times of the paper's Table 3."""


def equation_5_cm(time_s: float) -> float:
    """ "Path length" PL = d · n · t: a running time in other units."""
    return STEP_CM * STEPS_PER_S * time_s


def equation_6_cm(path_length_cm: float) -> float:
    """ "Average path length": PL over the number of runs."""
    return path_length_cm / RUNS


def equation_7_cm(path_length_cm: float) -> float:
    """ "Standard deviation": |PL/12 − PL|."""
    return abs(equation_6_cm(path_length_cm) - path_length_cm)


@dataclass(frozen=True, slots=True)
class Row:
    """One case by one method: true figures over all runs; standard deviations are those of a sample.

    paper_*_cm: equations 5 to 7 of the mean time.
    """

    case: str
    method: str
    runs: int
    arrived: int
    planned_m: float
    length_mean_m: float
    length_sd_m: float
    time_mean_s: float
    time_sd_s: float
    collisions: int
    off_plan_rms_m: float
    paper_length_cm: float
    paper_average_cm: float
    paper_sd_cm: float


def rows(trials: Sequence[Trial]) -> list[Row]:
    """The table's rows, case by case, methods in their order.

    A run that never arrived counts with the way and the time that it had.
    """
    out = []
    for case in CASES:
        for method in Method:
            of_both = [trial for trial in trials if trial.case == case and trial.method == method]
            if of_both:
                out.append(_row(case, method, of_both))
    return out


def _row(case: str, method: Method, trials: Sequence[Trial]) -> Row:
    lengths, times = [trial.length_m for trial in trials], [trial.time_s for trial in trials]
    off = [trial.off_plan_rms_m for trial in trials]
    path_length_cm = equation_5_cm(statistics.fmean(times))
    return Row(
        case=case,
        method=str(method),
        runs=len(trials),
        arrived=sum(trial.arrived for trial in trials),
        planned_m=trials[0].planned_m,
        length_mean_m=statistics.fmean(lengths),
        length_sd_m=_deviation(lengths),
        time_mean_s=statistics.fmean(times),
        time_sd_s=_deviation(times),
        collisions=sum(trial.collisions for trial in trials),
        off_plan_rms_m=math.sqrt(statistics.fmean(rms * rms for rms in off)),
        paper_length_cm=path_length_cm,
        paper_average_cm=equation_6_cm(path_length_cm),
        paper_sd_cm=equation_7_cm(path_length_cm),
    )


def _deviation(values: Sequence[float]) -> float:
    return statistics.stdev(values) if len(values) > 1 else 0.0


FIGURES: dict[str, Callable[[Row], float]] = {
    "length": lambda row: row.length_mean_m,
    "length SD": lambda row: row.length_sd_m,
    "time": lambda row: row.time_mean_s,
    "time SD": lambda row: row.time_sd_s,
}
"""What heading PID is held against on/off steering in."""


def reductions(
    table: Sequence[Row], against: Method = Method.ON_OFF, by: Method = Method.PID
) -> dict[str, dict[str, float]]:
    """By case and figure: the share by which one method's figure is smaller than the other's, negative where
    it is larger.
    """
    found = {(row.case, row.method): row for row in table}
    out: dict[str, dict[str, float]] = {}
    for case in CASES:
        base, better = found.get((case, against)), found.get((case, by))
        if base is not None and better is not None:
            out[case] = {
                name: 1.0 - figure(better) / figure(base) if figure(base) else 0.0
                for name, figure in FIGURES.items()
            }
    return out


def markdown(table: Sequence[Row]) -> str:
    """Both tables and the reductions, for a document."""
    lines = [
        "By the paper's equations 5 to 7, from each case's mean time; in brackets its own figures (cm, s):",
        "",
        '| case | method | length (5) | time | average (6) | "SD" (7) |',
        "|---|---|---|---|---|---|",
    ]
    for row in table:
        column = {Method.ON_OFF: 0, Method.PID: 1}.get(Method(row.method))
        length = "" if column is None else f" ({PRINTED_CM[row.case][column]:g})"
        time = "" if column is None else f" ({PRINTED_S[row.case][column]:g})"
        lines.append(
            f"| {row.case} | {row.method} | {row.paper_length_cm:.1f}{length} | {row.time_mean_s:.1f}{time} "
            f"| {row.paper_average_cm:.2f} | {row.paper_sd_cm:.1f} |"
        )
    lines += [
        "",
        "True figures (cm, s), mean ± standard deviation over the runs; off plan: RMS distance to the plan:",
        "",
        "| case | method | plan | length | time | off plan | collisions | arrived |",
        "|---|---|---|---|---|---|---|---|",
    ]
    lines += [
        f"| {row.case} | {row.method} | {100 * row.planned_m:.1f} | {100 * row.length_mean_m:.1f} ± "
        f"{100 * row.length_sd_m:.1f} | {row.time_mean_s:.1f} ± {row.time_sd_s:.1f} "
        f"| {100 * row.off_plan_rms_m:.1f} | {row.collisions} | {row.arrived} of {row.runs} |"
        for row in table
    ]
    lines += [
        "",
        "How much smaller heading PID's figures are than on/off steering's (negative: larger):",
        "",
        f"| case | {' | '.join(FIGURES)} |",
        "|---" * (len(FIGURES) + 1) + "|",
    ]
    lines += [
        f"| {case} | {' | '.join(f'{100 * share:.1f} %' for share in shares.values())} |"
        for case, shares in reductions(table).items()
    ]
    return "\n".join(lines) + "\n"


def write_trials(path: Path, trials: Sequence[Trial]) -> None:
    """One row a run.

    Raises:
        OutputError: the file cannot be written.
    """
    _write(path, [dataclasses.asdict(trial) for trial in trials])


def write_rows(path: Path, table: Sequence[Row]) -> None:
    """One row a case and method.

    Raises:
        OutputError: the file cannot be written.
    """
    _write(path, [dataclasses.asdict(row) for row in table])


def _write(path: Path, records: Sequence[dict[str, object]]) -> None:
    with output_file(path) as aside, aside.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(records[0]))
        writer.writeheader()
        writer.writerows({key: _plain(value) for key, value in record.items()} for record in records)


def _plain(value: object) -> object:
    return f"{value:.6f}" if isinstance(value, float) else value
