"""Charts, plans and tracks as pictures in the style of a nautical chart.

Axes are east and north in metres of the chart's frame.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import cycle, pairwise
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from shapely.geometry import MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from companion.cli.output_file import output_file
from companion.core.geo import Point
from mission_tools.drawing.features import (
    LAND_EDGE,
    MANY,
    arrange_names,
    draw_feature,
    draw_lengths,
    draw_tightest,
    draw_waypoints,
    fill,
)
from mission_tools.drawing.legend import View, draw_frame, draw_legend, draw_north_arrow, draw_scale_bar
from mission_tools.drawing.style import BAND, INK, PLAN_STYLE, SAILED, new_figure
from mission_tools.drawing.view import PART_COLOURS, view_of
from mission_tools.maps.chart import Chart
from mission_tools.overwrite_guard import PICTURE_METADATA
from mission_tools.tasks.survey.survey import Survey
from mission_tools.tasks.task_route import Parts

LAND, WATER = "#efe6cf", "#b7daeb"
WIDTH_IN, HEIGHT_IN = 12.8, 9.6  # of a picture; 125 pixels an inch
LEFT_IN, BOTTOM_IN = 0.576, 0.432  # where its map begins
MAP_WIDTH_IN, MAP_HEIGHT_IN = 11.84, 8.208
LEGEND_IN = 3.1  # beside a narrow map
NARROW_IN = WIDTH_IN - LEFT_IN - LEGEND_IN - 2.0  # a map narrower than this would have more land than water
LEAST_MAP_IN = 3.4  # room for scale bar and north arrow
TINTS = ((0.006, "#c0dfee"), (0.014, "#c9e4f0"), (0.026, "#d1e8f3"), (0.042, "#d9ecf6"))


def draw_chart(axes: Axes, chart: Chart, clearance_m: float = 0.0, route: Sequence[Point] = ()) -> None:
    """Land, water, the band nearer to shores than the clearance, and every feature with its name.

    Names of small things are put on the side away from the route.
    """
    axes.set_facecolor(WATER if chart.is_open else LAND)
    if not chart.is_open:
        fill(axes, chart.water, facecolor=WATER, edgecolor="none", zorder=1)
    if clearance_m > 0.0 and not chart.shores.is_empty:
        band = chart.shores.buffer(clearance_m, quad_segs=6).intersection(chart.water)
        fill(axes, band, facecolor=BAND, edgecolor="none", zorder=2)
    if not chart.is_open:
        fill(axes, chart.water, facecolor="none", edgecolor=LAND_EDGE, linewidth=1.1, zorder=4)
    for feature in chart.features:
        draw_feature(axes, chart, feature, route)


def draw_route(axes: Axes, route: Sequence[Point]) -> None:
    """The planned line, dashed; thinner where it has many legs."""
    east, north = _columns(route)
    style = PLAN_STYLE if len(route) <= MANY else PLAN_STYLE | {"linewidth": 2.0, "alpha": 0.8}
    axes.plot(east, north, zorder=8, **style)


def draw_parts(axes: Axes, parts: Parts) -> None:
    """Each part of a route in a colour of its own, which the legend explains."""
    for (words, points), colour in zip(parts, cycle(PART_COLOURS), strict=False):
        axes.plot(*_columns(points), color=colour, label=words, zorder=8)


def draw_track(
    axes: Axes, track: Sequence[Point], speeds_m_s: Sequence[float] | None = None
) -> LineCollection | None:
    """Where the boat sailed. With speeds, one for each point, it is coloured; the line for a colour bar."""
    east, north = _columns(track)
    if speeds_m_s is None:
        axes.plot(east, north, color=SAILED, linewidth=1.7, zorder=10, solid_capstyle="round")
        return None
    segments = [[(a.east_m, a.north_m), (b.east_m, b.north_m)] for a, b in pairwise(track)]
    line = LineCollection(segments, cmap="viridis", linewidths=2.4, zorder=10, capstyle="round")
    line.set_array(np.asarray(speeds_m_s[: len(segments)], dtype=np.float64))
    axes.add_collection(line, autolim=False)
    return line


def save_figure(path: Path, figure: Figure) -> None:
    """Write a figure; the suffix of path chooses the format. Raises OutputError: it cannot be written."""
    with output_file(path) as aside:
        figure.savefig(aside, metadata=PICTURE_METADATA.get(path.suffix.lower()))


def draw_picture(
    chart: Chart,
    route: Sequence[Point] | None = None,
    track: Sequence[Point] | None = None,
    *,
    title: str = "",
    subtitle: str = "",
    clearance_m: float = 0.0,
    speeds_m_s: Sequence[float] | None = None,
    parts: Parts = (),
) -> Figure:
    """One picture of 1600 × 1200 pixels, with a legend; a narrow chart's is narrower.

    route is the planned line with its waypoints. The band nearer to shores than clearance_m is tinted. The
    view is the whole chart, or the surroundings of route and track where those are far smaller. parts: of the
    route, each in a colour of its own.
    """
    layout = Layout.of(view_of(chart, route, track))
    view = view_of(chart, route, track, aspect=layout.map_in / MAP_HEIGHT_IN)
    figure, axes = framed(layout, view, title or chart.name, subtitle)
    _draw_tints(axes, chart, view[2] - view[0])
    draw_chart(axes, chart, clearance_m, route or track or ())
    _draw_water_name(axes, chart, route, track, view)
    draw_parts(axes, parts)
    if route is not None and not parts:
        draw_route(axes, route)
    line = draw_track(axes, track, speeds_m_s) if track else None
    if route:
        draw_waypoints(axes, route)
        draw_lengths(axes, route)
        draw_tightest(axes, chart, route)
    elif track:
        draw_waypoints(axes, (track[0], track[-1]))
    finish(axes, chart, view)
    is_beside = layout.is_narrow
    draw_legend(
        axes, chart, clearance_m, route is not None, bool(track) and line is None, is_beside=is_beside
    )
    if line is not None:
        place = layout.box(LEFT_IN + layout.map_in + 0.3, BOTTOM_IN + 7.6, 2.3, 0.15) if is_beside else None
        cax = axes.inset_axes((0.025, 0.945, 0.2, 0.018)) if place is None else figure.add_axes(place)
        bar = figure.colorbar(line, cax=cax, orientation="horizontal")
        bar.set_label("speed over ground, m/s", fontsize=9)
        bar.ax.tick_params(labelsize=8)
    return figure


@dataclass(frozen=True, slots=True)
class Layout:
    """Where a picture's parts lie, in inches: a narrow chart has its legend beside it."""

    width_in: float
    map_in: float
    is_narrow: bool

    @classmethod
    def of(cls, view: View) -> "Layout":
        """The layout for what is shown."""
        map_in = MAP_HEIGHT_IN * (view[2] - view[0]) / (view[3] - view[1])
        if map_in >= NARROW_IN:
            return cls(WIDTH_IN, MAP_WIDTH_IN, is_narrow=False)
        map_in = max(map_in, LEAST_MAP_IN)
        return cls(LEFT_IN + map_in + LEGEND_IN, map_in, is_narrow=True)

    def box(
        self, left_in: float, bottom_in: float, width_in: float, height_in: float
    ) -> tuple[float, float, float, float]:
        """A rectangle as shares of the figure."""
        return (
            left_in / self.width_in,
            bottom_in / HEIGHT_IN,
            width_in / self.width_in,
            height_in / HEIGHT_IN,
        )


