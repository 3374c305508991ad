"""The boat and its world in one process, tick by tick, as fast as possible.

Time is counted in ticks: a run is a function of the scenario, its seed and the station's messages.
"""

import math

from companion.boat import COMPONENT_ID, TICK_S, Boat
from companion.config.boat_config import LinkConfig
from companion.core.storage import MemoryStorage, Storage
from companion.hal.interfaces import Hardware
from companion.links.memory import MemoryLink, MemoryPort, memory_pair
from companion.log.logbook import Logbook
from companion.mavlink.address import Address
from companion.router.policy import ConfiguredPort, Policy
from sitl.run.air import Air, AirPort
from sitl.run.lidar import LidarComponent
from sitl.run.program import Program
from sitl.run.station import Station
from sitl.world.computer import Disk
from sitl.world.scenario import Scenario
from sitl.world.world import World

_STREAM_HZ = 2.0  # half the usual telemetry rate


class Lockstep:
    """One boat, its world, and a station on a memory link."""

    def __init__(
        self,
        scenario: Scenario,
        storage: Storage | None = None,
        logbook: Logbook | None = None,
        *,
        world: World | None = None,
        hardware: Hardware | None = None,
    ) -> None:
        """storage and logbook outlive the boat's program, which a power cut ends. world, hardware: by default
        those of the scenario.
        """
        self.world = world or World(scenario)
        self._hardware = hardware or self.world.hardware
        computer = self.world.electronics.computer
        self._storage = Disk(storage or MemoryStorage(), computer)
        self._logbook = logbook
        self._air = Air(scenario.link, scenario.seed, computer, lambda: self.world.time_s)
        near, far = memory_pair("station")
        self._near: MemoryLink | None = near
        lidar, system_id = scenario.sensors.lidar, scenario.vehicle.identity.system_id
        self._lidar = LidarComponent(lidar, scenario.seed, system_id) if lidar.fitted else None
        self.station = Station(far, Address(scenario.vehicle.identity.system_id, COMPONENT_ID))
        self._program = Program(self.world, self._build)

    @property
    def boat(self) -> Boat:
        """The boat's program; another one after a power cut."""
        return self._program.boat

    @property
    def time_s(self) -> float:
        """Simulated seconds since boot."""
        return self.world.time_s

    @property
    def mover_heard_s(self) -> float:
        """When a ranger first heard a mover; infinite if none did."""
        parts = (self.world.electronics.sonar, self._lidar)
        return min((part.mover_heard_s for part in parts if part is not None), default=math.inf)

    def step(self) -> None:
        """One tick: a step of the boat, then a step of the world."""
        now_s = self.world.time_s
        self._program.step()
        self.station.step(now_s)
        if self._lidar is not None:
            self._lidar.step(self.world)
        self._advance()

    def _advance(self) -> None:
        """The world goes on by a tick."""
        self.world.step(TICK_S)

    def _build(self) -> Boat:
        near, self._near = self._near, None
        if near is None:
            near, far = memory_pair("station")
            self.station.connect(far)
        policy = Policy(LinkConfig(url="memory", stream_hz=_STREAM_HZ))
        ports = [ConfiguredPort(AirPort(MemoryPort(near), self._air), policy)]
        if self._lidar is not None:
            near, far = memory_pair("lidar")
            self._lidar.connect(far)
            ports.append(ConfiguredPort(MemoryPort(near), Policy(LinkConfig(url="lidar", stream_hz=0.0))))
        vehicle = self.world.scenario.vehicle
        return Boat(vehicle, self._hardware, ports, self._storage, logbook=self._logbook)

    def close(self) -> None:
        """Close everything."""
        self.boat.close()
