"""Several boats in one process."""

import contextlib
import dataclasses
import socket

import pytest
from boat_rig import scenario
from fake_clock import FakeClock

from companion.config.boat_config import LinkConfig
from companion.core.errors import ConfigError
from companion.core.geo import distance_m
from companion.mavlink.address import Address
from companion.mavlink.codec import Decoder, Encoder
from companion.mavlink.dialect import Message, dialect
from sitl.run.fleet import fleet, start_fleet
from sitl.run.serve import Server
from sitl.run.simulated_boat import BoatOptions
from sitl.world.scenario import Scenario


def test_ids_and_seeds_count_up_and_places_lie_apart() -> None:
    boats = fleet(scenario("lake"), 12)
    assert [boat.vehicle.identity.system_id for boat in boats] == list(range(1, 13))
    assert len({boat.seed for boat in boats}) == 12
    places = [boat.start for boat in boats]
    apart_m = min(distance_m(a, b) for a in places for b in places if a is not b)
    assert apart_m > 9.0 * boats[0].hull.length_m  # far enough to be two on a station's map
    assert all(boat.chart.clearance_m(boat.start) >= boat.hull.length_m for boat in boats)
    assert places[0] == scenario("lake").start


@pytest.mark.parametrize("count", [0, 201])
def test_a_fleet_that_the_ids_cannot_tell_apart_is_refused(count: int) -> None:
    with pytest.raises(ConfigError, match="--count"):
        fleet(scenario("open"), count)


class OnePort:
    """A fleet behind its first boat's link, and a station that talks to it."""

    def __init__(self, boats: list[Scenario]) -> None:
        links = [[LinkConfig(url="udpin:127.0.0.1:0")], *([[]] * (len(boats) - 1))]
        self.clock = FakeClock()
        self.simulated_boats = start_fleet(boats, links, self.clock, [BoatOptions()] * len(boats))
        self.server = Server(self.simulated_boats, self.clock)
        self.heard: set[tuple[str, int]] = set()
        self._at = ("127.0.0.1", int(self.simulated_boats[0].port_names[0].rsplit(":", 1)[1]))
        self._encoder, self._decoder = Encoder(Address(255, 190)), Decoder(datagram=True)
        self._station = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._station.setblocking(False)
        self._ticks = 0

    def run(self, seconds: float) -> None:
        """Let them live while the station shows itself."""
        self.heard.clear()
        for _ in range(round(seconds / 0.02)):
            if self._ticks % 10 == 0:
                self.send(dialect.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3))
            self.server._step(self._ticks)
            self._ticks += 1
            self.clock.sleep(0.02)
            with contextlib.suppress(BlockingIOError):
                while True:
                    received = self._decoder.feed(self._station.recv(4096))
                    self.heard |= {(one.message.get_type(), one.sender.system) for one in received}

    def send(self, message: Message) -> None:
        """One frame to all."""
        self._station.sendto(self._encoder.encode(message), self._at)

    def answering(self) -> set[int]:
        """Who answers when asked."""
        for simulated in self.simulated_boats:
            system = simulated.boat.parameters.config.identity.system_id
            self.send(dialect.MAVLink_param_request_read_message(system, 1, b"HDG_KP", -1))
        self.run(0.4)
        return {system for name, system in self.heard if name == "PARAM_VALUE"}

    def close(self) -> None:
        """Let everything go."""
        self._station.close()
        self.server.run(lambda: True)


def test_one_port_reaches_every_boat_and_each_answers_for_itself() -> None:
    fleet_ = OnePort(fleet(scenario("open"), 3))
    fleet_.run(2.0)
    assert {("HEARTBEAT", 1), ("HEARTBEAT", 2), ("HEARTBEAT", 3)} <= fleet_.heard
    assert {system for _, system in fleet_.heard} == {1, 2, 3}
    assert fleet_.answering() == {1, 2, 3}
    fleet_.close()


@pytest.mark.parametrize(("cut", "left"), [((1,), {1, 3}), ((0, 1), set())])
def test_one_port_reaches_every_boat_again_once_its_power_is_back(
    cut: tuple[int, ...], left: set[int]
) -> None:
    dark = scenario("open", 'faults=[{what="computer", at_s=1, for_s=1}]').faults
    boats = fleet(scenario("open"), 3)
    for number in cut:
        boats[number] = dataclasses.replace(boats[number], faults=dark)
    fleet_ = OnePort(boats)
    fleet_.run(1.2)
    assert fleet_.answering() == left
    fleet_.run(2.0)
    assert fleet_.answering() == {1, 2, 3}
    assert len(fleet_.simulated_boats[0].boat.channels.open) == 3  # links that have ended are forgotten
    assert len(fleet_.simulated_boats[1].boat.channels.open) == 1
    fleet_.close()
