"""The planner: maps, routes, tasks, missions, upload. The whole of it in four lines:

    import mission_tools as mt

    water = mt.open_map("lake.geojson")
    route = water.route((50.0004, -1.199), (50.0016, -1.199), clearance_m=4)
    route.save("lake.plan")

Nothing is imported before it is used, so that `import mission_tools` costs next to nothing.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from companion.core.geo import LatLon
    from mission_tools.errors import MapError, MissionToolsError, NoRouteError, UsageError
    from mission_tools.route_plan import RouteLeg, RoutePlan
    from mission_tools.water_map import WaterMap, open_map

__all__ = [
    "LatLon",
    "MapError",
    "MissionToolsError",
    "NoRouteError",
    "RouteLeg",
    "RoutePlan",
    "UsageError",
    "WaterMap",
    "open_map",
]

_HOMES = {
    "LatLon": "companion.core.geo",
    "RouteLeg": "mission_tools.route_plan",
    "RoutePlan": "mission_tools.route_plan",
    "WaterMap": "mission_tools.water_map",
    "open_map": "mission_tools.water_map",
}


def __getattr__(name: str) -> Any:  # noqa: ANN401  what it is depends on the name
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_HOMES.get(name, "mission_tools.errors")), name)


def __dir__() -> list[str]:
    return sorted(__all__)
