"""A whole boat in simulated water with stations on memory links, for tests: no clock, no socket, no sleep."""

import dataclasses
from collections import defaultdict
from collections.abc import Callable
from functools import cache
from typing import Any, Self

from companion.autopilot.sensor_suite import READ_S
from companion.boat import TICK_S, Boat
from companion.config.boat_config import BoatConfig, with_value
from companion.core.geo import LatLon, LocalFrame, Point
from companion.core.readings import BatteryReading, GnssFix
from companion.core.state import NavState
from companion.core.storage import MemoryStorage, Storage
from companion.core.units import deg_to_e7
from companion.hal.interfaces import Hardware
from companion.links.interfaces import Link
from companion.links.memory import MemoryPort, memory_pair
from companion.mavlink.address import Address
from companion.mavlink.codec import Decoder, Encoder
from companion.mavlink.dialect import Message, dialect
from companion.mavlink.items import MissionItem, MissionType
from companion.mavlink.sender import Sender
from companion.mavlink.transfer import Completed, Failed
from sitl.scenarios.scenario import load_scenario
from sitl.world.scenario import Scenario
from sitl.world.world import World

BOAT = Address(1, 1)
QGC = Address(255, 190)
PLANNER = Address(245, 191)
OK, DENIED, UNSUPPORTED, FAILED = 0, 2, 3, 4  # MAV_RESULT


# Receiver and ranger of tests about control, whose errors are those of steering and planning. The pool has a
# camera.
RTK = "sensors.gnss.receiver=rtk"
IDEAL = "sensors.sonar.ranger=ideal"
STANDALONE = "sensors.gnss.receiver=standalone"  # the boats' own,
HCSR04 = "sensors.sonar.ranger=hcsr04"  # and their ranger


@cache
def scenario(source: str = "open", *settings: str, case: str | None = None) -> Scenario:
    """A scenario, read once, with RTK and an ideal ranger unless the settings name others."""
    return load_scenario(source, settings if source == "pool" else (RTK, IDEAL, *settings), case)


def waypoint(
    north_m: float, east_m: float, source: str = "open", command: int = 16, **values: float
) -> MissionItem:
    """A mission item at a place of the scenario's frame."""
    place = scenario(source).frame.to_global(scenario(source).start._replace(north_m=north_m, east_m=east_m))
    x, y = deg_to_e7(place.lat_deg), deg_to_e7(place.lon_deg)
    return MissionItem(frame=3, command=command, x=x, y=y, z=50.0, **{"param4": float("nan"), **values})  # type: ignore[arg-type]


HOME_ITEM = MissionItem(frame=0, command=16, x=500000000, y=-12000000)


class Peer:
    """A station at the far end of a link. Keeps everything that it has heard."""

    def __init__(self, link: Link, address: Address) -> None:
        self.link = link
        self.address = address
        self.heard: list[Message] = []
        self._by_name: dict[str, list[Message]] = defaultdict(list)
        self._decoder = Decoder(datagram=link.is_datagram)
        self._encoder = Encoder(address)

    def send(self, message: Message) -> None:
        """One frame to the boat."""
        assert self.link.send(self._encoder.encode(message))

    def listen(self) -> list[Message]:
        """What has come since the last call; kept in `heard` too."""
        new = [r.message for chunk in self.link.receive() for r in self._decoder.feed(chunk)]
        self.heard += new
        for message in new:
            self._by_name[message.get_type()].append(message)
        return new

    def said(self, name: str) -> list[Message]:
        """All messages of a type heard so far."""
        self.listen()
        return list(self._by_name[name])

    def forget(self) -> None:
        """Start with an empty memory."""
        self.listen()
        self.heard.clear()
        self._by_name.clear()

    @property
    def texts(self) -> list[str]:
        """STATUSTEXT lines heard so far, chunks joined."""
        lines: dict[tuple[int, int], str] = {}
        for number, message in enumerate(self.said("STATUSTEXT")):
            key = (message.id, 0) if message.id else (0, number)
            lines[key] = lines.get(key, "") + str(message.text).rstrip("\0")
        return list(lines.values())

    def heartbeat(self, mav_type: int = dialect.MAV_TYPE_GCS) -> None:
        """Announce this station."""
        self.send(dialect.MAVLink_heartbeat_message(mav_type, dialect.MAV_AUTOPILOT_INVALID, 0, 0, 4, 3))

    def command(self, number: int, *params: float) -> None:
        """COMMAND_LONG."""
        values = [*params, *([0.0] * (7 - len(params)))]
        self.send(dialect.MAVLink_command_long_message(*BOAT, number, 0, *values))

    def command_int(self, number: int, *params: float, x: int = 0, y: int = 0, frame: int = 3) -> None:
        """COMMAND_INT."""
        values = [*params, *([0.0] * (4 - len(params)))]
        self.send(dialect.MAVLink_command_int_message(*BOAT, frame, number, 0, 0, *values, x, y, 0.0))


