"""The chart as a picture: tints, contours, numbers, what is not surveyed, and a map of the uncertainty."""

from itertools import pairwise
from typing import Any, Final

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from scipy.ndimage import distance_transform_edt
from scipy.spatial import cKDTree

from mission_tools.bathymetry.depth_chart import DepthChart
from mission_tools.bathymetry.products import contour_levels
from mission_tools.bathymetry.soundings import Floats
from mission_tools.drawing.draw import LAND, MAP_HEIGHT_IN, WIDTH_IN, Layout, draw_chart, finish, framed
from mission_tools.drawing.features import fill
from mission_tools.drawing.legend import View
from mission_tools.drawing.style import HALO, INK, KEEP_OUT, PAPER
from mission_tools.drawing.view import view_of

MAP_IN: Final = 9.0  # width of the map
SIDE_LEFT: Final = 0.775
TINTS: Final = LinearSegmentedColormap.from_list(
    "depth", ("#eaf5fa", "#bfe0ee", "#8cc3de", "#5b9fc8", "#3878ab", "#20558a", "#133c69")
)
STEPS: Final = (0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0)  # of the band's key, metres
HATCH: Final[dict[str, Any]] = {"facecolor": "#f4f4f2", "edgecolor": "#9a9a9a", "hatch": "////", "lw": 0.0}
CONTOUR, NUMBER = "#2f6690", "#12324f"
NUMBERS_ACROSS: Final = 26  # soundings printed along a picture's width, as dense as on a harbour plan


def draw_depths(chart: DepthChart) -> Figure:
    """One picture of 1600 × 1200 pixels: the map, and beside it the key, the figures and the band."""
    figures = chart.figures()
    layout = Layout(WIDTH_IN, MAP_IN, is_narrow=False)
    view = view_of(chart.chart, None, None, aspect=MAP_IN / MAP_HEIGHT_IN)
    said = f"Depths in metres below the datum; {figures['soundings']['accepted']:,} soundings"
    said += f", lines {figures['line_spacing_m']:.1f} m apart"
    figure, axes = framed(layout, view, chart.chart.name, said)
    levels = np.concatenate(([0.0], contour_levels(float(np.nanmax(chart.surface.depth_m)))))
    draw_chart(axes, chart.chart)
    norm = BoundaryNorm([*levels, levels[-1] + levels[1]], 256, clip=True)
    _fill_water(axes, chart, view, chart.surface.depth_m, TINTS, norm)
    _draw_contours(axes, chart, levels[1:])
    _draw_numbers(axes, chart, (view[2] - view[0]) / NUMBERS_ACROSS)
    fill(axes, chart.unknown, zorder=4, **HATCH)
    fill(axes, chart.gaps, facecolor="none", edgecolor=KEEP_OUT, linewidth=1.3, linestyle="--", zorder=5)
    finish(axes, chart.chart, view)
    entries = [
        Patch(facecolor=TINTS(norm(0.5 * (a + b))), edgecolor="#9fb8c8", lw=0.5, label=f"{a:g} – {b:g} m")
        for a, b in pairwise(levels)
    ]
    entries.append(Patch(facecolor=TINTS(norm(levels[-1] + 1e-6)), label=f"over {levels[-1]:g} m"))
    if not chart.unknown.is_empty:
        entries.append(Patch(label="not surveyed", **HATCH))
    if not chart.gaps.is_empty:
        entries.append(Patch(facecolor="none", edgecolor=KEEP_OUT, ls="--", label="gap to fill"))
    key = figure.legend(
        handles=entries, loc="upper left", bbox_to_anchor=(SIDE_LEFT, 0.9), fontsize=9.5, frameon=False,
        title="Depth", alignment="left", borderaxespad=0.0, handlelength=2.4,
    )  # fmt: skip
    key.get_title().set(fontweight="bold", fontsize=11)
    lines = (
        f"{figures['area_m2'] / 1e4:,.2f} ha, {figures['volume_m3']:,.0f} m³",
        f"mean {figures['mean_depth_m'] or 0.0:.2f} m, deepest {figures['max_depth_m']:.2f} m",
        f"90 % band: ± {figures['band_median_m']:.2f} m (median)",
        f"{100.0 * (figures['coverage'] or 0.0):.1f} % of the reachable water covered",
    )
    figure.text(SIDE_LEFT, 0.39, "\n".join(lines), fontsize=9.5, color=INK, va="bottom", linespacing=1.6)
    _draw_band(figure, chart, view)
    return figure


