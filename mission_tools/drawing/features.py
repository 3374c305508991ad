"""The features of a chart: islands, structures, keep-out areas and landmarks, with their names."""

import math
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
from mission_tools.drawing.style import HALO, INK, KEEP_OUT, KEEP_OUT_TINT, PLANNED
from mission_tools.geojson import KEPT_OUT
from mission_tools.maps.chart import Chart, Feature
from mission_tools.wording import distance

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
    elif feature.kind == "bridge":
        fill(
            axes,
            feature.shape,
            facecolor="none",
            edgecolor=STRUCTURE,
            linewidth=1.2,
            linestyle="--",
            zorder=5,
        )
        _name_beside(axes, feature, route)
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
    return [a.towards(b, k / 32) for a, b in pairwise(route) for k in range(33)]


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


NUMBER_PIXELS = 22.0  # a waypoint that is nearer to a numbered one is a dot without a number
NUMBER_RADIUS_PIXELS = 8.0
MANY, MANY_PIXELS = 60, 75.0  # where there are many waypoints, fewer have a number
ROOM_PIXELS = 95.0  # a shorter leg has no room for its length beside the waypoints
ASIDE_POINTS = 11.0  # from a leg to the middle of its length
NAMES = 12


def draw_waypoints(axes: Axes, points: Sequence[Point]) -> None:
    """Start, goal, and the waypoints between them numbered from 1; the last number is the goal's.

    Where numbers would overlap, only the first has one. The layout of the figure must be final.
    """
    pixels = _pixels(axes, points)
    taken = [pixels[0], pixels[-1]]
    apart = NUMBER_PIXELS if len(points) <= MANY else MANY_PIXELS
    for number, (point, pixel) in enumerate(zip(points[1:-1], pixels[1:-1], strict=True), 1):
        nearest = min(math.dist(pixel, other) for other in taken)
        if nearest < NUMBER_RADIUS_PIXELS:
            continue  # it would cover the number
        has_room = nearest >= apart
        size, edge = (11.0, 1.5) if has_room else (4.5, 1.0) if len(points) <= MANY else (2.5, 0.6)
        axes.plot(point.east_m, point.north_m, "o", ms=size, mfc="white", mec=PLANNED, mew=edge, zorder=11)
        if has_room:
            taken.append(pixel)
            axes.annotate(
                str(number), (point.east_m, point.north_m), ha="center", va="center_baseline",
                fontsize=7.5 if number < 100 else 5.5,
                color=PLANNED, fontweight="bold", zorder=NAMES,
            )  # fmt: skip
    ends = [(points[0], "o", "Start"), (points[-1], "*", "Goal")]
    if math.dist(pixels[0], pixels[-1]) < NUMBER_PIXELS:
        ends = [(points[-1], "*", "Start and goal")]
    for point, marker, label in ends:
        size = 11 if marker == "o" else 19
        axes.plot(point.east_m, point.north_m, marker, ms=size, mfc=PLANNED, mec="white", mew=1.4, zorder=13)
        axes.annotate(
            label, (point.east_m, point.north_m), xytext=(10, -13), textcoords="offset points", fontsize=10,
            fontweight="bold", color=INK, path_effects=HALO, zorder=14,
        )  # fmt: skip


def draw_lengths(axes: Axes, points: Sequence[Point]) -> None:
    """The length of every leg that has room for it, above its middle."""
    for (start, end), (a, b) in zip(pairwise(points), pairwise(_pixels(axes, points)), strict=True):
        if math.dist(a, b) < ROOM_PIXELS:
            continue
        x, y = (b[0] - a[0]) / math.dist(a, b), (b[1] - a[1]) / math.dist(a, b)
        side = 1.0 if x >= 0.0 else -1.0
        angle_deg = math.degrees(math.atan2(side * y, side * x))
        axes.annotate(
            distance(distance_m(start, end)),
            (0.5 * (start.east_m + end.east_m), 0.5 * (start.north_m + end.north_m)),
            xytext=(-side * y * ASIDE_POINTS, side * x * ASIDE_POINTS), textcoords="offset points",
            ha="center", va="center", rotation=angle_deg, fontsize=8.5, color=PLANNED, path_effects=HALO,
            zorder=NAMES,
        )  # fmt: skip


def draw_tightest(axes: Axes, chart: Chart, points: Sequence[Point]) -> None:
    """A bar from the route to what it passes nearest to, and how near that is."""
    if chart.shores.is_empty or len(points) < 2:
        return
    line = shapely.LineString([(point.east_m, point.north_m) for point in points])
    (x1, y1), (x2, y2) = shapely.shortest_line(line, chart.shores).coords
    axes.plot([x1, x2], [y1, y2], color=INK, linewidth=1.6, zorder=9, solid_capstyle="butt")
    axes.annotate(
        f"nearest: {distance(math.hypot(x2 - x1, y2 - y1))}", (x2, y2), xytext=_away(x2 - x1, y2 - y1),
        textcoords="offset points", ha="center", va="center", fontsize=8.5, color=INK, path_effects=HALO,
        zorder=NAMES,
    )  # fmt: skip


def _away(x: float, y: float) -> tuple[float, float]:
    """From the shore's nearest point landwards, in points."""
    length = math.hypot(x, y) or 1.0
    return 42.0 * x / length, 16.0 * y / length


def _pixels(axes: Axes, points: Sequence[Point]) -> list[tuple[float, float]]:
    shown = axes.transData.transform([(point.east_m, point.north_m) for point in points])
    return [(float(x), float(y)) for x, y in shown]
