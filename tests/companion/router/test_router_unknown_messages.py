"""Messages that the dialect does not have are found where their structure holds, and pass byte for byte."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.mavlink.address import Address
from companion.mavlink.codec import Decoder, Encoder
from companion.mavlink.dialect import dialect
from companion.mavlink.finder import FrameFinder

SENDER = Address(7, 1)
UNKNOWN_ID = 0x7FFF01


def unknown(payload: bytes = b"new", sequence: int = 0, is_signed: bool = False) -> bytes:
    header = bytes((0xFD, len(payload), int(is_signed), 0, sequence, *SENDER)) + UNKNOWN_ID.to_bytes(
        3, "little"
    )
    return header + payload + b"\x12\x34" + (bytes(range(13)) if is_signed else b"")


def known(number: int) -> bytes:
    encoder = Encoder(SENDER)
    for _ in range(number):
        encoder.encode(dialect.MAVLink_heartbeat_message(11, 3, 0, 0, 4, 3))
    return encoder.encode(dialect.MAVLink_heartbeat_message(11, 3, 0, number, 4, 3))


@pytest.mark.parametrize("datagram", [True, False])
@pytest.mark.parametrize("is_signed", [True, False])
def test_an_unknown_message_between_known_ones_is_found_whole(datagram: bool, is_signed: bool) -> None:
    pieces = [known(0), unknown(b"abc", is_signed=is_signed), known(1), unknown(b"z", 2)]
    finder = FrameFinder(datagram)
    assert [frame.data for frame in finder.feed(b"".join(pieces))] == pieces
    assert (finder.counters.unknown, finder.counters.frames_in, finder.counters.bad_frames) == (2, 2, 0)


def test_a_decoder_leaves_unknown_messages_out() -> None:
    decoder = Decoder(datagram=True)
    assert [r.message.get_type() for r in decoder.feed(unknown() + known(0))] == ["HEARTBEAT"]


def test_an_unknown_header_before_a_known_frame_does_not_swallow_it() -> None:
    stray = unknown(bytes(30))[:15]  # claims more than there is of it
    finder = FrameFinder(datagram=False)
    frames = finder.feed(stray + known(0) + known(1) + bytes(60))
    assert [frame.data for frame in frames] == [known(0), known(1)]


def test_an_unknown_frame_that_ends_nowhere_is_not_believed() -> None:
    assert FrameFinder(datagram=True).feed(unknown() + b"rest") == []


def test_frames_of_system_zero_are_rejected() -> None:
    frame = bytearray(unknown())
    frame[5] = 0
    assert FrameFinder(datagram=True).feed(bytes(frame)) == []


@given(
    st.lists(st.tuples(st.booleans(), st.binary(min_size=1, max_size=60)), max_size=12), st.integers(1, 40)
)
def test_known_frames_survive_unknown_ones_and_dirt_however_the_stream_is_cut(
    pieces: list[tuple[bool, bytes]], chunk: int
) -> None:
    stream, expected = b"", []
    for number, (is_frame, payload) in enumerate(pieces):
        stream += unknown(payload, number) if is_frame else payload
        stream += known(number)
        expected.append(known(number))
    stream += bytes(300)
    finder = FrameFinder(datagram=False)
    found = [f.data for at in range(0, len(stream), chunk) for f in finder.feed(stream[at : at + chunk])]
    assert [data for data in found if data in expected] == expected