def framed(layout: Layout, view: View, title: str, subtitle: str) -> tuple[Figure, Axes]:
    """A figure with its titles, and the axes of its map."""
    figure = new_figure(layout.width_in, HEIGHT_IN, dpi=125, layout=None)
    axes = figure.add_axes(layout.box(LEFT_IN, BOTTOM_IN, layout.map_in, MAP_HEIGHT_IN))
    west, south, east, north = view
    axes.set(xlim=(west, east), ylim=(south, north), aspect="equal")
    left = LEFT_IN / layout.width_in
    figure.text(left, 0.952, title, fontsize=21, fontweight="bold", color=INK)
    figure.text(left, 0.918, subtitle, fontsize=11.5, color="#5a5a5a")
    return figure, axes


def finish(axes: Axes, chart: Chart, view: View) -> None:
    """What is drawn over every map."""
    arrange_names(axes)
    draw_frame(axes, chart, view)
    draw_scale_bar(axes, view)
    draw_north_arrow(axes)


def _columns(points: Sequence[Point]) -> tuple[list[float], list[float]]:
    return [point.east_m for point in points], [point.north_m for point in points]


def _draw_tints(axes: Axes, chart: Chart, width_m: float) -> None:
    """Tints that grow lighter from the shore, as on printed lake maps; decoration, not depths."""
    if chart.is_open:
        return
    for share, tint in TINTS:
        fill(axes, chart.water.buffer(-share * width_m), facecolor=tint, edgecolor="none", zorder=1.5)


