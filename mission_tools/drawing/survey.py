"""The picture of a survey: what was to be covered, what was covered, and the tracks."""

from collections.abc import Sequence
from itertools import pairwise

import shapely
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from shapely.geometry.base import BaseGeometry

from companion.core.geo import Point
from mission_tools.drawing.draw import (
    BOTTOM_IN,
    HEIGHT_IN,
    LEFT_IN,
    MAP_HEIGHT_IN,
    MAP_WIDTH_IN,
    WIDTH_IN,
    draw_chart,
)
from mission_tools.drawing.features import arrange_names, fill
from mission_tools.drawing.legend import draw_frame, draw_north_arrow, draw_scale_bar
from mission_tools.drawing.style import INK, SAILED, new_figure
from mission_tools.drawing.view import view_of
from mission_tools.drawing.waypoints import draw_waypoints
from mission_tools.maps.chart import Chart
from mission_tools.tasks.survey.survey import Survey

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
) -> Figure:
    """The survey on its chart. With a track, that is what covers; without, the planned route.

    The view is the whole chart, or the surroundings of the route where those are far smaller.
    """
    route = survey.route.points
    figure = new_figure(WIDTH_IN, HEIGHT_IN, dpi=125, layout=None)
    box = (LEFT_IN / WIDTH_IN, BOTTOM_IN / HEIGHT_IN, MAP_WIDTH_IN / WIDTH_IN, MAP_HEIGHT_IN / HEIGHT_IN)
    axes = figure.add_axes(box)
    view = view_of(chart, route, track, aspect=MAP_WIDTH_IN / MAP_HEIGHT_IN)
    west, south, east, north = view
    axes.set(xlim=(west, east), ylim=(south, north), aspect="equal")
    draw_chart(axes, chart, route=route)
    covered = swath_of(track or route, survey.swath_m)
    fill(axes, survey.target.intersection(covered), facecolor=COVERED, edgecolor="none", zorder=2, alpha=0.75)
    fill(axes, survey.target.difference(covered), facecolor=MISSED, edgecolor=MISSED, linewidth=1.5, zorder=6)
    kinds = []
    for leg in survey.route.legs:
        kinds.append(leg.kind)
        axes.plot(
            [point.east_m for point in leg.points],
            [point.north_m for point in leg.points],
            color=COLOURS[leg.kind],
            linewidth=4.2 if track else 1.2,
            alpha=0.5 if track else 1.0,
            zorder=8,
        )
    handles: list[Patch | Line2D] = [
        Line2D([], [], color=COLOURS[kind], label=f"planned: {name}")
        for kind, name in NAMES.items()
        if kind in kinds
    ]
    if track:
        columns = [point.east_m for point in track], [point.north_m for point in track]
        axes.plot(*columns, color=SAILED, linewidth=0.8, zorder=9)
        handles.append(Line2D([], [], color=SAILED, label="sailed"))
    handles += [Patch(color=COVERED, label="covered"), Patch(color=MISSED, label="missed")]
    axes.legend(handles=handles, loc="upper left", fontsize=9, framealpha=0.9).set_zorder(20)
    if route:
        draw_waypoints(axes, (route[0], route[-1]))
    arrange_names(axes)
    draw_frame(axes, chart, view)
    draw_scale_bar(axes, view)
    draw_north_arrow(axes)
    figure.text(box[0], 0.952, title or chart.name, fontsize=21, fontweight="bold", color=INK)
    figure.text(box[0], 0.918, subtitle, fontsize=11.5, color="#5a5a5a")
    return figure


def swath_of(path: Sequence[Point], swath_m: float) -> BaseGeometry:
    """What lies within half a footprint of a path.

    The legs are widened one by one: to widen a long path that crosses itself as one line is far slower.
    """
    legs = shapely.linestrings([[(a.east_m, a.north_m), (b.east_m, b.north_m)] for a, b in pairwise(path)])
    return shapely.union_all(shapely.buffer(legs, 0.5 * swath_m, quad_segs=8))
