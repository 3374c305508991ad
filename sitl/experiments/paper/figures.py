"""The paper's figures 5, 16, 17 and 18 from this simulation, and the tracks of all runs."""

import math
from collections.abc import Callable, Sequence
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from companion.core.geo import Point
from mission_tools.drawing.draw import draw_chart, save_figure
from mission_tools.drawing.features import arrange_names
from mission_tools.drawing.style import INK, new_figure
from sitl.experiments.paper.conditions import CASES, Method, conditions
from sitl.experiments.paper.run import planned
from sitl.experiments.paper.step_response import STEP_RAD, StepResponse
from sitl.experiments.paper.table import Row
from sitl.experiments.trial import TrialResult

COLOURS = {
    Method.ON_OFF: "#c0392b",
    Method.PID: "#1f6fb2",
    Method.PID_AHEAD: "#d08a1d",
    Method.LOS: "#2e8b57",
    Method.EXACT: "#8e6bbf",
}
CASE_COLOURS = dict(zip(CASES, ("#c0392b", "#1f6fb2", "#2e8b57", "#d08a1d", "#8e6bbf"), strict=True))
_DPI = 120
_NAME_M = 0.09  # of the chart to the east of the pool: the box's name ends there


def draw_step_responses(responses: Sequence[StepResponse], path: Path) -> None:
    """Fig. 5: one panel a gain set."""
    figure = new_figure(12.0, 4.2, dpi=_DPI)
    for column, response in enumerate(responses):
        axes = figure.add_subplot(1, len(responses), column + 1)
        kp, ki, kd = response.gains
        settled = "not settled" if response.settle_s is None else f"settles in {response.settle_s:.1f} s"
        axes.plot(
            response.times_s, [math.degrees(h) for h in response.headings_rad], color=COLOURS[Method.PID]
        )
        axes.axhline(math.degrees(STEP_RAD), color=INK, linewidth=0.8, linestyle="--")
        axes.set_title(f"({'abc'[column]}) Kp = {kp:g}, Ki = {ki:g}, Kd = {kd:g}", fontsize=11, color=INK)
        axes.set(xlabel="s after the step", ylim=(-5.0, 135.0), xlim=(0.0, response.times_s[-1]))
        axes.text(
            0.97, 0.06, f"overshoot {100 * response.overshoot:.0f} %\n{settled}", transform=axes.transAxes,
            ha="right", fontsize=9.5, color=INK,
        )  # fmt: skip
        axes.grid(alpha=0.3)
    figure.axes[0].set_ylabel("heading, °")
    _save(figure, path, "Heading after a step of 90° at cruise speed (the paper's Fig. 5)")


def draw_pool(path: Path) -> None:
    """Fig. 16: the pool, its obstacles, the five cases and their plans."""
    figure = new_figure(7.2, 11.5, dpi=_DPI)
    axes = figure.add_subplot(1, 1, 1)
    _pool(axes)
    for case in CASES:
        colour = CASE_COLOURS[case]
        for is_exact, style in ((False, "-"), (True, ":")):
            points = planned(case, is_exact)
            axes.plot(
                *_easts_norths(points), style, color=colour, linewidth=1.6, zorder=8,
                label=f"case {case}" if not is_exact else None,
            )  # fmt: skip
        start, goal = points[0], points[-1]
        axes.plot(start.east_m, start.north_m, "o", color=colour, markersize=9, mec="white", zorder=9)
        axes.plot(goal.east_m, goal.north_m, "*", color=colour, markersize=16, mec="white", zorder=9)
    axes.set(xlabel="x, m", ylabel="y, m")
    axes.legend(loc="upper left", fontsize=9, title="● start  ★ goal\n— A*   ⋯ exact")
    _save(figure, path, "The pool of 240 × 110 cm (Fig. 16)")