def _draw_water_name(
    axes: Axes,
    chart: Chart,
    route: Sequence[Point] | None,
    track: Sequence[Point] | None,
    view: View,
) -> None:
    """The water's name where there is most room for it."""
    if chart.is_open or not any(feature.kind == "water" for feature in chart.features):
        return
    room = chart.navigable.intersection(shapely.box(*view))
    for points in (route or (), track or ()):
        if len(points) > 1:
            line = shapely.LineString([(point.east_m, point.north_m) for point in points])
            room = room.difference(line.buffer(0.03 * (view[2] - view[0])))
    parts = [part for part in shapely.get_parts(room) if isinstance(part, Polygon)]
    if not parts:
        return
    circle = shapely.maximum_inscribed_circle(MultiPolygon(parts), tolerance=0.005 * (view[2] - view[0]))
    east_m, north_m = circle.coords[0]
    axes.text(
        east_m, north_m, chart.name.split(",")[0], fontsize=15, fontstyle="italic", color="#4f86a6",
        ha="center", va="center", family="DejaVu Serif", zorder=3.5, clip_on=True,
    )  # fmt: skip


COLOURS = {"track": "#1f5fa8", "shore": "#2a7f62", "transit": "#d08a2e", "cross": "#8e44ad"}
NAMES = {"track": "tracks", "shore": "along the shore", "transit": "transits", "cross": "cross lines"}
COVERED, MISSED = "#9fd6a8", "#c2413b"


def draw_survey(
    chart: Chart,
    survey: Survey,
    track: Sequence[Point] | None = None,
    *,
    title: str = "",
    subtitle: str = "",
    parts: Parts = (),
) -> Figure:
    """The survey on its chart. With a track, that is what covers; without, the planned route.

    The view is the whole chart, or the surroundings of the route where those are far smaller.
    """
    route = survey.route.points
    layout = Layout(WIDTH_IN, MAP_WIDTH_IN, is_narrow=False)
    view = view_of(chart, route, track, aspect=MAP_WIDTH_IN / MAP_HEIGHT_IN)
    figure, axes = framed(layout, view, title or chart.name, subtitle)
    draw_chart(axes, chart, route=route)
    covered = swath_of(track or route, survey.swath_m)
    fill(axes, survey.target.intersection(covered), facecolor=COVERED, edgecolor="none", zorder=2, alpha=0.75)
    fill(axes, survey.target.difference(covered), facecolor=MISSED, edgecolor=MISSED, linewidth=1.5, zorder=6)
    draw_parts(axes, parts)
    for leg in () if parts else survey.route.legs:
        width, alpha = (4.2, 0.5) if track else (1.2, 1.0)
        axes.plot(*_columns(leg.points), color=COLOURS[leg.kind], linewidth=width, alpha=alpha, zorder=8)
    kinds = {leg.kind for leg in survey.route.legs}
    handles: list[Any] = axes.get_legend_handles_labels()[0] or [
        Line2D([], [], color=COLOURS[kind], label=f"planned: {name}")
        for kind, name in NAMES.items()
        if kind in kinds
    ]
    if track:
        axes.plot(*_columns(track), color=SAILED, linewidth=0.8, zorder=9)
        handles.append(Line2D([], [], color=SAILED, label="sailed"))
    handles += [Patch(color=COVERED, label="covered"), Patch(color=MISSED, label="missed")]
    axes.legend(handles=handles, loc="upper left", fontsize=9, framealpha=0.9).set_zorder(20)
    if route:
        draw_waypoints(axes, (route[0], route[-1]))
    finish(axes, chart, view)
    return figure


def swath_of(path: Sequence[Point], swath_m: float) -> BaseGeometry:
    """What lies within half a footprint of a path.

    The legs are widened one by one: to widen a long path that crosses itself as one line is far slower.
    """
    legs = shapely.linestrings([[(a.east_m, a.north_m), (b.east_m, b.north_m)] for a, b in pairwise(path)])
    return shapely.union_all(shapely.buffer(legs, 0.5 * swath_m, quad_segs=8))
