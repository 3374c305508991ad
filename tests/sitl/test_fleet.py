"""Several boats in one process."""

import math
import socket

import pytest
from boat_rig import scenario
from fake_clock import FakeClock

from companion.config import LinkConfig
from companion.errors import ConfigError
from companion.geo import distance_m
from companion.mavlink.address import Address
from companion.mavlink.codec import Decoder, Encoder
from companion.mavlink.dialect import dialect
from companion.vehicle.modes import Mode
from sitl.craft import Berth
from sitl.fleet import fleet, moor
from sitl.serve import Server


def test_ids_and_seeds_count_up_and_places_lie_apart() -> None:
    boats = fleet(scenario("lake"), 12)
    assert [boat.vehicle.identity.system_id for boat in boats] == list(range(1, 13))
    assert len({boat.seed for boat in boats}) == 12
    places = [boat.start for boat in boats]
    assert min(distance_m(a, b) for a in places for b in places if a is not b) > boats[0].hull.length_m
    assert all(boat.chart.clearance_m(boat.start) >= boat.hull.length_m for boat in boats)
    assert places[0] == scenario("lake").start


@pytest.mark.parametrize("count", [0, 201, 256])
def test_a_fleet_that_the_ids_cannot_tell_apart_is_refused(count: int) -> None:
    with pytest.raises(ConfigError, match="--count"):
        fleet(scenario("open"), count)


def test_a_pool_too_small_for_the_fleet_is_said() -> None:
    with pytest.raises(ConfigError, match="room for"):
        fleet(scenario("pool"), 100)


def test_every_boat_sails_in_its_own_water() -> None:
    boats, clock = fleet(scenario("open"), 5), FakeClock()
    crafts = moor(boats, [[]] * 5, clock, [Berth()] * 5)
    for number, craft in enumerate(crafts):
        craft.boat.vehicle.mode = Mode.MANUAL
        craft.world.hardware.motors.write(0.1 * number, 0.1 * number)
    Server(crafts, clock).run(lambda: clock.time_s >= 0.5)
    assert [craft.world.tick for craft in crafts] == [crafts[0].world.tick] * 5
    assert all(craft.world.tick > 20 for craft in crafts)


def test_one_port_reaches_every_boat_and_each_answers_for_itself() -> None:
    boats, clock = fleet(scenario("open"), 3), FakeClock()
    links = [[LinkConfig(url="udpin:127.0.0.1:0")], [], []]
    crafts = moor(boats, links, clock, [Berth()] * 3)
    server = Server(crafts, clock)
    number = int(crafts[0].port_names[0].rsplit(":", 1)[1])
    encoder, decoder = Encoder(Address(255, 190)), Decoder(datagram=True)
    heard: set[tuple[str, int]] = set()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as station:
        station.setblocking(False)
        for tick in range(150):
            if tick % 10 == 0:
                ping = dialect.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3)
                station.sendto(encoder.encode(ping), ("127.0.0.1", number))
            if tick == 80:
                for system in (1, 2, 3):
                    ask = dialect.MAVLink_param_request_read_message(system, 1, b"HDG_KP", -1)
                    station.sendto(encoder.encode(ask), ("127.0.0.1", number))
            server._step(tick)
            clock.sleep(0.02)
            while True:
                try:
                    received = decoder.feed(station.recv(4096))
                except BlockingIOError:
                    break
                heard |= {(one.message.get_type(), one.sender.system) for one in received}
    server.run(lambda: True)
    assert {("HEARTBEAT", 1), ("HEARTBEAT", 2), ("HEARTBEAT", 3)} <= heard
    assert {("PARAM_VALUE", 1), ("PARAM_VALUE", 2), ("PARAM_VALUE", 3)} <= heard
    assert {system for _, system in heard} == {1, 2, 3}


def test_places_stay_within_reach_of_the_start() -> None:
    boats = fleet(scenario("open"), 50)
    far = max(distance_m(boat.start, boats[0].start) for boat in boats)
    assert far <= 3.0 * boats[0].hull.length_m * math.ceil(math.sqrt(50 / 3))
