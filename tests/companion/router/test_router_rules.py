"""What a link's rules keep back, what a slow line carries, and how links share the boat's time."""

import pytest
from boat_rig import BOAT
from hypothesis import given, settings
from hypothesis import strategies as st

from companion.config.boat_config import LinkConfig
from companion.core.errors import ConfigError
from companion.links.memory import MemoryLink, MemoryPort, memory_pair
from companion.mavlink.address import Address
from companion.mavlink.codec import Decoder, Encoder
from companion.mavlink.dialect import Message, dialect
from companion.router.channels import Channels
from companion.router.policy import ConfiguredPort, Filter, Policy
from companion.router.status import Reporter
from companion.router.tx_queue import MAX_BYTES, LineBudget, TokenBucket, TxQueue

OTHER = Address(2, 1)
ATTITUDE = dialect.MAVLINK_MSG_ID_ATTITUDE


def attitude(number: int = 0) -> Message:
    message: Message = dialect.MAVLink_attitude_message(number, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6)
    return message


def bridge(*policies: Policy) -> tuple[Channels, list[MemoryLink]]:
    ports, far = [], []
    for policy in policies:
        near, end = memory_pair(policy.setting.name)
        ports.append(ConfiguredPort(MemoryPort(near), policy))
        far.append(end)
    channels = Channels(ports, BOAT)
    channels.wanted = frozenset({dialect.MAVLINK_MSG_ID_HEARTBEAT})
    channels.accept()
    return channels, far


def names(link: MemoryLink) -> list[str]:
    decoder = Decoder(datagram=True)
    return [r.message.get_type() for chunk in link.receive() for r in decoder.feed(chunk)]


def plain(**setting: object) -> Policy:
    return Policy(LinkConfig(url="", **setting))  # type: ignore[arg-type]


@pytest.mark.parametrize("key", ["allow", "deny", "max_hz"])
def test_a_message_that_does_not_exist_is_named_with_its_key(key: str) -> None:
    setting = LinkConfig(url="", **{key: {"NO_SUCH": 1.0} if key == "max_hz" else ("NO_SUCH",)})  # type: ignore[arg-type]
    with pytest.raises(ConfigError, match=rf"links\[2\]\.{key}: .*'NO_SUCH'"):
        Policy(setting, "links[2]")


def test_frames_are_forwarded_byte_for_byte_and_only_what_is_wanted_is_unpacked() -> None:
    channels, (near, far) = bridge(plain(), plain())
    encoder = Encoder(OTHER)
    frames = [
        encoder.encode(attitude()),
        encoder.encode(dialect.MAVLink_heartbeat_message(11, 3, 0, 0, 4, 3)),
    ]
    unknown = bytes.fromhex("fd03000002020101ff7f6162631234")
    for frame in (*frames, unknown):
        near.send(frame)
    assert [r.message.get_type() for _, r in channels.receive(0.0)] == ["HEARTBEAT"]
    assert far.receive() == [*frames, unknown]
    assert near.receive() == []
    assert channels.open[2].forwarded == 3


def test_what_is_denied_or_not_allowed_does_not_leave() -> None:
    channels, (near, denying, allowing) = bridge(
        plain(), plain(deny=("ATTITUDE",)), plain(allow=("ATTITUDE",))
    )
    encoder = Encoder(OTHER)
    near.send(encoder.encode(attitude()))
    near.send(encoder.encode(dialect.MAVLink_heartbeat_message(11, 3, 0, 0, 4, 3)))
    list(channels.receive(0.0))
    assert names(denying) == ["HEARTBEAT"]
    assert names(allowing) == ["ATTITUDE"]
    assert [channel.withheld for channel in channels.open.values()] == [0, 1, 1]


@given(st.floats(1.0, 50.0), st.floats(0.5, 20.0))
def test_a_rate_cap_lets_no_more_through_and_hardly_less(sent_hz: float, cap_hz: float) -> None:
    capped = Filter(plain(max_hz={"ATTITUDE": cap_hz}))
    passed = sum(capped.passes(ATTITUDE, 2, number / sent_hz) for number in range(round(sent_hz * 20.0)))
    expected = 20.0 * min(sent_hz, cap_hz)
    assert passed <= expected + 2.0
    assert passed >= 0.9 * expected - 1.0
    assert capped.passes(ATTITUDE, 3, 0.0), "another sender's"


def test_telemetry_keeps_to_the_line_and_its_radio_slows_it_down() -> None:
    def sent_in(seconds: float, budget: TokenBucket, began_s: float) -> int:
        sent = 0
        for tick in range(round(seconds / 0.02)):
            now_s = began_s + 0.02 * tick
            while budget.may_send(now_s):
                budget.spend(40, now_s)
                sent += 40
        return sent

    budget = TokenBucket(5000.0)
    assert sent_in(10.0, budget, 0.0) == pytest.approx(50_000, rel=0.05)
    for _ in range(3):
        budget.on_radio_status(10)
    assert sent_in(10.0, budget, 10.0) < 0.3 * 50_000
    for _ in range(30):
        budget.on_radio_status(95)
    assert sent_in(10.0, budget, 20.0) == pytest.approx(50_000, rel=0.05)


