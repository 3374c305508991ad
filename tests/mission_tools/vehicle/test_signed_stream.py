import os
import pty
import tty

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import all as dialect

from companion.links.memory import MemoryLink, MemoryPort, memory_pair
from companion.mavlink.signing import timestamp_at
from companion.mavlink.signing_key import SigningKey
from mission_tools.vehicle.signed_link import SignedStream, SignedWire, _open

KEY = SigningKey.from_passphrase("correct horse")
OTHER = SigningKey.from_passphrase("battery staple")
NOW = timestamp_at(1.8e9)
HEARTBEAT = dialect.MAVLink_heartbeat_message(11, 3, 0, 0, 4, 3)


def stream(is_datagram: bool = False) -> SignedStream:
    mine = SignedStream(KEY, is_datagram)
    mine.set_date(NOW)
    return mine


def boat(key: SigningKey | None = KEY, now: int = NOW) -> dialect.MAVLink:
    """The other end, which is pymavlink."""
    mav = dialect.MAVLink(None, 1, 1)
    if key is not None:
        mav.signing.secret_key, mav.signing.timestamp = key.reveal(), now
        mav.signing.sign_outgoing = True
    return mav


def frames(mav: dialect.MAVLink, count: int) -> list[bytes]:
    return [bytes(HEARTBEAT.pack(mav)) for _ in range(count)]


def test_pymavlink_takes_what_is_sealed() -> None:
    plain = b"".join(frames(boat(None), 5))
    theirs = boat()
    sealed = stream().sign(plain)
    assert len(sealed) == 5
    assert len(theirs.parse_buffer(b"".join(sealed))) == 5
    assert theirs.signing.goodsig_count == 5


def test_what_is_no_whole_frame_is_not_sealed() -> None:
    (plain,) = frames(boat(None), 1)
    assert stream().sign(plain[:-1]) == []
    assert len(stream().sign(b"\xfe" + plain)) == 1
    assert len(stream().sign(plain + plain[:-1])) == 1


def test_what_was_signed_comes_in_as_it_was_before() -> None:
    signed = frames(boat(), 3)
    opened = stream().open(b"".join(signed))
    parsed = boat(None).parse_buffer(b"".join(opened))
    assert [message.get_type() for message in parsed] == ["HEARTBEAT"] * 3
    assert {len(frame) for frame in opened} == {len(signed[0]) - 13}


@given(st.data())
def test_a_stream_may_be_cut_anywhere_and_hold_anything_in_between(data: st.DataObject) -> None:
    parts = []
    for frame in frames(boat(), 6):
        parts += [data.draw(st.binary(max_size=8)), frame]
    whole = b"".join(parts) + bytes(600)  # so that no stray claim waits for more
    cuts = sorted(data.draw(st.lists(st.integers(0, len(whole)), max_size=6)))
    mine, opened = stream(), 0
    for begin, end in zip([0, *cuts], [*cuts, len(whole)], strict=True):
        opened += len(mine.open(whole[begin:end]))
    assert opened == 6


@given(st.lists(st.binary(max_size=300), max_size=10), st.booleans())
def test_any_bytes_are_survived_and_at_most_one_frame_is_kept(chunks: list[bytes], is_datagram: bool) -> None:
    mine = stream(is_datagram)
    for chunk in chunks:
        assert mine.open(chunk) == []
        assert len(mine._incoming._rest) <= (0 if is_datagram else 280)


def test_nothing_of_a_datagram_is_kept_for_the_next() -> None:
    (frame,) = frames(boat(), 1)
    mine = stream(is_datagram=True)
    assert mine.open(frame[:-3]) == []
    assert len(mine.open(frame)) == 1


@pytest.mark.parametrize(
    ("peer", "told"),
    [
        (boat(), ""),
        (boat(OTHER), "signed with another key"),
        (boat(None), "leave --sign-key out"),
        (boat(now=NOW - 7_000_000), "out of date"),
    ],
)
def test_why_nothing_comes_in_is_told(peer: dialect.MAVLink, told: str) -> None:
    mine = stream()
    opened = mine.open(b"".join(frames(peer, 3)))
    assert len(opened) == (0 if told else 3)
    assert told in mine.warning()
    assert bool(mine.warning()) is bool(told)


def test_a_replay_does_not_come_in() -> None:
    (frame,) = frames(boat(), 1)
    mine = stream()
    assert len(mine.open(frame)) == 1
    assert mine.open(frame) == []
    assert mine._guard.counters.old == 1


def wired(*links: MemoryLink) -> tuple[SignedWire, list[bytes]]:
    """A wire over links in memory, and what it hands to MAVSDK."""
    heard: list[bytes] = []
    mine = SignedStream(KEY, is_datagram=links[0].is_datagram)
    return SignedWire(MemoryPort(*links), mine, heard.append, lambda: 1.8e9), heard


def test_of_two_callers_the_last_one_counts() -> None:
    (first, first_far), (last, last_far) = memory_pair(is_datagram=False), memory_pair(is_datagram=False)
    wire, heard = wired(first, last)
    wire.send(*frames(boat(None), 1))  # lost
    last_far.send(frames(boat(), 1)[0])
    wire.poll()
    wire.send(*frames(boat(None), 1))
    assert len(heard) == len(last_far.receive()) == 1
    assert first_far.is_closed


def test_datagrams_answer_whoever_signs_and_nobody_else() -> None:
    (friend, friend_far), (stranger, stranger_far) = memory_pair(), memory_pair()
    wire, heard = wired(stranger, friend)
    friend_far.send(frames(boat(), 1)[0])
    wire.poll()
    stranger_far.send(frames(boat(OTHER), 1)[0])
    stranger_far.send(frames(boat(now=NOW - 7_000_000), 1)[0])  # out of date by the wire's own clock
    wire.poll()
    wire.send(*frames(boat(None), 1))
    assert len(heard) == len(friend_far.receive()) == 1
    assert wire._links == [stranger, friend]
    assert stranger_far.receive() == []


def test_a_serial_line_with_flow_control_is_opened_and_survives_its_unplugging() -> None:
    ours, theirs = pty.openpty()
    tty.setraw(theirs)
    port = _open(f"serial_flowcontrol://{os.ttyname(theirs)}:57600")
    wire = SignedWire(port, stream(), lambda _: None, lambda: 1.8e9)
    wire.poll()
    wire.send(*frames(boat(None), 1))
    assert boat().parse_buffer(os.read(ours, 100))[0].get_type() == "HEARTBEAT"
    os.close(ours)
    os.close(theirs)
    wire.poll()
    wire.send(*frames(boat(None), 1))
