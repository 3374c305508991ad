"""Object classes of S-57 charts (IHO S-57, appendix A): what each is to a boat.

Depth areas with a known least depth of 0 m or more, and dredged areas, are water; what dries is land. Rocks,
wrecks and obstructions are obstacles whatever their depth. The least depth stays in the property `depth_m`.
"""

from collections.abc import Iterable, Mapping
from typing import Any

_KINDS: dict[str, str] = {
    "LNDARE": "island",
    "LNDRGN": "",
    "DRGARE": "water",
    "LAKARE": "water",
    "RIVERS": "water",
    "CANALS": "water",
    "DOCARE": "water",
    "BUISGL": "obstacle",
    "SLCONS": "pier",
    "PONTON": "pier",
    "FLODOC": "pier",
    "GATCON": "pier",
    "DAMCON": "pier",
    "MORFAC": "obstacle",
    "HULKES": "obstacle",
    "OBSTRN": "obstacle",
    "WRECKS": "obstacle",
    "UWTROC": "obstacle",
    "PILPNT": "obstacle",
    "OFSPLF": "obstacle",
    "FSHFAC": "obstacle",
    "MARCUL": "obstacle",
}
_DEPTH_AREA = "DEPARE"
_OVERHEAD = {"BRIDGE": "a bridge", "CBLOHD": "a cable", "PIPOHD": "a pipe", "CONVYR": "a conveyor"}
_CLEARANCES = ("verclr", "verccl", "vercsa")  # m: of a fixed span, a closed one, and a safe one under a cable


def is_known(object_class: str) -> bool:
    """Whether a layer of this object class matters to a route."""
    return object_class == _DEPTH_AREA or bool(_KINDS.get(object_class))


def properties(object_class: str, row: Mapping[str, Any]) -> dict[str, Any]:
    """The attributes of an object with its kind, its name and, of an area of water, its least depth."""
    found: dict[str, Any] = {**row, "kind": _KINDS.get(object_class, "")}
    name = row.get("objnam")
    if isinstance(name, str):
        found["name"] = name
    if object_class in (_DEPTH_AREA, "DRGARE"):
        least = row.get("drval1")
        depth_m = float(least) if isinstance(least, int | float) else None
        if object_class == _DEPTH_AREA:
            found["kind"] = "water" if depth_m is not None and depth_m >= 0.0 else "island"
        if depth_m is not None:
            found["depth_m"] = depth_m
    return found


def overhead_notes(source: str, objects: Iterable[tuple[str, Mapping[str, Any]]]) -> list[str]:
    """What hangs over the water, in a line. objects: class and attributes."""
    found = [(name, row) for name, row in objects if name in _OVERHEAD]
    if not found:
        return []
    heights = [
        (float(height_m), name)
        for name, row in found
        for key in _CLEARANCES
        if isinstance(height_m := row.get(key), int | float)
    ]
    text = (
        f"{source}: {len(found)} bridges, cables and pipes are overhead: routes pass below, check the height"
    )
    if heights:
        height_m, name = min(heights)
        text += f"; the lowest, {_OVERHEAD[name]}, leaves {height_m:g} m"
    return [text]
