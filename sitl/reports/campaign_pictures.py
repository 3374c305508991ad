"""The pictures of a campaign: every run's figure by group, and where the boats went."""

import math
import textwrap
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from mission_tools.drawing.style import FAULT, INK, PLANNED, SAILED, new_figure, style_axes
from sitl.courses.courses import COURSES
from sitl.experiments.campaign.expect import Expectation, Row, numbers
from sitl.experiments.trial import TrialResult
from sitl.reports.labels import label, labelled

_MOST_GROUPS = 24
_MOST_TRACKS = 400
_NAME_COLUMNS = 44  # letters that fit over a small chart
_COLUMNS = 3


def draw_expectation(expectation: Expectation, table: Sequence[Row]) -> Figure | None:
    """A dot a run and a bar for each group's mean, against the bound. None where no run has the figure."""
    groups = [
        (name or "all runs", values)
        for name, rows in expectation.groups(table).items()
        if (values := numbers(expectation.figure, rows))
    ]
    if not groups:
        return None
    groups = groups[:_MOST_GROUPS]
    figure = new_figure(11.0, 0.42 * len(groups) + 1.5)
    axes = figure.subplots()
    for place, (_, values) in enumerate(groups):
        # Spread evenly over the row, in the runs' own order: a picture has no dice either.
        heights = place + 0.28 * np.sin(2.4 * np.arange(len(values)))
        axes.plot(values, heights, "o", ms=4.5, mfc=SAILED, mec="none", alpha=0.45)
        axes.plot(
            [np.mean(values)] * 2,
            [place - 0.36, place + 0.36],
            color=INK,
            linewidth=2.6,
            solid_capstyle="round",
        )
    bounds = [(expectation.at_most, "at most"), (expectation.at_least, "at least")]
    for bound, _ in bounds:
        if bound is not None:
            axes.axvline(bound, color=PLANNED, linewidth=1.4, linestyle="--")
    low, high = axes.get_xlim()
    for bound, word in bounds:
        if bound is not None:  # written towards the middle, where there is room
            axes.annotate(
                f"{word} {bound:g}", (bound, 1.0), xycoords=("data", "axes fraction"), xytext=(0, 3),
                textcoords="offset points", color=PLANNED, fontsize=9,
                ha="left" if bound < 0.5 * (low + high) else "right",
            )  # fmt: skip
    names = [_wrapped(f"{labelled(name)}  (n = {len(values)})") for name, values in groups]
    axes.set_yticks(range(len(groups)), names, fontsize=9)
    axes.set_ylim(len(groups) - 0.4, -0.6)
    axes.set_xlabel(label(expectation.figure), fontsize=9.5)
    style_axes(axes, grid="x", without=("top", "right", "left"))
    return figure


def _wrapped(text: str) -> str:
    """Over several lines, as a long name would be cut off."""
    return "\n".join(textwrap.wrap(text, _NAME_COLUMNS))


def draw_tracks(named: Sequence[tuple[str, Sequence[TrialResult]]]) -> Figure | None:
    """Small charts side by side, each with every track of one group laid over the next; equal axes."""
    named = [(name, [o for o in results if len(o.track) > 1]) for name, results in named]
    named = [(name, results) for name, results in named if results][: 2 * _COLUMNS]
    if not named:
        return None
    rows = math.ceil(len(named) / _COLUMNS)
    columns = min(len(named), _COLUMNS)
    figure = new_figure(12.0, 4.1 * rows, dpi=110)
    panels = figure.subplots(rows, columns, squeeze=False)
    for axes in panels.flat[len(named) :]:
        axes.set_axis_off()
    for axes, (name, results) in zip(panels.flat, named, strict=False):
        _draw_group(axes, name, results)
    return figure


def _draw_group(axes: Axes, name: str, results: Sequence[TrialResult]) -> None:
    axes.set_facecolor("#eaf3f8")
    course = COURSES.get(name.split(",", maxsplit=1)[0], ())
    if course:
        axes.plot(
            [p.east_m for p in course], [p.north_m for p in course], color=PLANNED, linewidth=1.2, alpha=0.7
        )
    for colour, picked in ((SAILED, True), (FAULT, False)):
        lines = [o.track for o in results[:_MOST_TRACKS] if (o.ended == "completed") is picked]
        axes.add_collection(
            LineCollection(lines, colors=colour, linewidths=0.9, alpha=max(0.2, 1.0 / len(results) ** 0.5))
        )
    axes.autoscale_view()
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_title(_wrapped(f"{labelled(name)}: {len(results)} runs"), fontsize=10, color=INK, loc="left")
    axes.tick_params(labelsize=7.5)
    axes.grid(color="white", linewidth=0.7)
    axes.set_xlabel("east, m", fontsize=8)
    axes.set_ylabel("north, m", fontsize=8)


def draw_clearances(table: Sequence[Row]) -> Figure | None:
    """How near the boats came to shore or obstacle, by the current; None on open water."""
    rows = [row for row in table if isinstance(row.get("min_clearance_m"), float)]
    if not rows:
        return None
    figure = new_figure(11.0, 4.2)
    axes = figure.subplots()
    for word, colour, is_faulty in (("no fault", SAILED, False), ("one fault", "#d08a2e", True)):
        picked = [row for row in rows if bool(row.get("fault")) is is_faulty]
        if picked:
            axes.plot(
                [row["current_m_s"] for row in picked], [row["min_clearance_m"] for row in picked], "o",
                ms=4.5, mec="none", mfc=colour, alpha=0.55, label=f"{word} (n = {len(picked)})",
            )  # fmt: skip
    touched = [row for row in rows if row.get("touched")]
    axes.plot(
        [row["current_m_s"] for row in touched], [row["min_clearance_m"] for row in touched], "x",
        color=FAULT, ms=8, mew=1.8, label=f"touched (n = {len(touched)})",
    )  # fmt: skip
    axes.set_ylim(bottom=-0.15)
    axes.set_xlabel("current, m/s", fontsize=9.5)
    axes.set_ylabel("nearest to shore or obstacle, m", fontsize=9.5)
    axes.legend(fontsize=9, frameon=False, loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=3)
    style_axes(axes)
    return figure