class Rig:
    """One boat, its water, and any number of stations."""

    def __init__(
        self,
        source: str = "open",
        *settings: str,
        storage: Storage | None = None,
        config: dict[str, object] | None = None,
        case: str | None = None,
        **parts: object,
    ) -> None:
        """config: values of the boat's own configuration by path. parts: hardware of the test's own."""
        self.scenario = scenario(source, *settings, case=case)
        self.world = World(self.scenario)
        self.storage = storage or MemoryStorage()
        self.port = MemoryPort()
        vehicle: BoatConfig = self.scenario.vehicle
        for path, value in (config or {}).items():
            vehicle = with_value(vehicle, path, value)
        self.config = vehicle
        self.hardware: Hardware = dataclasses.replace(self.world.hardware, **parts)  # type: ignore[arg-type]
        self.boat = self._build()
        self.peer = self.connect()

    def _build(self) -> Boat:
        return Boat(self.config, self.hardware, [self.port], self.storage)

    def reboot(self) -> None:
        """The boat's computer starts anew: memory is gone, storage is not."""
        self.port = MemoryPort()
        self.boat = self._build()
        self.peer = self.connect()

    @property
    def now_s(self) -> float:
        """Simulated seconds."""
        return self.world.time_s

    @property
    def mode(self) -> str:
        """The boat's mode by name."""
        return self.boat.vehicle.mode.name

    def connect(self, address: Address = QGC, is_datagram: bool = True) -> Peer:
        """A further station on a link of its own."""
        near, far = memory_pair(f"station {address}", is_datagram)
        self.port.offer(near)
        self.boat.receive(
            self.world.clock_s, (near.fileno(),)
        )  # as the runner has it: a new link is heard at once
        return Peer(far, address)

    def step(self, ticks: int = 1) -> None:
        """Let the boat act, then the water move on."""
        for _ in range(ticks):
            self.boat.step(self.world.time_s)
            self.world.step(TICK_S)

    def run(self, seconds: float) -> None:
        """Simulated time goes by."""
        self.step(round(seconds / TICK_S))

    def until(self, is_so: Callable[[], bool], limit_s: float) -> float:
        """Step until something is so; the seconds that it took. Fails when it takes longer than limit_s."""
        began_s = self.now_s
        while not is_so():
            assert self.now_s - began_s < limit_s, f"not within {limit_s} s"
            self.step()
        return self.now_s - began_s

    def receive(self) -> None:
        """Let the boat hear its links between two ticks."""
        self.boat.receive(self.world.time_s)

    def ask(self, number: int, *params: float, peer: Peer | None = None) -> int:
        """Send a COMMAND_LONG; its MAV_RESULT, which must come before the next tick."""
        peer = peer or self.peer
        peer.forget()
        peer.command(number, *params)
        self.receive()
        (ack,) = [one for one in peer.said("COMMAND_ACK") if one.command == number]
        assert (ack.target_system, ack.target_component) == tuple(peer.address)
        return int(ack.result)

    def answer_to(self, message: Message, name: str, peer: Peer | None = None) -> Message:
        """Send a message and return the one answer of this type, which must come before the next tick."""
        peer = peer or self.peer
        peer.forget()
        peer.send(message)
        self.receive()
        (answer,) = peer.said(name)
        return answer

    def set_mode(self, number: int) -> int:
        """DO_SET_MODE as ground stations send it."""
        return self.ask(dialect.MAV_CMD_DO_SET_MODE, 1.0, number)

    def arm(self, force: bool = False) -> int:
        """COMPONENT_ARM_DISARM."""
        return self.ask(dialect.MAV_CMD_COMPONENT_ARM_DISARM, 1.0, 2989.0 if force else 0.0)

    def ready(self) -> Self:
        """Run until the boat may be armed in a mode that needs a position."""
        self.run(1.0)
        self.until(lambda: self.boat.vehicle.nav is not None and not self.boat.vehicle.arming_faults(), 30.0)
        return self

    def upload(
        self,
        items: list[MissionItem],
        peer: Peer | None = None,
        mission_type: MissionType = MissionType.MISSION,
    ) -> Completed | Failed:
        """Upload a list as a station does; how it ended."""
        peer = peer or self.peer
        sender = Sender(peer.address, mission_type)
        sender.offer(items, BOAT, self.now_s)
        for _ in range(20 * len(items) + 1000):
            for message in sender.take_outbox():
                peer.send(message)
            self.receive()
            heard = peer.listen()
            for message in heard:
                if message.get_type().startswith("MISSION_"):
                    sender.handle(message, BOAT, self.now_s)
            for event in sender.take_events():
                if isinstance(event, Completed | Failed):
                    return event
            if not heard:
                self.step()
                sender.tick(self.now_s)
        raise AssertionError("the upload never ended")

    def items(self, mission_type: MissionType = MissionType.MISSION) -> tuple[MissionItem, ...]:
        """What the boat holds."""
        return self.boat.endpoint._missions.items(mission_type)

    def sail(self, *items: MissionItem) -> Self:
        """Make ready, upload home and these, arm and start."""
        self.ready()
        assert isinstance(self.upload([HOME_ITEM, *items]), Completed)
        assert self.arm() == OK
        assert self.ask(dialect.MAV_CMD_MISSION_START) == OK
        return self

    def offset_m(self, north_m: float, east_m: float) -> float:
        """How far the boat truly is from a place."""
        truth = self.world.truth
        return float(((truth.north_m - north_m) ** 2 + (truth.east_m - east_m) ** 2) ** 0.5)

    def fingerprint(self) -> tuple[Any, ...]:
        """All that a hostile frame must not change."""
        vehicle = self.boat.vehicle
        lists = tuple(self.items(kind) for kind in MissionType)
        mode = (vehicle.mode, vehicle.armed, vehicle.home, vehicle.modes.guided.target, vehicle.speed_m_s)
        parameters = self.boat.parameters
        values = tuple(parameters.value(row) for row in parameters.rows)
        return lists, mode, vehicle.progress.mission, vehicle.progress.current_seq, values, parameters.config


class Silent:
    """A receiver or compass that never says anything."""

    def read(self) -> None:
        """Nothing."""

    def close(self) -> None:
        """Nothing to let go."""


class FakeBattery:
    """A battery monitor whose reading the test sets."""

    def __init__(self, voltage_v: float) -> None:
        self.voltage_v = voltage_v
        self.time_s = 0.0

    def read(self) -> BatteryReading:
        """The reading of now."""
        self.time_s += READ_S
        return BatteryReading(self.time_s, self.voltage_v, 1.0)

    def close(self) -> None:
        """Nothing to let go."""


def nav_at(north_m: float = 0.0, east_m: float = 0.0, time_s: float = 0.0, age_s: float = 0.0) -> NavState:
    """A boat at rest at a place, bow north."""
    return NavState(time_s, north_m, east_m, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, age_s, age_s)


ORIGIN = LatLon(50.0, -1.2)
FRAME = LocalFrame(ORIGIN)
GOOD_FIX = GnssFix(0.0, ORIGIN, 3, 12, 0.8)


def place(north_m: float, east_m: float) -> LatLon:
    """A position in FRAME as the globe has it."""
    return FRAME.to_global(Point(north_m, east_m))