def draw_tracks(results: Sequence[TrialResult], path: Path) -> None:
    """Every run over its plan: a row a method, a column a case."""
    tracks: dict[tuple[object, object], list[TrialResult]] = {}
    for result in results:
        tracks.setdefault((result.figures["method"], result.figures["case"]), []).append(result)
    methods = [method for method in Method if any(method == key for key, _ in tracks)]
    figure = new_figure(2.5 * len(CASES) + 0.6, 5.1 * len(methods), dpi=_DPI)
    for row, method in enumerate(methods):
        for column, case in enumerate(CASES):
            axes = figure.add_subplot(len(methods), len(CASES), row * len(CASES) + column + 1)
            points = planned(case, method.is_exact)
            _pool(axes, points)
            axes.tick_params(labelleft=column == 0, labelsize=7)
            for result in tracks.get((method, case), ()):
                axes.plot(
                    *zip(*result.track, strict=True),
                    color=COLOURS[method],
                    linewidth=0.9,
                    alpha=0.6,
                    zorder=8,
                )
            axes.plot(*_easts_norths(points), "--", color=INK, linewidth=1.0, zorder=9)
            axes.set_title(f"{method}, case {case}", fontsize=10, color=INK)
    _save(figure, path, "True tracks of all runs over their plans")


def draw_deviations(table: Sequence[Row], path: Path) -> None:
    """Fig. 17: standard deviation by case; ours are of the true length, the paper's is its equation 7."""
    figure = new_figure(12.0, 4.8, dpi=_DPI)
    _bars(figure.add_subplot(1, 2, 1), table, lambda row: 100.0 * row.length_sd_m, "true length, SD, cm")
    _bars(figure.add_subplot(1, 2, 2), table, lambda row: row.paper_sd_cm, 'equation 7, "SD", cm')
    _save(figure, path, "Standard deviations (Fig. 17)")


def draw_lengths_and_times(table: Sequence[Row], path: Path) -> None:
    """Fig. 18: path length and time by case, with one standard deviation either way."""
    figure = new_figure(12.0, 4.8, dpi=_DPI)
    _bars(
        figure.add_subplot(1, 2, 1), table, lambda row: 100.0 * row.length_mean_m, "true length, cm",
        lambda row: 100.0 * row.length_sd_m,
    )  # fmt: skip
    _bars(
        figure.add_subplot(1, 2, 2), table, lambda row: row.time_mean_s, "time, s", lambda row: row.time_sd_s
    )
    _save(figure, path, "Path length and time (Fig. 18)")


def _bars(
    axes: Axes,
    table: Sequence[Row],
    value: Callable[[Row], float],
    label: str,
    spread: Callable[[Row], float] | None = None,
) -> None:
    methods = [method for method in Method if any(row.method == method for row in table)]
    width = 0.8 / len(methods)
    for number, method in enumerate(methods):
        rows = [row for row in table if row.method == method]
        at = [CASES.index(row.case) - 0.4 + (number + 0.5) * width for row in rows]
        axes.bar(
            at, [value(row) for row in rows], width * 0.92, color=COLOURS[method], label=str(method),
            yerr=[spread(row) for row in rows] if spread else None, error_kw={"linewidth": 1.0, "capsize": 2},
        )  # fmt: skip
    axes.set_xticks(range(len(CASES)), [f"case {case}" for case in CASES])
    axes.set_ylabel(label)
    axes.legend(fontsize=9)
    axes.grid(axis="y", alpha=0.3)


def _pool(axes: Axes, route: Sequence[Point] = ()) -> None:
    chart = conditions("1", 0).chart
    west, south, east, north = chart.water.bounds
    draw_chart(axes, chart, 0.0, route)
    axes.set(xlim=(west - 0.03, east + _NAME_M), ylim=(south - 0.03, north + 0.03), aspect="equal")


def _easts_norths(points: Sequence[Point]) -> tuple[list[float], list[float]]:
    return [point.east_m for point in points], [point.north_m for point in points]


def _save(figure: Figure, path: Path, title: str) -> None:
    figure.suptitle(title, fontsize=14, fontweight="bold", color=INK)
    figure.draw_without_rendering()  # names are arranged by where the layout has put the axes
    for axes in figure.axes:
        arrange_names(axes)
    save_figure(path, figure)
