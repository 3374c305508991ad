"""What surrounds a chart: graticule, scale bar, north arrow and legend."""

import math
from typing import Any

from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle

from companion.core.geo import Point, longitude_difference_deg
from mission_tools.drawing.style import (
    BAND,
    HALO,
    INK,
    KEEP_OUT,
    KEEP_OUT_TINT,
    PAPER,
    PLAN_STYLE,
    PLANNED,
    SAILED,
)
from mission_tools.geojson import KEPT_OUT
from mission_tools.maps.chart import Chart

SCALE_STEPS_M = tuple(step * 10.0**power for power in range(-2, 6) for step in (1.0, 2.0, 5.0))
SMALL_VIEW_M = 20.0

View = tuple[float, float, float, float]
"""West, south, east, north of what is shown, metres."""


def draw_frame(axes: Axes, chart: Chart, view: View) -> None:
    """A neat line with ticks of latitude and longitude, or of metres where the view is small."""
    if view[2] - view[0] < SMALL_VIEW_M:
        _metre_ticks(axes, view)
    else:
        _degree_ticks(axes, chart, view)
    axes.tick_params(labelsize=7.5, color="#777777", labelcolor="#666666", length=4)
    axes.grid(color="white", linewidth=0.6, alpha=0.45, zorder=2.5)
    for side in axes.spines.values():
        side.set(linewidth=1.4, color="#555555")


def _metre_ticks(axes: Axes, view: View) -> None:
    """East and north of the origin: a pool is too small for degrees."""
    west, south, east, north = view
    (eastings, decimals), (northings, north_decimals) = _round_values(west, east), _round_values(south, north)
    axes.set_xticks(eastings, [f"{at:.{decimals}f} m" for at in eastings])
    axes.set_yticks(northings, [f"{at:.{north_decimals}f} m" for at in northings], rotation=90, va="center")


def _degree_ticks(axes: Axes, chart: Chart, view: View) -> None:
    west, south, east, north = view
    low = chart.frame.to_global(Point(south, west))
    high = chart.frame.to_global(Point(north, east))
    across_deg = longitude_difference_deg(high.lon_deg, low.lon_deg)
    lons_deg, decimals = _round_values(low.lon_deg, low.lon_deg + across_deg)
    lats_deg, lat_decimals = _round_values(low.lat_deg, high.lat_deg)
    span = (east - west) / across_deg
    wrapped_deg = [longitude_difference_deg(lon, 0.0) for lon in lons_deg]
    axes.set_xticks(
        [west + (lon - low.lon_deg) * span for lon in lons_deg],
        [f"{abs(lon):.{decimals}f}° {'W' if lon < 0 else 'E'}" for lon in wrapped_deg],
    )
    span = (north - south) / (high.lat_deg - low.lat_deg)
    axes.set_yticks(
        [south + (lat - low.lat_deg) * span for lat in lats_deg],
        [f"{abs(lat):.{lat_decimals}f}° {'S' if lat < 0 else 'N'}" for lat in lats_deg],
        rotation=90,
        va="center",
    )


def _round_values(low: float, high: float) -> tuple[list[float], int]:
    """Four to nine round numbers between two, and the decimals they need."""
    steps = (s * 10.0**p for p in range(-8, 2) for s in (1, 2, 5))
    step = next((step for step in steps if (high - low) / step <= 7), 45.0)
    decimals = max(0, -math.floor(math.log10(step) + 1e-9))
    return [n * step for n in range(math.ceil(low / step), math.floor(high / step) + 1)], decimals


def draw_scale_bar(axes: Axes, view: View) -> None:
    """A round length in the lower left corner, about a fifth of the picture's width; more if it is narrow."""
    west, south, east, north = view
    width, height = east - west, north - south
    longest_m = max(0.2 * width, 0.45 * min(width, 0.6 * height))
    length_m = next((step for step in reversed(SCALE_STEPS_M) if step <= longest_m), SCALE_STEPS_M[0])
    left, bottom, thick = west + 0.025 * max(width, height), south + 0.035 * height, 0.007 * height
    for part, colour in enumerate((INK, "white", INK, "white")):
        corner = (left + part * length_m / 4.0, bottom)
        axes.add_patch(
            Rectangle(
                corner, length_m / 4.0, thick, facecolor=colour, edgecolor=INK, linewidth=0.8, zorder=20
            )
        )
    for share in (0.0, 0.5, 1.0):
        axes.text(
            left + share * length_m, bottom + 1.7 * thick, _metres(share * length_m), ha="center",
            fontsize=8.5, color=INK, path_effects=HALO, zorder=20,
        )  # fmt: skip


def _metres(length_m: float) -> str:
    if length_m >= 1000.0:
        return f"{length_m / 1000.0:g} km"
    return f"{length_m:g} m" if length_m >= 1.0 or length_m == 0.0 else f"{100.0 * length_m:g} cm"


def draw_north_arrow(axes: Axes) -> None:
    """In the upper right corner; the frame's north is up."""
    axes.annotate(
        "", xy=(0.968, 0.975), xytext=(0.968, 0.905), xycoords="axes fraction", zorder=20,
        arrowprops={"arrowstyle": "-|>,head_width=0.45,head_length=1.0", "color": INK, "linewidth": 1.6},
    )  # fmt: skip
    axes.text(
        0.968, 0.885, "N", transform=axes.transAxes, ha="center", va="center", fontsize=13,
        fontweight="bold", color=INK, path_effects=HALO, zorder=20,
    )  # fmt: skip


def draw_legend(
    axes: Axes, chart: Chart, band_m: float, has_plan: bool, has_track: bool, *, is_beside: bool = False
) -> None:
    """Whatever is on this picture; band_m is the clearance that a band was drawn for.

    is_beside: to the right of the map instead of in its corner.
    """
    entries: list[Any] = axes.get_legend_handles_labels()[0]  # the parts of a route
    if has_plan:
        entries = entries or [Line2D([], [], label="planned", **PLAN_STYLE)]
        entries.append(
            Line2D([], [], ls="", marker="o", ms=9, mfc="white", mec=PLANNED, mew=1.5, label="waypoint")
        )
    if has_track:
        entries.append(Line2D([], [], color=SAILED, lw=1.7, label="sailed"))
    if band_m > 0.0 and not chart.shores.is_empty:
        entries.append(Patch(facecolor=BAND, label=f"nearer than {_metres(band_m)} to a shore"))
    if any(feature.kind in KEPT_OUT for feature in chart.features):
        style: dict[str, Any] = {"facecolor": KEEP_OUT_TINT, "edgecolor": KEEP_OUT, "hatch": "///"}
        entries.append(Patch(label="keep out", linewidth=0, **style))
    if entries:
        place: dict[str, Any] = {"loc": "lower right"}
        if is_beside:
            place = {"loc": "lower left", "bbox_to_anchor": (1.03, 0.0), "borderaxespad": 0.0}
        box = axes.legend(handles=entries, fontsize=9.5, framealpha=0.93, borderpad=0.9, **place)
        box.get_frame().set(edgecolor="#999999", facecolor=PAPER)
        box.set_zorder(20)
