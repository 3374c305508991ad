"""Several boats in one process: system ids, start positions and shared links."""

import dataclasses
import math
from collections.abc import Iterator, Sequence
from functools import partial

import msgspec

from companion.app.runner import Clock
from companion.config.boat_config import LinkConfig
from companion.core.errors import ConfigError
from companion.core.geo import Point
from companion.links.interfaces import Port
from companion.links.memory import MemoryPort, memory_pair
from companion.router.policy import ConfiguredPort, Policy
from sitl.run.serve import stretched
from sitl.run.simulated_boat import BoatOptions, SimulatedBoat
from sitl.world.scenario import Scenario

MOST_BOATS = 200
# Between neighbours. Stations draw boats 3 lengths apart on one place: only where there is no more room
SPACINGS_LENGTHS = (10.0, 3.0)
PORT_STEP = 10  # from one boat's TCP port to the next one's, as ArduPilot's simulator has it
_PLACES_A_BOAT = 200


def fleet(scenario: Scenario, count: int) -> list[Scenario]:
    """The scenario once for each boat, with system ids and seeds counting up and separate starts.

    The boats do not see or touch each other. Raises ConfigError: ids beyond 255, or not enough water about
    the start.
    """
    first = scenario.vehicle.identity.system_id
    if not 1 <= count <= MOST_BOATS or first + count - 1 > 255:
        most = min(MOST_BOATS, 256 - first)
        raise ConfigError(f"--count {count}: expected 1 to {most}, as the first boat is system {first}")
    boats, own = [], scenario.vehicle
    for number, place in enumerate(_places(scenario, count)):
        identity = msgspec.structs.replace(own.identity, system_id=first + number)
        vehicle = msgspec.structs.replace(own, identity=identity)
        seed = scenario.seed + number
        boats.append(dataclasses.replace(scenario, seed=seed, start=place, vehicle=vehicle))
    return boats


def start_fleet(
    scenarios: Sequence[Scenario],
    links: Sequence[Sequence[LinkConfig]],
    clock: Clock,
    boat_options: Sequence[BoatOptions],
    speedup: float = 1.0,
) -> list[SimulatedBoat]:
    """The boats with their links. Those without a link of their own are reached through the first.

    Raises ConfigError, LinkError: a url that cannot be read, or that the system refuses; StorageError: a
    state folder cannot be used.
    """
    boats: list[SimulatedBoat] = []
    bridges: list[Bridge] = []
    try:
        for scenario, own, options in reversed(list(zip(scenarios, links, boat_options, strict=True))):
            is_first = scenario is scenarios[0]
            shared = tuple(partial(bridge.port, 0) for bridge in bridges) if is_first else ()
            if not is_first and not own:
                bridges.append(Bridge(f"boat {scenario.vehicle.identity.system_id}"))
                shared = (partial(bridges[-1].port, 1),)
            own_config = stretched(scenario.vehicle, speedup)
            sailed = dataclasses.replace(scenario, vehicle=own_config)
            boats.insert(0, SimulatedBoat(sailed, own, clock, dataclasses.replace(options, ports=shared)))
    except Exception:
        for boat in boats:
            boat.close()
        raise
    return boats


def _places(scenario: Scenario, count: int) -> list[Point]:
    """The start, and the nearest places round it, on rings, that leave room for a boat."""
    length_m, found = scenario.hull.length_m, list[Point]()
    for lengths in SPACINGS_LENGTHS:
        found = []
        for place in _rings(scenario.start, lengths * length_m, count * _PLACES_A_BOAT):
            is_free = scenario.chart.is_open or scenario.chart.clearance_m(place) >= length_m
            if is_free or place == scenario.start:
                found.append(place)
            if len(found) == count:
                return found
    raise ConfigError(f"--count {count}: the water about the start has room for {len(found)} boats")


def _rings(centre: Point, spacing_m: float, most: int) -> Iterator[Point]:
    yield centre
    given, ring = 1, 0
    while given < most:
        ring += 1
        on_ring = 6 * ring
        for number in range(on_ring):
            yield centre.moved(math.tau * number / on_ring, ring * spacing_m)
        given += on_ring


class Bridge:
    """Two ends, 0 and 1. A boat that loses its power closes its port, and with it the other's link."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._ports: list[MemoryPort | None] = [None, None]

    def port(self, end: int) -> Port:
        """For the program that begins at this end; the port of the one before must be closed."""
        own, other = MemoryPort(name=self._name), self._ports[1 - end]
        self._ports[end] = own
        if other is not None:
            near, far = memory_pair(self._name)
            own.offer(near)
            other.offer(far)
        # A boat beyond the bridge streams only what was requested at the far end
        return ConfiguredPort(own, Policy(LinkConfig(url="memory")))
