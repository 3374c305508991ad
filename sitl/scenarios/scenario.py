"""Scenarios: commented TOML that says which boat sails where, in what water, with which sensors.

A scenario lies over its boat's file (`boats/`): tables join, values replace, so that a scenario, or `--set`
on the command line, may change any number of the boat. The tables [hull], [thrusters], [battery] and
[sensors.*] are the emulator's; [vehicle.*] is the companion's own configuration; [origin], [map], [route] and
[[cases]] are shared with the planner, whose decoder reads them.

Positions are [east, north] in metres of the local frame, or {lat_deg, lon_deg}.
"""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import msgspec
import shapely
from msgspec import field

from companion.config.boat_config import BoatConfig, decode_config, load_toml
from companion.config.section import Section
from companion.core.errors import ConfigError
from companion.core.geo import LatLon, Point, bearing_rad, distance_m
from mission_tools.maps.chart import Chart
from mission_tools.maps.scenario import Global, decode_scenario
from sitl.radio.channel import LinkSettings
from sitl.scenarios.layers import Layer, decode, explain, merge, parse_overrides
from sitl.scenarios.random_world import RandomWater, random_world
from sitl.world.drive.settings import ThrusterSettings
from sitl.world.environment.settings import Environment
from sitl.world.faults.catalogue import FaultSetting
from sitl.world.hull_settings import HullSettings
from sitl.world.movers import MoverSettings
from sitl.world.pack import BatterySettings
from sitl.world.sampling import Seed
from sitl.world.scenario import Scenario
from sitl.world.sensors.rangers import OF_KIND, RANGERS
from sitl.world.sensors.receivers import OF_CLASS, RECEIVERS
from sitl.world.sensors.settings import Sensors

SCENARIOS = Path(__file__).parent
BOATS = SCENARIOS.with_name("boats")
DEFAULT_BOAT = "lake"

Table = dict[str, Any]
# By table of [sensors] and its key: what each class sets, with one key for all
CLASSES: Final[Mapping[tuple[str, str], Mapping[str, Mapping[str, Any]]]] = {
    ("gnss", "receiver"): {
        name: {key: getattr(one, key) for key in OF_CLASS} for name, one in RECEIVERS.items()
    },
    ("sonar", "ranger"): {name: {key: getattr(one, key) for key in OF_KIND} for name, one in RANGERS.items()},
}


class BoatTable(Section, frozen=True):
    """Which boat, and how it lies in the water at first."""

    model: str = DEFAULT_BOAT
    start: tuple[float, float] | Global | None = None
    heading_deg: float | None = None


class Tree(Section, frozen=True):
    """A whole scenario, the boat's file included. What the planner reads too is left to its own decoder."""

    hull: HullSettings
    thrusters: ThrusterSettings
    title: str = ""
    seed: Seed = 1
    origin: Table = field(default_factory=dict)
    map: Table = field(default_factory=dict)
    route: Table = field(default_factory=dict)
    cases: tuple[Table, ...] = ()
    boat: BoatTable = BoatTable()
    environment: Environment = Environment()
    battery: BatterySettings = BatterySettings()
    sensors: Sensors = Sensors()
    link: LinkSettings = LinkSettings()
    movers: tuple[MoverSettings, ...] = ()
    faults: tuple[FaultSetting, ...] = ()
    random: RandomWater | None = None
    vehicle: Table = field(default_factory=dict)


class RandomSource(msgspec.Struct, frozen=True):
    """What a random world is drawn from; everything else is looked at afterwards."""

    random: RandomWater | None = None
    seed: Seed = 1


def load_scenario(
    source: str,
    overrides: Sequence[str] = (),
    case: str | None = None,
    over: Sequence[Layer] = (),
    below: Sequence[Layer] = (),
) -> Scenario:
    """Read a scenario.

    source: an installed scenario's name (`lake`, `pool`, `open`, `random`), a TOML file, or a GeoJSON map, on
    which the lake boat then floats. overrides: settings such as `environment.current_m_s=0.5`. case: one of
    [[cases]]. over: further layers between the file and the overrides; below: under the file, over its boat.
    Raises ConfigError: no such scenario or boat, a start on land, or a key that cannot be used; it names file
    and key; MissionToolsError: the map cannot be used, or there is no such case.
    """
    path, own = _find(source)
    layers = [own, *over, parse_overrides(overrides)]
    boat_file = _boat_file(layers, path.parent)
    boat = Layer(boat_file.name if boat_file.parent == BOATS else str(boat_file), load_toml(boat_file))
    layers = _with_classes([boat, *_drawn(layers), *below, *layers])
    tree = decode(layers, Tree)
    waters = decode_scenario(merge(layers), path)
    if case is not None:
        waters = waters.with_case(case)
    chart, route = waters.chart, waters.route
    start = _start(tree.boat.start, route.start, chart, own.name)
    return Scenario(
        title=tree.title or chart.name,
        seed=tree.seed,
        chart=chart,
        route=route,
        start=start,
        heading_rad=_heading_rad(tree.boat.heading_deg, start, route.goal),
        hull=tree.hull,
        thrusters=tree.thrusters,
        battery=tree.battery,
        sensors=tree.sensors,
        environment=tree.environment.beside(path.parent),
        vehicle=_vehicle(tree.vehicle, layers),
        link=tree.link,
        movers=tree.movers,
        faults=tree.faults,
        boat_file=boat_file,
    )


