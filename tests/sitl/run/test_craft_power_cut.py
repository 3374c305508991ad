"""A boat behind real ports whose power is cut: they fall silent, and are the same ones again after it."""

import socket

from boat_rig import scenario
from fake_clock import FakeClock

from companion.app.runner import Runner
from companion.mavlink.address import Address
from companion.mavlink.codec import Decoder, Encoder
from companion.mavlink.dialect import dialect
from sitl.run.simulated_boat import SimulatedBoat

CUT = 'faults=[{what="computer", at_s=2, for_s=3}]'


def live(simulated: SimulatedBoat, clock: FakeClock, seconds: float) -> None:
    """Let the boat live, without waiting for anybody."""
    runner = Runner(clock, 0.02, lambda _: None, lambda _: None, list)
    for _ in range(round(seconds / 0.02)):
        simulated.step(runner)


def heard(station: socket.socket) -> set[str]:
    names = set()
    station.settimeout(0.05)
    try:
        while True:
            names |= {one.message.get_type() for one in Decoder(datagram=True).feed(station.recv(2048))}
    except (TimeoutError, ConnectionRefusedError):
        return names


def test_the_port_is_silent_without_power_and_the_same_one_after_it() -> None:
    clock = FakeClock()
    simulated = SimulatedBoat(scenario("open", CUT), ["udpin:127.0.0.1:0"], clock)
    port = simulated.port_names[0]
    number = int(port.rsplit(":", 1)[1])
    hello = Encoder(Address(255, 190)).encode(dialect.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3))
    before = simulated.boat
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as station:
        station.connect(("127.0.0.1", number))
        station.send(hello)
        live(simulated, clock, 1.5)
        assert "HEARTBEAT" in heard(station)
        live(simulated, clock, 1.0)
        heard(station)
        live(simulated, clock, 2.0)
        assert heard(station) == set()
        live(simulated, clock, 1.0)
        station.send(hello)
        live(simulated, clock, 1.0)
        assert "HEARTBEAT" in heard(station)
    assert simulated.boat is not before
    assert simulated.port_names == [port]
    simulated.close()
