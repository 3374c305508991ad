"""A chart as one self-contained page: picture, figures, profile, differences at crossings, rejections."""

from collections.abc import Mapping
from itertools import pairwise
from typing import Any, Final

import numpy as np
import shapely
from matplotlib.figure import Figure

from mission_tools.bathymetry.blocks import along_track_m
from mission_tools.bathymetry.crossings import GAP_M, LEAST
from mission_tools.bathymetry.depth_chart import DepthChart
from mission_tools.bathymetry.picture import CONTOUR
from mission_tools.bathymetry.s44 import ORDERS, tvu_m
from mission_tools.bathymetry.soundings import Floats
from mission_tools.drawing.report_page import Page
from mission_tools.drawing.style import FAULT, PLAN_STYLE, SAILED, new_figure, style_panel
from mission_tools.maps.projection import local_coordinates

WIDE_IN: Final = (9.0, 3.4)


def chart_page(chart: DepthChart, figures: Mapping[str, Any], picture: Figure) -> str:
    """The page, as HTML. figures: of `DepthChart.figures`; picture: of `draw_depths`."""
    page = Page(f"Depth chart: {chart.chart.name}", ", ".join(chart.soundings.names))
    page.tiles(_tiles(figures))
    page.picture(picture, "Depths below the datum, and how sure they are.", is_vector=False)
    page.heading("How good is it?")
    share, order = figures["within_order"][figures["order"]], figures["order"]
    if share is None or figures["crossings"] < LEAST:
        page.warning("Hardly a track crosses another: nothing checks the survey. Sail lines across.")
    else:
        verdict = "meets" if figures["meets_order"] else "does not meet"
        page.paragraph(
            f"{100 * share:.1f} % of {figures['crossings']} crossings of tracks differ by no more than IHO "
            f"S-44 order {order} allows at 95 %: the survey {verdict} its vertical limit."
        )
        page.picture(_histogram(chart, order), "Later less earlier depth where tracks cross.")
    rows = [
        (name, _percent(figures["within_order"][name]), f"{a_m} m", b) for name, (a_m, b) in ORDERS.items()
    ]
    page.table(("S-44 order", "crossings within", "a", "b"), rows)
    page.heading("Profile along the longest track")
    page.picture(_profile(chart), "Soundings, and the band of the chart below the track.")
    lines = _planned(chart)
    if not lines.is_empty:
        page.heading("Plan and track")
        page.picture(*_plan_and_track(chart, lines), is_vector=False)
    page.heading("How much water is how deep?")
    page.picture(_hypsography(chart), "Area of the lake at least as deep as this.")
    page.heading("Soundings")
    page.table(("", "soundings"), [(name, n) for name, n in figures["soundings"].items() if n])
    page.heading("All figures")
    flat = {key: value for key, value in figures.items() if not isinstance(value, dict | list)}
    page.table(("figure", "value"), [(key, _said(value)) for key, value in flat.items()])
    return page.render()


def _tiles(figures: Mapping[str, Any]) -> list[tuple[str, str]]:
    share = figures["within_order"][figures["order"]]
    return [
        ("volume", f"{figures['volume_m3']:,.0f} m³"),
        ("area", f"{figures['area_m2'] / 1e4:,.2f} ha"),
        ("mean depth", f"{figures['mean_depth_m'] or 0.0:.2f} m"),
        ("deepest", f"{figures['max_depth_m']:.2f} m"),
        ("half of the 90 % band, median", f"± {figures['band_median_m']:.2f} m"),
        ("covered", _percent(figures["coverage"])),
        (f"crossings within S-44 {figures['order']}", _percent(share)),
    ]


def _percent(share: float | None) -> str:
    return "–" if share is None else f"{100.0 * share:.1f} %"


def _said(value: object) -> str:
    return f"{value:,.10g}" if isinstance(value, float) else str("–" if value is None else value)


def _histogram(chart: DepthChart, order: str) -> Figure:
    figure = new_figure(*WIDE_IN)
    axes = figure.add_subplot()
    crossed = chart.crossings
    allowed = float(np.median(tvu_m(order, crossed.depth_m)))
    edge = 1.1 * max(allowed, float(np.abs(crossed.difference_m).max()))
    axes.hist(crossed.difference_m, bins=41, range=(-edge, edge), color=CONTOUR)
    for side in (-allowed, allowed):
        axes.axvline(side, color=FAULT, ls="--", lw=1.2, label=f"S-44 order {order}" if side > 0 else None)
    axes.set(xlabel="difference, m", ylabel="crossings")
    style_panel(axes)
    return figure


