"""What exact planning and planning on a grid say alike."""

from collections.abc import Sequence

from companion.core.geo import Point, distance_m
from mission_tools.maps.chart import Chart
from mission_tools.wording import distance


def stop_names(stops: Sequence[Point]) -> list[str]:
    """What messages call each stop after the start."""
    return [*(f"via point {n}" for n in range(1, len(stops) - 1)), "goal"]


def place(chart: Chart, point: Point) -> str:
    """A position as a person reads it."""
    at = chart.frame.to_global(point)
    return f"{at.lat_deg:.6f},{at.lon_deg:.6f}"


def way_out_note(chart: Chart, start: Point, way_out: Point, clearance_m: float) -> str:
    """The note on a start that is nearer to a shore than the clearance."""
    return (
        f"the start is {chart.clearance_m(start):.2f} m from {chart.nearest_feature(start)}: the first "
        f"{distance_m(start, way_out):.2f} m leave it with less than {clearance_m:g} m of clearance"
    )


def too_near(chart: Chart, name: str, point: Point, clearance_m: float, nearest: str) -> str:
    """The message for a stop that is nearer to a shore than the clearance."""
    here_m = chart.clearance_m(point)
    return (
        f"{name} {place(chart, point)} is {here_m:.1f} m from {chart.nearest_feature(point)}, "
        f"nearer than the clearance of {clearance_m:g} m: {nearest}"
    )


def nearest_free(chart: Chart, point: Point, free: Point | None, clearance_m: float) -> str:
    """Where free water is, for the end of a message."""
    if free is None:
        return f"nowhere on this map is {clearance_m:g} m clear: choose a smaller clearance"
    return f"the nearest free water is {distance(distance_m(point, free))} away, at {place(chart, free)}"
