import contextlib
import socket
from collections.abc import Callable

import pytest
from boat_rig import scenario
from fake_clock import FakeClock

from companion.config.boat_config import BoatConfig
from companion.mavlink.address import Address
from companion.mavlink.codec import Decoder, Encoder
from companion.mavlink.dialect import dialect
from sitl.run.serve import Server, SpeedMonitor, stretched
from sitl.run.simulated_boat import BoatOptions, SimulatedBoat


@pytest.mark.parametrize("speedup", [1.0, 10.0])
def test_the_timers_that_wait_for_stations_are_stretched_and_nothing_else_is(speedup: float) -> None:
    before = BoatConfig()
    after = stretched(before, speedup)
    assert after.failsafe.gcs_timeout_s == before.failsafe.gcs_timeout_s * speedup
    assert after.failsafe.manual_timeout_s == before.failsafe.manual_timeout_s * speedup
    assert after.arming.repeat_s == before.arming.repeat_s * speedup  # stations list each report
    assert after.mavlink.retry_s == before.mavlink.retry_s * speedup
    assert after.failsafe.battery_low_s == before.failsafe.battery_low_s
    assert after.motors == before.motors
    assert after.guidance == before.guidance
    if speedup == 1.0:
        assert after == before


def test_the_water_moves_speedup_times_as_fast_as_the_clock() -> None:
    clock = FakeClock()
    simulated = SimulatedBoat(scenario("open"), [], clock, BoatOptions(record=True))
    Server([simulated], clock, 5.0).run(lambda: clock.time_s >= 2.0)
    assert simulated.world.time_s == pytest.approx(10.0, abs=0.1)
    assert len(simulated.recorder) == simulated.world.tick


class BusyHost(FakeClock):
    """A host on which whatever happens between two looks at the clock takes 30 ms: more than a tick."""

    def now_s(self) -> float:
        """The time, later at every call."""
        self.time_s += 0.03
        return self.time_s


def texts_of(simulated_boats: list[SimulatedBoat], serve: Callable[[], object]) -> set[str]:
    """What the first boat says on its UDP link meanwhile."""
    address = ("127.0.0.1", int(simulated_boats[0].port_names[0].rsplit(":", 1)[1]))
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as station:
        station.setblocking(False)
        heartbeat = dialect.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3)
        station.sendto(Encoder(Address(255, 190)).encode(heartbeat), address)
        serve()
        decoder, texts = Decoder(datagram=True), set()
        with contextlib.suppress(BlockingIOError):
            while True:
                for received in decoder.feed(station.recv(4096)):
                    if received.message.get_type() == "STATUSTEXT":
                        texts.add(str(received.message.text).rstrip("\0"))
    return texts


def test_on_a_host_that_cannot_keep_up_time_stretches_and_the_boat_is_not_overloaded() -> None:
    clock, lines = BusyHost(), list[str]()
    simulated = SimulatedBoat(scenario("open"), ["udpin:127.0.0.1:0"], clock)
    server = Server([simulated], clock, 1.0, lines.append)

    def is_over() -> bool:
        if simulated.world.time_s >= 4.0 and not simulated.boat.vehicle.armed:
            simulated.boat.vehicle.arm(force=True)  # only then are failsafes on watch
        return simulated.world.time_s >= 12.0

    texts = texts_of([simulated], lambda: server.run(is_over))
    assert server.load > 1.0
    assert simulated.boat.load <= 1.0
    assert texts
    assert not [text for text in texts if "overloaded" in text]
    assert clock.time_s > 12.0
    (line,) = lines
    assert "1 × real time" in line


@pytest.mark.parametrize(("share", "is_said"), [(0.79, True), (0.81, False)])
def test_a_host_a_fifth_too_slow_is_reported_once(share: float, is_said: bool) -> None:
    lines = list[str]()
    pace = SpeedMonitor(2.0, lines.append)
    for tick in range(2000):
        pace.tick(tick * 0.01 / share, 0.02)
    assert len(lines) == is_said
