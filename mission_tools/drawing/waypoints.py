"""The waypoints of a route, its legs' lengths, and where it passes nearest to something."""

import math
from collections.abc import Sequence
from itertools import pairwise

import shapely
from matplotlib.axes import Axes

from companion.core.geo import Point, distance_m
from mission_tools.drawing.style import HALO, INK, PLANNED
from mission_tools.maps.chart import Chart
from mission_tools.wording import distance

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