def _profile(chart: DepthChart) -> Figure:
    """Along the longest piece of track without a turn back: the longest run of one course."""
    figure = new_figure(*WIDE_IN)
    axes = figure.add_subplot()
    rows = np.nonzero(np.isfinite(chart.at.east_m))[0]
    east, north = chart.at.east_m[rows], chart.at.north_m[rows]
    step = np.hypot(np.diff(east), np.diff(north))
    own = max(
        _straight_runs(chart.soundings.heading_rad[rows], step),
        key=lambda part: step[part.start : part.stop - 1].sum(),
    )
    along = along_track_m(east, north)[own]
    along, depth = along - along[0], chart.at.depth_m[rows][own]
    good = chart.accepted[rows][own]
    surface = chart.surface
    row, column = surface.grid.cells(east[own], north[own])
    middle, band = surface.depth_m[row, column], surface.band_m[row, column]
    axes.plot(along[good], depth[good], ".", ms=3, color=SAILED, label="accepted")
    axes.plot(along[~good], depth[~good], "x", ms=4, color=FAULT, label="rejected")
    axes.fill_between(along, middle - band, middle + band, color=CONTOUR, alpha=0.35, lw=0, label="90 % band")
    axes.set(xlabel="along the track, m", ylabel="depth, m")
    axes.invert_yaxis()
    style_panel(axes)
    return figure


def _planned(chart: DepthChart) -> shapely.MultiLineString:
    """The missions in the logs, in the chart's frame."""
    plans = [plan[:, ::-1] for plan in chart.soundings.plans if len(plan) > 1]
    return shapely.MultiLineString([local_coordinates(plan, chart.chart.frame.origin) for plan in plans])


def _plan_and_track(chart: DepthChart, lines: shapely.MultiLineString) -> tuple[Figure, str]:
    """Both, and how far soundings are off the lines of the plan."""
    figure = new_figure(WIDE_IN[0], 6.0)
    axes = figure.add_subplot()
    east, north = chart.at.east_m[chart.accepted], chart.at.north_m[chart.accepted]
    for number, line in enumerate(shapely.get_parts(lines)):
        axes.plot(*shapely.get_coordinates(line).T, **PLAN_STYLE, label=None if number else "plan")
    axes.plot(east, north, ".", ms=1.5, color=SAILED, label="soundings")
    axes.set(xlabel="east, m", ylabel="north, m", aspect="equal")
    style_panel(axes, marker_scale=4.0)
    shapely.prepare(lines)
    off_m = shapely.distance(lines, shapely.points(east, north))
    rms_m, most_m = float(np.sqrt(np.mean(off_m**2))), float(np.quantile(off_m, 0.95))
    said = f"By the boat's own position, soundings are {rms_m:.2f} m RMS off the plan's lines"
    return figure, f"{said}, 95 % within {most_m:.2f} m."


def _straight_runs(heading_rad: Floats, step_m: Floats) -> list[slice]:
    """Stretches without a gap and without a turn of 30° within ten soundings."""
    heading = np.unwrap(np.nan_to_num(heading_rad))
    turns = np.abs(heading[10:] - heading[:-10]) > np.pi / 6
    cuts = np.union1d(np.nonzero(turns)[0] + 5, np.nonzero(step_m > GAP_M)[0] + 1).tolist()
    return [slice(a, b) for a, b in pairwise([0, *cuts, len(heading)])]


def _hypsography(chart: DepthChart) -> Figure:
    figure = new_figure(*WIDE_IN)
    axes = figure.add_subplot()
    depths, areas = chart.hypsography()
    axes.fill_betweenx(depths, areas / 1e4, color=CONTOUR, alpha=0.35, lw=0)
    axes.plot(areas / 1e4, depths, color=SAILED)
    axes.set(xlabel="area, ha", ylabel="depth, m", xlim=(0.0, None), ylim=(depths[-1], 0.0))
    style_panel(axes)
    return figure