def scenario_names() -> list[str]:
    return sorted(path.stem for path in SCENARIOS.glob("*.toml"))


def _find(source: str) -> tuple[Path, Layer]:
    """The scenario's file and its tree; for a GeoJSON map, one that consists of the map."""
    path = Path(source)
    if path.suffix in {".geojson", ".json"}:
        return path, Layer(source, {"map": {"file": path.name}})
    if path.suffix != ".toml":
        path = SCENARIOS / f"{source}.toml"
        if source not in scenario_names():
            known = ", ".join(scenario_names())
            raise ConfigError(
                f"{source}: no such scenario: expected one of {known}, or a .toml or .geojson file"
            )
    return path, Layer(str(path) if path.parent != SCENARIOS else path.name, load_toml(path))


def _boat_file(layers: Sequence[Layer], folder: Path) -> Path:
    table = merge(layers).get("boat", {})
    model = table.get("model", DEFAULT_BOAT) if isinstance(table, dict) else DEFAULT_BOAT
    if not isinstance(model, str):
        raise ConfigError(explain("Expected `str` - at `$.boat.model`", layers))
    if model.endswith(".toml"):  # of a scenario, beside it; of the command line, as any path there
        return Path(model) if _at(layers[-1].tree, "boat", "model") == model else folder / model
    path = BOATS / f"{model}.toml"
    if not path.is_file() or path.parent != BOATS:
        known = ", ".join(sorted(boat.stem for boat in BOATS.glob("*.toml")))
        raise ConfigError(
            explain(
                f"no boat {model!r}: expected one of {known}, or a .toml file - at `$.boat.model`", layers
            )
        )
    return path


def _drawn(layers: Sequence[Layer]) -> list[Layer]:
    """The random world that the layers ask for, if they ask for one."""
    dice = decode(layers, RandomSource)
    if dice.random is None:
        return []
    try:
        return [Layer("random", random_world(dice.random, dice.seed))]
    except ValueError as error:
        raise ConfigError(f"{layers[0].name}: {error}") from None


def _with_classes(layers: Sequence[Layer]) -> list[Layer]:
    """The layers, with a further one below each that names the class of a sensor. So its own keys, and those
    of later layers, change single figures. An unknown class is left to the decoder.
    """
    out: list[Layer] = []
    for layer in layers:
        for (table, key), classes in CLASSES.items():
            name = _at(layer.tree, "sensors", table, key)
            if isinstance(name, str) and name in classes:
                out.append(Layer(f"{table} {name}", {"sensors": {table: classes[name]}}))
        out.append(layer)
    return out


def _at(tree: object, *keys: str) -> object:
    for key in keys:
        if not isinstance(tree, Mapping):
            return None
        tree = tree.get(key)
    return tree


def _vehicle(tree: Table, layers: Sequence[Layer]) -> BoatConfig:
    try:
        return decode_config(tree, "")
    except ConfigError as error:
        raise ConfigError(explain(str(error).removeprefix(": "), layers, root="vehicle")) from None


def _start(
    given: tuple[float, float] | Global | None, route_start: Point | None, chart: Chart, name: str
) -> Point:
    """Where the boat is put: its own start, else the route's, else the origin or some point on the water."""
    if isinstance(given, Global):
        start = chart.frame.to_local(LatLon(given.lat_deg, given.lon_deg))
    elif given is not None:
        start = Point(north_m=given[1], east_m=given[0])
    elif route_start is not None:
        start = route_start
    elif chart.is_open:
        start = Point(0.0, 0.0)
    else:
        middle = chart.water.representative_point()
        start = Point(north_m=middle.y, east_m=middle.x)
    if not shapely.contains_xy(chart.water, start.east_m, start.north_m):
        at = f"[{start.east_m:g}, {start.north_m:g}]"
        raise ConfigError(f"{name}: boat.start: {at} is not on the water ({chart.nearest_feature(start)})")
    return start


def _heading_rad(heading_deg: float | None, start: Point, goal: Point | None) -> float:
    if heading_deg is not None:
        return math.radians(heading_deg)
    return bearing_rad(start, goal) if goal is not None and distance_m(start, goal) > 0.0 else 0.0
