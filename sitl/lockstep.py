"""The boat and its water in one process, tick by tick, as fast as the machine goes.

Time is counted in ticks, so a run is a function of the scenario, its seed and what the station says.
"""

from companion.boat import COMPONENT_ID, TICK_S, Boat
from companion.config import LinkConfig
from companion.hal.memory import MemoryPort, memory_pair
from companion.log.logbook import Logbook
from companion.mavlink.address import Address
from companion.router.configured_port import ConfiguredPort
from companion.router.policy import Policy
from companion.storage import MemoryStorage, Storage
from sitl.scenario import Scenario
from sitl.station import Station
from sitl.world import World

_STREAM_HZ = 2.0  # half the usual telemetry: this station reads results, it watches no instruments


class Lockstep:
    """One boat, its world, and a station on a memory link."""

    def __init__(
        self, scenario: Scenario, storage: Storage | None = None, logbook: Logbook | None = None
    ) -> None:
        near, far = memory_pair("station")
        self.world = World(scenario)
        self.boat = Boat(
            scenario.vehicle,
            self.world.hardware,
            [ConfiguredPort(MemoryPort(near), Policy(LinkConfig(url="memory", stream_hz=_STREAM_HZ)))],
            storage or MemoryStorage(),
            logbook=logbook,
        )
        self.station = Station(far, Address(scenario.vehicle.identity.system_id, COMPONENT_ID))

    @property
    def time_s(self) -> float:
        """Simulated seconds since boot."""
        return self.world.time_s

    def step(self) -> None:
        """One tick: the boat acts on what its sensors say now, then the water moves on."""
        now_s = self.world.time_s
        self.boat.step(now_s)
        self.station.step(now_s)
        self.world.step(TICK_S)

    def close(self) -> None:
        """Let everything go."""
        self.boat.close()
