"""The water that is deep enough for a boat, and the bridges that are high enough.

Depths are the least of an area, heights the clearance under a bridge as a chart states it: over high water.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from mission_tools.errors import UsageError
from mission_tools.maps.chart import DEPTH, HEIGHT, Chart, Feature, build_chart, property_number


@dataclass(frozen=True, slots=True)
class BoatSize:
    """A boat's reach below and above the water in metres; None: not known. Raises UsageError: below 0."""

    draught_m: float | None = None
    air_draught_m: float | None = None

    def __post_init__(self) -> None:
        for option, size_m in (("--draught", self.draught_m), ("--air-draught", self.air_draught_m)):
            if size_m is not None and size_m < 0.0:
                raise UsageError(f"{option} {size_m:g}: expected 0 metres or more")


def passable(chart: Chart, boat: BoatSize) -> Chart:
    """The chart with water that is less deep than the draught, and bridges that are less high than the air
    draught, as obstacles.

    What has no depth or height counts as passable; a note says so where that leaves the size without an
    effect, or a bridge for the owner to look at. Raises MapError: nothing is deep enough, or a depth or a
    height is no number; names the area.
    """
    notes = [*chart.notes, *_unknown(chart, boat)]
    features = [
        replace(one, kind="obstacle", name=one.name or f"water of {limit_m(one):g} m")
        if bars(one, boat)
        else one
        for one in chart.features
    ]
    if any(new is not old for new, old in zip(features, chart.features, strict=True)):
        return build_chart(chart.name, chart.frame, None if chart.is_open else chart.water, features, notes)
    return chart if len(notes) == len(chart.notes) else replace(chart, notes=tuple(notes))


def bars(feature: Feature, boat: BoatSize) -> bool:
    """Whether an area is too shallow, or a bridge too low. Raises MapError: the map's figure is no number."""
    size_m = boat.air_draught_m if feature.kind == "bridge" else boat.draught_m
    if size_m is None or feature.kind not in ("water", "bridge"):
        return False
    has_m = limit_m(feature)
    return has_m is not None and has_m < size_m


def limit_m(feature: Feature) -> float | None:
    """The depth of an area, or the height of a bridge; None: not known. Raises MapError: no number."""
    return property_number(feature, HEIGHT if feature.kind == "bridge" else DEPTH)


def _unknown(chart: Chart, boat: BoatSize) -> Iterator[str]:
    """What the map does not say, a line each."""
    if boat.draught_m is not None and all(one.properties.get(DEPTH) is None for one in chart.features):
        yield f"the map has no depths ({DEPTH}): a draught of {boat.draught_m:g} m makes no difference"
    bridges = [one for one in chart.features if one.kind == "bridge"]
    if not bridges:
        return
    heights = [(height_m, one.name) for one in bridges if (height_m := limit_m(one)) is not None]
    overhead = f"{len(bridges)} bridges and cables are overhead"
    if boat.air_draught_m is None:
        lowest = "the lowest, {1}, leaves {0:g} m".format(*min(heights)) if heights else "none has a height"
        yield f"{overhead}, {lowest}: routes pass below; --air-draught M keeps out from under lower ones"
    elif len(heights) < len(bridges):
        unknown = len(bridges) - len(heights)
        yield f"{overhead}, {unknown} without a height ({HEIGHT}): routes pass below these, look at them"
