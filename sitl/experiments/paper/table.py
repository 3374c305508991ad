"""The paper's Table 3: by its own equations and from ground truth."""

import math
import statistics
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from sitl.experiments.paper.conditions import CASES, RUNS, Method
from sitl.experiments.trial import TrialResult

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
    """One case by one method, from ground truth, with sample standard deviations.

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


def rows(results: Sequence[TrialResult]) -> list[Row]:
    """The table's rows by case and method. A run that did not arrive counts with its length and time."""
    out = []
    for case in CASES:
        for method in Method:
            of_both = [
                one for one in results if one.figures["case"] == case and one.figures["method"] == method
            ]
            if of_both:
                out.append(_row(case, method, of_both))
    return out


def _row(case: str, method: Method, results: Sequence[TrialResult]) -> Row:
    lengths, times, off = (
        [result.value(name) for result in results] for name in ("length_m", "time_s", "off_plan_rms_m")
    )
    path_length_cm = equation_5_cm(statistics.fmean(times))
    return Row(
        case=case,
        method=str(method),
        runs=len(results),
        arrived=sum(bool(result.figures["arrived"]) for result in results),
        planned_m=results[0].value("planned_m"),
        length_mean_m=statistics.fmean(lengths),
        length_sd_m=_deviation(lengths),
        time_mean_s=statistics.fmean(times),
        time_sd_s=_deviation(times),
        collisions=round(sum(result.value("collisions") for result in results)),
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
"""The figures by which heading PID is compared with on/off steering."""


def reductions(
    table: Sequence[Row], against: Method = Method.ON_OFF, by: Method = Method.PID
) -> dict[str, dict[str, float]]:
    """By case and figure: the reduction by one method against the other; negative where it is larger."""
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
