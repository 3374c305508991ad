"""What garbage on some links costs the boat and other links, counted in looks and ticks, not in seconds."""

import random

import pytest
from boat_rig import BOAT, QGC

from companion.config.boat_config import LinkConfig
from companion.links.memory import MemoryLink, MemoryPort, memory_pair
from companion.mavlink.address import Address
from companion.mavlink.codec import Encoder
from companion.mavlink.dialect import dialect
from companion.router.channels import Channels
from companion.router.policy import ConfiguredPort, Policy

TICK_BYTES = 200_000  # of a link that brings 10 MB/s, in 20 ms
CALL_LOOKS = 256
TICK_LOOKS = 1024
OVERSHOOT = 200  # a search that has begun may end
PATTERNS = {
    "headers": b"\xfd\x00\x00",
    "unknown messages": b"\xfd\xff\x00\x00\x00\x01\x01\x01\xff\x7f",
    "mixed": random.Random(5).randbytes(5000),
}


class NumberedLink(MemoryLink):
    """A link with a descriptor to wait on."""

    descriptor = -1

    def fileno(self) -> int:
        return self.descriptor


class Flooded:
    """Channels with some links that bring garbage and one on which a station announces itself."""

    def __init__(self, pattern: bytes, floods: int = 1, is_datagram: bool = False) -> None:
        port = MemoryPort()
        self.far: list[MemoryLink] = []
        for number in range(floods + 1):
            near = NumberedLink(f"link {number}", is_datagram, 60)
            near.descriptor = 100 + number
            far = MemoryLink(f"far end {number}", is_datagram, 60)
            near._peer, far._peer = far, near
            port.offer(near)
            self.far.append(far)
        self.good = self.far.pop()
        self.channels = Channels([port], BOAT)
        self.channels.accept()
        self.descriptors = self.channels.filenos()
        self.garbage = pattern * (4096 // len(pattern) + 1)
        self.encoder = Encoder(QGC)

    @property
    def looks(self) -> int:
        return sum(channel.wasted_checks for channel in self.channels.open.values())

    def flood(self) -> None:
        """As much as a tick brings; what does not fit is lost or, on a stream, waits at the sender's."""
        for far in self.far:
            for _ in range(TICK_BYTES // 4096):
                far.send(self.garbage)

    def announce(self) -> None:
        assert self.good.send(self.encoder.encode(dialect.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3)))

    def tick(self, calls: int = 20) -> tuple[int, int, int]:
        """One tick and the calls until the next: heartbeats heard, looks of the worst call and of all."""
        heard, worst, began = 0, 0, self.looks
        for call in range(calls):
            before = self.looks
            heard += len(list(self.channels.receive(0.0, None if call == 0 else self.descriptors)))
            worst = max(worst, self.looks - before)
        return heard, worst, self.looks - began


@pytest.mark.parametrize("is_datagram", [True, False], ids=["datagrams", "stream"])
@pytest.mark.parametrize("pattern", PATTERNS.values(), ids=PATTERNS)
def test_garbage_at_10_mb_a_second_costs_a_bounded_number_of_looks_and_holds_nobody_up(
    pattern: bytes, is_datagram: bool
) -> None:
    rig = Flooded(pattern, is_datagram=is_datagram)
    for _ in range(2):
        rig.flood()
        rig.announce()
        heard, worst, total = rig.tick()
        assert heard == 1
        assert worst <= CALL_LOOKS + OVERSHOOT
        assert total <= TICK_LOOKS + OVERSHOOT


def test_many_floods_at_once_share_what_one_would_have_and_a_station_is_heard_in_every_tick() -> None:
    rig = Flooded(b"\xfd\x00\x00", floods=60)
    for tick in range(4):
        rig.announce()
        rig.flood()
        heard, worst, total = rig.tick()
        assert heard == 1
        if tick > 0:  # from the first on it is known which they are
            assert worst <= CALL_LOOKS + OVERSHOOT
            assert total <= TICK_LOOKS + OVERSHOOT
            assert total > TICK_LOOKS // 2, "and none is starved"


def test_a_flood_is_neither_read_nor_waited_for_until_the_next_tick_and_then_again() -> None:
    rig = Flooded(b"\xfd\x00\x00")
    rig.flood()
    rig.tick()
    assert not rig.channels.has_more, "the loop would spin"
    assert rig.channels.filenos() == rig.descriptors[1:]
    before = rig.looks
    assert list(rig.channels.receive(0.0, ())) == []
    assert rig.looks == before
    list(rig.channels.receive(0.0, None))
    assert rig.looks > before
    assert rig.channels.filenos() == rig.descriptors


def test_a_call_hands_over_no_more_than_256_frames_and_64_of_a_link() -> None:
    rig = Flooded(b"\0", floods=5)
    beat = dialect.MAVLink_heartbeat_message(11, 3, 0, 0, 4, 3)
    for number, far in enumerate(rig.far):
        encoder = Encoder(Address(9 + number, 1))
        far.send(b"".join(encoder.encode(beat) for _ in range(2000)))
    numbers = [number for number, _ in rig.channels.receive(0.0)]
    assert len(numbers) == 256
    assert {number: numbers.count(number) for number in numbers} == {1: 64, 2: 64, 3: 64, 4: 64}
    assert rig.channels.has_more
    assert {number for number, _ in rig.channels.receive(0.0)} >= {5}


def test_what_waits_for_a_slow_line_leaves_it_during_a_flood_on_other_links() -> None:
    floods, ports = [], []
    for _ in range(10):
        near, far = memory_pair(is_datagram=False)
        ports.append(MemoryPort(near))
        floods.append(far)
    near, slow = memory_pair(queue_frames=1)
    policy = Policy(LinkConfig(url="", stale_s=5.0))
    channels = Channels([*ports, ConfiguredPort(MemoryPort(near), policy)], BOAT)
    channels.accept()
    for number in range(10):
        channels.send(dialect.MAVLink_heartbeat_message(11, 3, 0, number, 4, 3), 11)
    for _ in range(10):
        for far in floods:
            far.send(b"\xfd\x00\x00" * 1365)
        assert len(slow.receive()) == 1
        list(channels.receive(0.0, None))
    assert channels.open[11].queue.waiting_bytes == 0
