"""Areas of a chart with a depth or a speed limit, from the properties `depth_m` and `max_speed_m_s`."""

from dataclasses import replace

from shapely.geometry import MultiPolygon, Polygon

from mission_tools.costs.travel import SpeedZone
from mission_tools.errors import MapError
from mission_tools.maps.chart import DEPTH, SPEED_LIMIT, Chart, build_chart, property_number


def for_draught(chart: Chart, draught_m: float) -> Chart:
    """The chart for a boat of this draught: water that is less deep is an obstacle.

    Water without a depth counts as deep enough; a note says so where the map has no depths at all.

    Raises:
        MapError: nothing is deep enough, or a depth is no number; names the area.
    """
    if all(feature.properties.get(DEPTH) is None for feature in chart.features):
        said = f"the map has no depths ({DEPTH}): a draught of {draught_m:g} m makes no difference"
        return replace(chart, notes=(*chart.notes, said))
    features = [
        replace(feature, kind="obstacle", name=feature.name or f"water of {depth:g} m")
        if (depth := property_number(feature, DEPTH)) is not None
        and depth < draught_m
        and feature.kind == "water"
        else feature
        for feature in chart.features
    ]
    if all(new is old for new, old in zip(features, chart.features, strict=True)):
        return chart
    water = None if chart.is_open else chart.water
    return build_chart(chart.name, chart.frame, water, features, chart.notes)


def speed_zones(chart: Chart) -> tuple[SpeedZone, ...]:
    """The chart's areas with a speed limit.

    Raises:
        MapError: a limit is no number above 0; names the area.
    """
    zones = []
    for feature in chart.features:
        limit_m_s = property_number(feature, SPEED_LIMIT)
        if limit_m_s is None or not isinstance(feature.shape, Polygon | MultiPolygon):
            continue
        if not limit_m_s > 0.0:
            raise MapError(f"{feature.described}: {SPEED_LIMIT} is {limit_m_s:g}: expected more than 0")
        zones.append(SpeedZone(feature.shape, limit_m_s))
    return tuple(zones)
