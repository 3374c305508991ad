"""The parts of a scenario TOML that a planner needs: [origin], [map], [route] and [[cases]].

    [origin]  lat_deg, lon_deg                        local (0, 0); may be left out if there is a map.file
    [map]     file = "pond.geojson"                   relative to the scenario, or
              water = [[east_m, north_m], …]          in local metres; neither: open water
              [[map.obstacles]] name, kind, and polygon = [[east_m, north_m], …]
                                         or circle = { centre = [east_m, north_m], radius_m = … }
    [route]   start, goal, via                        [east_m, north_m] or { lat_deg, lon_deg }
              clearance_m, margin_m, cell_m, heuristic, smooth
    [[cases]] name, start, goal

Other sections belong to the emulator and are not looked at.
"""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

import msgspec
import shapely
from msgspec import Meta
from shapely.geometry import Polygon

from companion.core.geo import LatLon, LocalFrame, Point
from companion.core.toml_text import parse_toml
from mission_tools.errors import MapError
from mission_tools.maps.chart import Chart, Feature, build_chart
from mission_tools.maps.map_files import load_map
from mission_tools.maps.source import RouteDefaults, Source

Positive = Annotated[float, Meta(gt=0.0)]
Metres = Annotated[float, Meta(ge=-1e6, le=1e6)]  # from the origin; places on the globe follow from them
EastNorth = tuple[Metres, Metres]
Ring = Annotated[tuple[EastNorth, ...], Meta(min_length=3)]

_CIRCLE_SEGMENTS_PER_QUARTER = 16


class _Table(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A table of the scenario."""


class Global(_Table, frozen=True):
    """A place on the globe."""

    lat_deg: Annotated[float, Meta(ge=-90.0, le=90.0)]
    lon_deg: Annotated[float, Meta(ge=-180.0, le=180.0)]


class _Circle(_Table, frozen=True):
    centre: EastNorth
    radius_m: Annotated[float, Meta(gt=0.0, le=1e6)]


class _Obstacle(_Table, frozen=True):
    name: str = "obstacle"
    kind: Literal["island", "obstacle", "pier", "raft", "keep_out", "swimming"] = "obstacle"
    polygon: Ring | None = None
    circle: _Circle | None = None


class _Map(_Table, frozen=True):
    name: str = ""
    file: str = ""
    water: Ring | None = None
    obstacles: tuple[_Obstacle, ...] = ()


_Place = EastNorth | Global


class _Route(_Table, frozen=True):
    start: _Place | None = None
    goal: _Place | None = None
    via: tuple[_Place, ...] = ()
    clearance_m: Annotated[float, Meta(ge=0.0)] | None = None
    margin_m: Annotated[float, Meta(ge=0.0)] | None = None
    cell_m: Positive | None = None
    heuristic: Literal["octile", "euclidean", "manhattan"] | None = None
    smooth: bool | None = None


class _Case(_Table, frozen=True):
    name: str
    start: _Place
    goal: _Place


class _Scenario(msgspec.Struct, frozen=True, kw_only=True):
    origin: Global | None = None
    map: _Map = _Map()
    route: _Route = _Route()
    cases: tuple[_Case, ...] = ()


def load_scenario(path: Path) -> Source:
    """Read a scenario's chart, route and cases. Raises MapError: cannot be read, not TOML, a key that cannot
    be used, or a map that cannot; one line that names the file and the key.
    """
    try:
        tree = parse_toml(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise MapError(f"{path}: cannot be read: {error.strerror}") from None
    except ValueError as error:
        raise MapError(f"{path}: not a TOML file: {error}") from None
    return decode_scenario(tree, path)


def decode_scenario(tree: Mapping[str, Any], path: Path) -> Source:
    """Build the source from a TOML tree; `path` names it in messages and is where map.file is looked for.
    Raises MapError: as `load_scenario`.
    """
    try:
        scenario = msgspec.convert(dict(tree), _Scenario)
    except msgspec.ValidationError as error:
        raise MapError(f"{path}: {error}") from None
    chart = _chart(scenario, path)

    def local(place: _Place) -> Point:
        if isinstance(place, Global):
            return chart.frame.to_local(LatLon(place.lat_deg, place.lon_deg))
        return Point(place[1], place[0])

    route = scenario.route
    named = msgspec.structs.asdict(route) | {
        "start": None if route.start is None else local(route.start),
        "goal": None if route.goal is None else local(route.goal),
        "via": tuple(map(local, route.via)),
    }
    cases = {case.name: (local(case.start), local(case.goal)) for case in scenario.cases}
    return Source(chart, RouteDefaults(**named), cases)


def _chart(scenario: _Scenario, path: Path) -> Chart:
    given = scenario.origin
    origin = None if given is None else LatLon(given.lat_deg, given.lon_deg)
    extra = [
        _feature(obstacle, f"{path}: map.obstacles[{n}]") for n, obstacle in enumerate(scenario.map.obstacles)
    ]
    if scenario.map.file:
        if scenario.map.water is not None:
            raise MapError(f"{path}: map.file and map.water exclude each other")
        chart = load_map(path.parent / scenario.map.file, origin)
        if not extra:
            return chart
        features = (*chart.features, *extra)
        return build_chart(chart.name, chart.frame, chart.water, features, chart.notes)
    if origin is None:
        raise MapError(
            f"{path}: origin is missing: expected [origin] with lat_deg and lon_deg, or a map.file"
        )
    water = None if scenario.map.water is None else _polygon(scenario.map.water, f"{path}: map.water")
    return build_chart(scenario.map.name or path.stem, LocalFrame(origin), water, extra)


def _feature(obstacle: _Obstacle, where: str) -> Feature:
    if (obstacle.polygon is None) == (obstacle.circle is None):
        raise MapError(f'{where} "{obstacle.name}": expected either polygon or circle')
    if obstacle.circle is not None:
        east, north = obstacle.circle.centre
        # Drawn round the circle, not into it, so that no clearance is lost on its corners.
        radius = obstacle.circle.radius_m / math.cos(math.pi / (4 * _CIRCLE_SEGMENTS_PER_QUARTER))
        disc = shapely.Point(east, north).buffer(radius, quad_segs=_CIRCLE_SEGMENTS_PER_QUARTER)
        return Feature(obstacle.name, obstacle.kind, disc)
    return Feature(
        obstacle.name, obstacle.kind, _polygon(obstacle.polygon or (), f'{where} "{obstacle.name}"')
    )


def _polygon(ring: Ring, where: str) -> Polygon:
    polygon = Polygon(ring)
    if not polygon.is_valid or polygon.is_empty:
        reason, _, place = shapely.is_valid_reason(polygon).rstrip("]").partition("[")
        raise MapError(f"{where}: not a valid polygon: {reason.lower()} at [{place.replace(' ', ', ')}]")
    return polygon
