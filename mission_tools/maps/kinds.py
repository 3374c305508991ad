"""What a feature of a GeoJSON map is: its property `kind`, or else its OpenStreetMap tags.

Without either it is water, so that a plain lake works as it is; but a shape within another's water is then
ambiguous, most likely an island: `ambiguity` finds it.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import shapely
from shapely.geometry.base import BaseGeometry

from mission_tools.errors import MapError
from mission_tools.geojson import KINDS, Kind, tagged_kind

INSIDE_SHARE = 0.5  # of a shape's area: a bay that is drawn as a piece of its own overlaps its lake by less

_TOLD = ("place", "natural", "man_made", "waterway", "building")  # whose unknown values are asked about


def kind_of(properties: Mapping[str, Any], where: str) -> tuple[Kind, bool]:
    """The kind of a feature, and whether the file says so: False for water by default.

    Raises:
        MapError: a kind that does not exist, or tags that say neither water nor land.
    """
    if "kind" in properties:
        kind = properties["kind"]
        if kind not in KINDS:
            raise MapError(f"{where}: kind {kind!r} is none of {', '.join(KINDS)}")
        return kind, True
    tagged = tagged_kind(properties)
    if tagged is not None:
        return tagged, True
    said = next((f"{key}={properties[key]}" for key in _TOLD if properties.get(key)), None)
    if said is not None:
        raise MapError(
            f"{where}: {said} says neither water nor land here: "
            f"add the property kind, one of {', '.join(KINDS)}"
        )
    return "water", False


def ambiguity(shapes: Sequence[tuple[str, BaseGeometry, bool]]) -> list[tuple[int, int]]:
    """Water by default that lies in other water: taken as water, an island would be sailed over.

    shapes: every piece of water as (name for messages, shape, whether the file says that it is water).

    Returns:
        Pairs of indices: the inner piece, and the one around it.
    """
    if len(shapes) < 2 or all(is_said for _, _, is_said in shapes):
        return []
    tree = shapely.STRtree([shape for _, shape, _ in shapes])
    found: list[tuple[int, int]] = []
    for inner, (_, shape, is_said) in enumerate(shapes):
        if is_said:
            continue
        for outer in sorted(tree.query(shape, "intersects").tolist()):
            around = shapes[outer][1]
            if around.area > shape.area and shape.intersection(around).area > INSIDE_SHARE * shape.area:
                found.append((inner, outer))
                break
    return found