def test_own_frames_go_first_then_addressed_ones_and_what_is_stale_is_dropped() -> None:
    taken: list[bytes] = []
    is_full = True

    def send(data: bytes) -> bool:
        if not is_full:
            taken.append(data)
        return not is_full

    room = TxQueue(send, None, stale_s=1.0)
    room.put(b"old", 0.0)
    room.forward(b"old", 2, True, 0.0)
    room.forward(b"telemetry", 2, False, 0.9)
    room.forward(b"answer", 2, True, 0.9)
    room.put(b"own", 0.95)
    assert not room.may_send(0.95)
    is_full = False
    room.drain(1.5)
    assert taken == [b"own", b"answer", b"telemetry"]
    assert (room.dropped, room.waiting_bytes) == (2, 0)
    is_full = True
    for _ in range(MAX_BYTES // 250 + 1):
        room.put(bytes(250), 1.5)
    assert room.dropped == 3, "the oldest, for the latest"


@settings(max_examples=30)
@given(st.integers(17, 280), st.integers(17, 280), st.integers(1, 30))
def test_sources_share_a_line_by_bytes_however_much_one_of_them_sends(
    flood_bytes: int, quiet_bytes: int, per_tick: int
) -> None:
    """The quiet one sends a tenth of the line in frames of its own size; all of it is carried in time."""
    sent: list[bytes] = []

    def send(data: bytes) -> bool:
        sent.append(data)
        return True

    room = TxQueue(send, LineBudget(5000.0), stale_s=1.0)
    due_bytes = quiet_frames = 0.0
    for tick in range(250):
        now_s = 0.02 * tick
        for _ in range(per_tick):
            room.forward(b"F" * flood_bytes, 2, True, now_s)
        due_bytes += 10.0
        if due_bytes >= quiet_bytes:
            due_bytes -= quiet_bytes
            quiet_frames += 1
            room.forward(b"Q" * quiet_bytes, 3, False, now_s)
        room.drain(now_s)
    assert sum(data[0] == ord("Q") for data in sent) >= 0.95 * quiet_frames - 2
    assert sum(map(len, sent)) <= 1.2 * 5000.0 * 5.0


def test_what_others_forward_leaves_half_of_a_line_to_the_boat_which_leaves_them_the_rest() -> None:
    def shares(own: bool, forwards: bool) -> tuple[float, float]:
        sent = {"own": 0, "forwarded": 0}
        budget = LineBudget(5000.0)
        for tick in range(1000):
            now_s = 0.02 * tick
            while forwards and budget.may_send(now_s, is_own=False):
                budget.spend(40, now_s, is_own=False)
                sent["forwarded"] += 40
            while own and budget.may_send(now_s, is_own=True):
                budget.spend(40, now_s, is_own=True)
                sent["own"] += 40
        return sent["own"] / 100_000, sent["forwarded"] / 100_000

    assert shares(own=True, forwards=False) == pytest.approx((1.0, 0.0), abs=0.05)
    assert shares(own=False, forwards=True) == pytest.approx((0.0, 1.0), abs=0.05)
    assert shares(own=True, forwards=True) == pytest.approx((0.5, 0.5), abs=0.05)


@given(st.lists(st.tuples(st.integers(1, 280), st.integers(0, 4), st.booleans()), max_size=300))
def test_what_waits_is_bounded_and_nothing_is_lost_uncounted(
    puts: list[tuple[int, int, bool]],
) -> None:
    has_room, sent = False, 0

    def send(data: bytes) -> bool:
        nonlocal sent
        sent += has_room
        return has_room

    room = TxQueue(send, None, stale_s=5.0)
    for number, (size, source, opens) in enumerate(puts):
        has_room = opens
        if source:
            room.forward(bytes(size), source // 2, bool(source % 2), 0.01 * number)
        else:
            room.put(bytes(size), 0.01 * number)
        assert room.waiting_bytes <= 7 * MAX_BYTES
    queues = [room._own, *(one for of in room._sources.values() for one in (of.addressed, of.broadcast))]
    waiting = sum(len(queue.frames) for queue in queues)
    assert sent + room.dropped + waiting == len(puts)


def test_the_report_counts_and_gives_rates() -> None:
    channels, (near, _) = bridge(plain(name="shore"), plain())
    reporter = Reporter(channels)
    reporter.report(0.0)
    frame = Encoder(OTHER).encode(attitude())
    near.send(frame)
    list(channels.receive(0.5))
    first, second = reporter.report(2.0).links
    assert (first.name, first.frames_in, first.heard) == ("shore", 1, ("2/1",))
    assert first.in_bytes_s == second.out_bytes_s == pytest.approx(len(frame) / 2.0)
    assert (second.forwarded, second.frames_out) == (1, 1)
