"""From a station's message down to the bridge: the whole boat in lockstep over recorded mock pins."""

from collections.abc import Iterator

import pytest
from boat_rig import QGC, Peer
from hypothesis import given
from hypothesis import strategies as st
from mock_pi import PINS, MockPi

from companion.boat import TICK_S, Boat
from companion.config.boat_config import BoatConfig, Parts
from companion.core.storage import MemoryStorage
from companion.links.memory import MemoryPort, memory_pair
from companion.mavlink.dialect import dialect

MANUAL = 0
CONFIG = BoatConfig(parts=Parts(motors=PINS))


class PinnedBoat:
    """A boat on mock pins in lockstep, with one station."""

    def __init__(self) -> None:
        self.now_s = 10.0
        self.pi = MockPi()
        port = MemoryPort()
        link, far = memory_pair("pins")
        port.offer(link)
        self.station = Peer(far, QGC)
        hardware = self.pi.hardware(CONFIG, lambda: self.now_s)
        self.boat = Boat(CONFIG, hardware, [port], MemoryStorage())
        self.step()

    def step(self, ticks: int = 1) -> None:
        for _ in range(ticks):
            self.now_s += TICK_S
            self.boat.step(self.now_s)
            assert self.boat.vehicle.armed or self.pi.is_off, "not armed, and yet a pin is on"

    def arm(self, value: float = 1.0, magic: float = 0.0) -> None:
        self.station.command(dialect.MAV_CMD_COMPONENT_ARM_DISARM, value, magic)

    def steer(self, throttle_us: int, steering_us: int) -> None:
        channels = [steering_us, 0, throttle_us, 0, 0, 0, 0, 0]
        self.station.send(dialect.MAVLink_rc_channels_override_message(1, 1, *channels))

    def close(self) -> None:
        self.boat.close()
        self.pi.factory.reset()


@pytest.fixture
def pinned() -> Iterator[PinnedBoat]:
    boat = PinnedBoat()
    yield boat
    boat.close()


def sail_by_hand(pinned: PinnedBoat) -> None:
    pinned.station.command(dialect.MAV_CMD_DO_SET_MODE, 1.0, float(MANUAL))
    pinned.arm()
    pinned.steer(1900, 1500)
    pinned.step(30)
    assert pinned.pi.is_driving


PULSES = st.sampled_from([1000, 1200, 1450, 1500, 1550, 1800, 2000])
ACTIONS = st.one_of(
    st.tuples(st.just("steer"), PULSES, PULSES),
    st.tuples(st.just("arm"), st.sampled_from([0.0, 1.0]), st.sampled_from([0.0, 21196.0])),
    st.tuples(st.just("mode"), st.sampled_from([0.0, 4.0, 5.0, 15.0]), st.just(0)),
    st.tuples(st.just("wait"), st.integers(1, 12), st.just(0)),
)


@given(actions=st.lists(ACTIONS, max_size=20))
def test_never_are_both_legs_of_a_motor_on_whatever_the_operator_does(
    actions: list[tuple[str, float, float]],
) -> None:
    pinned = PinnedBoat()
    sail_by_hand(pinned)
    for what, first, second in actions:
        match what:
            case "steer":
                pinned.steer(int(first), int(second))
            case "arm":
                pinned.arm(first, second)
            case "mode":
                pinned.station.command(dialect.MAV_CMD_DO_SET_MODE, 1.0, first)
            case _:
                pinned.step(int(first))
        pinned.step()
    pinned.close()
    assert pinned.pi.is_off
    assert not pinned.pi.both_legs_were_on()