def _fill_water(axes: Axes, chart: DepthChart, view: View, values: Floats, tints: Any, norm: Any) -> None:  # noqa: ANN401
    """Tints over the whole grid, continued to the shore, below the land."""
    surface = chart.surface
    nearest = distance_transform_edt(np.isnan(values), return_distances=False, return_indices=True)
    whole = values[tuple(nearest)]
    rows, columns = whole.shape
    box = (
        surface.grid.west_m, surface.grid.west_m + columns * surface.grid.cell_m,
        surface.grid.north_m - rows * surface.grid.cell_m, surface.grid.north_m,
    )  # fmt: skip
    axes.imshow(whole, cmap=tints, norm=norm, extent=box, interpolation="bilinear", zorder=2, aspect="equal")
    land = shapely.box(*view).buffer(view[2] - view[0]).difference(chart.chart.water)
    if not chart.chart.is_open:
        fill(axes, land, facecolor=LAND, edgecolor="none", zorder=3)
    axes.set(xlim=view[::2], ylim=view[1::2])


def _draw_contours(axes: Axes, chart: DepthChart, levels: Floats) -> None:
    if not len(levels):
        return
    east, north = chart.surface.grid.middles
    widths = [1.3 if n % 5 == 4 else 0.7 for n in range(len(levels))]
    known = np.ma.masked_invalid(chart.surface.depth_m)
    lines = axes.contour(east, north, known, levels, colors=CONTOUR, linewidths=widths, zorder=3.2)
    for text in axes.clabel(lines, levels[1::2], fmt="%g", fontsize=7.5, inline_spacing=2):
        text.set(path_effects=HALO, zorder=3.4)


def _draw_numbers(axes: Axes, chart: DepthChart, apart_m: float) -> None:
    """Soundings as on a nautical chart: decimetres below the line, the shoalest first, thinned."""
    own = np.nonzero(chart.accepted)[0]
    order = own[np.argsort(chart.at.depth_m[own], kind="stable")]
    place = np.column_stack((chart.at.east_m, chart.at.north_m))
    clear = shapely.buffer(chart.chart.water, -0.5 * apart_m)
    order = order[shapely.contains_xy(clear, *place[order].T)]
    # of each small square the shoalest, then greedily those that keep their distance
    _, first = np.unique(np.floor(place[order] / (0.2 * apart_m)), axis=0, return_index=True)
    order = order[np.sort(first)]
    near = cKDTree(place[order]).query_ball_point(place[order], apart_m) if len(order) else []
    free = np.ones(len(order), dtype=bool)
    middle = 0.5 * float(np.nanmax(chart.surface.depth_m))  # where tints are darker than numbers may be
    for n, (row, others) in enumerate(zip(order.tolist(), near, strict=True)):
        if free[n]:
            free[others] = False
            whole, tenth = divmod(int(10.0 * max(chart.at.depth_m[row], 0.0)), 10)
            axes.text(
                place[row, 0], place[row, 1], f"${whole}_{{{tenth}}}$", fontsize=7.5, zorder=4, clip_on=True,
                color=NUMBER if chart.at.depth_m[row] < middle else "white", ha="center", va="center",
            )  # fmt: skip


def _draw_band(figure: Figure, chart: DepthChart, view: View) -> None:
    """How sure the depths are, as a small map below the key."""
    axes = figure.add_axes((SIDE_LEFT, 0.075, 0.205, 0.26))
    band = chart.surface.band_m
    step = next((s for s in STEPS if 6.0 * s >= np.nanquantile(band, 0.98)), STEPS[-1])
    norm = BoundaryNorm(step * np.arange(7), 256, clip=True)
    _fill_water(axes, chart, view, band, "YlOrBr", norm)
    fill(axes, chart.unknown, zorder=4, **HATCH)
    axes.set(xticks=[], yticks=[], facecolor=PAPER)
    axes.set_title("Uncertainty: half of the 90 % band", fontsize=9.5, loc="left", fontweight="bold")
    shown = figure.colorbar(axes.images[0], ax=axes, orientation="horizontal", fraction=0.06, pad=0.04)
    shown.set_label("m", fontsize=8.5)
    shown.ax.tick_params(labelsize=7.5)
    shown.ax.xaxis.set_major_formatter("{x:g}")
