"""The look of all pictures: charts, the reports of runs and campaigns, and figures of experiments."""

from collections.abc import Sequence
from typing import Any, Literal

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

Layout = Literal["constrained"]
GridAxis = Literal["both", "x", "y"]

BAND, KEEP_OUT, KEEP_OUT_TINT = "#94c1dd", "#c2413b", "#f6d5d0"
PLANNED, SAILED, INK, PAPER = "#cf3a2e", "#12395b", "#2b2b2b", "#fbf9f4"
FAULT = "#b3261e"
PLAN_STYLE: dict[str, Any] = {"color": PLANNED, "linewidth": 4.6, "alpha": 0.6, "dashes": (2.2, 1.1)}
HALO = [withStroke(linewidth=2.6, foreground="white", alpha=0.85)]
GRID = "#d8d2c4"


def new_figure(
    width_in: float,
    height_in: float,
    *,
    dpi: float = 100.0,
    layout: Layout | None = "constrained",
) -> Figure:
    """An empty figure that needs no screen. layout: as matplotlib has it, None for axes placed by hand."""
    figure = Figure(figsize=(width_in, height_in), dpi=dpi, facecolor=PAPER, layout=layout)
    FigureCanvasAgg(figure)
    return figure


def style_panel(axes: Axes, *, marker_scale: float = 1.0) -> None:
    """White ground, a thin grid, no frame at the top and right; a legend, if there is one, above it."""
    axes.tick_params(labelsize=8.5)
    style_axes(axes)
    if axes.get_legend_handles_labels()[0]:
        axes.legend(
            loc="lower right",
            bbox_to_anchor=(1.0, 0.98),
            fontsize=8,
            ncols=4,
            frameon=False,
            borderpad=0.1,
            markerscale=marker_scale,
        )


def style_axes(axes: Axes, *, grid: GridAxis = "both", without: Sequence[str] = ("top", "right")) -> None:
    """White ground, a thin grid, and no frame on the sides that are named."""
    axes.set_facecolor("white")
    axes.grid(axis=grid, color=GRID, linewidth=0.6)
    for side in without:
        axes.spines[side].set_visible(False)
