"""The features of a chart: islands, structures, keep-out areas and landmarks, with their names."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.patches import PathPatch
from matplotlib.path import Path as Outline
from matplotlib.text import Annotation
from matplotlib.transforms import Bbox
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from companion.core.geo import Point, distance_m
from mission_tools.drawing.style import HALO, INK, KEEP_OUT, KEEP_OUT_TINT
from mission_tools.geojson import KEPT_OUT
from mission_tools.maps.chart import Chart, Feature

LAND_EDGE, ISLAND, STRUCTURE = "#a8966c", "#dfe3bd", "#8d6e4f"
NAMES = 6  # the layer of features' names


def fill(axes: Axes, shape: BaseGeometry, **style: Any) -> None:  # noqa: ANN401 (matplotlib's own)
    for part in shapely.get_parts(shape):
        if isinstance(part, Polygon) and not part.is_empty:
            rings = [part.exterior, *part.interiors]
            outline = Outline.make_compound_path(*(Outline(np.asarray(ring.coords)[:, :2]) for ring in rings))
            axes.add_patch(PathPatch(outline, **style))


def draw_feature(axes: Axes, chart: Chart, feature: Feature, route: Sequence[Point]) -> None:
    if feature.kind == "landmark":
        _draw_landmark(axes, chart, feature)
    elif feature.kind in KEPT_OUT:
        afloat = feature.shape.intersection(chart.water)
        tint = {"facecolor": KEEP_OUT_TINT, "edgecolor": KEEP_OUT, "hatch": "///"}
        fill(axes, afloat, alpha=0.45, linewidth=0, zorder=3, **tint)
        fill(axes, afloat, facecolor="none", edgecolor=KEEP_OUT, linewidth=1.2, linestyle="--", zorder=5)
        _name(axes, feature, color=KEEP_OUT, fontstyle="italic")
    elif feature.kind == "island":
        fill(axes, feature.shape, facecolor=ISLAND, edgecolor=LAND_EDGE, linewidth=1.0, zorder=5)
        _name(axes, feature, fontstyle="italic")
    elif feature.kind != "water":
        fill(axes, feature.shape, facecolor=STRUCTURE, edgecolor="#4e3b28", linewidth=1.0, zorder=5)
        _name_beside(axes, feature, route)


def _name(axes: Axes, feature: Feature, **style: Any) -> None:  # noqa: ANN401 (matplotlib's own)
    """In the middle of the thing."""
    style = {"color": INK, "fontsize": 9.0, "ha": "center", "va": "center", **style}
    at = feature.shape.centroid
    axes.text(at.x, at.y, feature.name, path_effects=HALO, zorder=NAMES, clip_on=True, **style)


def _name_beside(axes: Axes, feature: Feature, route: Sequence[Point]) -> None:
    """To the right or left of a small thing, on the side that is farther from the route."""
    west, south, east, north = feature.shape.bounds
    reach_m = 2.0 * (east - west)
    middle = 0.5 * (south + north)
    sides = {"left": (east + reach_m, east, 6), "right": (west - reach_m, west, -6)}

    def room_m(alignment: str) -> float:
        at = Point(middle, sides[alignment][0])
        return min(
            (distance_m(at, point) for point in _dense(route)), default=1.0 if alignment == "left" else 0.0
        )

    alignment = max(sides, key=room_m)
    _, edge, offset = sides[alignment]
    axes.annotate(
        feature.name, (edge, middle), xytext=(offset, 0), textcoords="offset points", ha=alignment,
        va="center", fontsize=8.0, color=INK, path_effects=HALO, zorder=NAMES, annotation_clip=True,
    )  # fmt: skip


def arrange_names(axes: Axes) -> None:
    """Move names that the frame would cut; where names overlap, show only the first.

    Start, Goal and numbers always stay. The layout of the figure must be final.
    """
    taken: list[Bbox] = []
    frame = axes.get_window_extent()
    for text in axes.texts:
        if isinstance(text, Annotation) and text.zorder == NAMES:
            _keep_inside(text, frame)
    for text in sorted(axes.texts, key=lambda text: text.zorder == NAMES):
        box = text.get_window_extent()
        if text.zorder == NAMES and box.count_overlaps(taken):
            text.set_visible(False)
        else:
            taken.append(box)


def _keep_inside(name: Annotation, frame: Bbox) -> None:
    """Put a name that the frame would cut on the other side of its thing."""
    box = name.get_window_extent()
    if box.x1 > frame.x1 or box.x0 < frame.x0:
        offset, _ = name.get_position()
        name.set_position((-offset, 0.0))
        name.set_horizontalalignment("right" if name.get_horizontalalignment() == "left" else "left")


def _dense(route: Sequence[Point]) -> list[Point]:
    return [
        Point(a.north_m + k / 32 * (b.north_m - a.north_m), a.east_m + k / 32 * (b.east_m - a.east_m))
        for a, b in pairwise(route)
        for k in range(33)
    ]


def _draw_landmark(axes: Axes, chart: Chart, feature: Feature) -> None:
    """A small square with its name on the landward side."""
    at = feature.shape.centroid
    is_west = at.x < 0.5 * (chart.water.bounds[0] + chart.water.bounds[2])
    axes.plot(at.x, at.y, "s", ms=6, mfc=INK, mec="white", mew=0.8, zorder=6)
    axes.annotate(
        feature.name, (at.x, at.y), xytext=(-8 if is_west else 8, 0), textcoords="offset points",
        ha="right" if is_west else "left", va="center", fontsize=9.0, fontweight="bold", color=INK,
        path_effects=HALO, zorder=NAMES, annotation_clip=True,
    )  # fmt: skip
