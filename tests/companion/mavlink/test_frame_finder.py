"""The finder against a slow reference, and what it costs: any bytes, found alike, in linear work."""

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from companion.mavlink.address import Address
from companion.mavlink.codec import Encoder
from companion.mavlink.dialect import crc16, dialect
from companion.mavlink.finder import FrameFinder
from companion.mavlink.layout import LAYOUTS

SENDER = Address(7, 1)
V1, V2 = 0xFE, 0xFD
CHUNK = 4096


class ReferenceFinder:
    """The rules, byte by byte and without any haste.

    A place is a frame if it begins with a magic byte, its header is one, and its CRC fits. A message that is
    not in the dialect is a frame if it comes from a system, ends where the next magic byte or nothing is, has
    no frame of the dialect inside, and is no part of what was refused. A stream waits for the rest of what
    may still become a frame; in a datagram there is no rest.
    """

    def __init__(self, datagram: bool) -> None:
        self.datagram = datagram
        self.data = b""
        self.refused_to = 0  # counted from the first byte of `data`

    def feed(self, data: bytes) -> list[bytes]:
        self.data += data
        found, at = [], 0
        while at < len(self.data):
            verdict = self.at(at)
            if isinstance(verdict, bytes):
                found.append(verdict)
                at += len(verdict)
            elif verdict == "wait" and not self.datagram:
                break
            else:
                if at >= self.refused_to and verdict in ("crc", "unknown", "wait"):
                    self.refused_to = at + claimed(self.data[at:])
                at += 1
        self.data = b"" if self.datagram else self.data[at:]
        self.refused_to = 0 if self.datagram else max(self.refused_to - at, 0)
        return found

    def at(self, at: int) -> bytes | str:
        verdict = known(self.data[at:])
        if verdict != "unknown":
            return verdict
        if at < self.refused_to:
            return "unknown"
        rest = self.data[at:]
        system = rest[5] if rest[0] == V2 else rest[3]
        length = claimed(rest)
        if system == 0 or (len(rest) > length and rest[length] not in (V1, V2)):
            return "unknown"
        inner = [known(rest[n:]) for n in range(1, min(length, len(rest))) if rest[n] in (V1, V2)]
        if any(isinstance(one, bytes) for one in inner):
            return "unknown"
        if "wait" in inner or len(rest) < length:
            return "wait"
        return rest[:length]


def claimed(rest: bytes) -> int:
    if len(rest) < 3:
        return 1
    if rest[0] == V1:
        return 8 + rest[1]
    return 12 + rest[1] + (13 if rest[2] & 1 else 0)


def known(rest: bytes) -> bytes | str:
    """A frame of the dialect at the beginning of some bytes, or why there is none."""
    if rest[0] not in (V1, V2):
        return "header"
    is_v2 = rest[0] == V2
    head = 10 if is_v2 else 6
    if is_v2 and len(rest) > 2 and rest[2] not in (0, 1):
        return "header"
    if len(rest) < (12 if is_v2 else 6):
        return "wait"
    layout = LAYOUTS.get(int.from_bytes(rest[7:10], "little") if is_v2 else rest[5])
    if layout is None:
        return "unknown"
    if not is_v2 and rest[1] > layout.size:
        return "header"
    end = head + rest[1]
    if len(rest) < claimed(rest):
        return "wait"
    fits = crc16(rest[1:end] + layout.crc_extra) == int.from_bytes(rest[end : end + 2], "little")
    return rest[: claimed(rest)] if fits else "crc"


def heartbeat(sequence: int = 0) -> bytes:
    encoder = Encoder(SENDER)
    for _ in range(sequence):
        encoder.encode(dialect.MAVLink_heartbeat_message(11, 3, 0, 0, 4, 3))
    return encoder.encode(dialect.MAVLink_heartbeat_message(11, 3, 0, sequence, 4, 3))


def v1_heartbeat() -> bytes:
    body = bytes((9, 3, *SENDER, 0)) + bytes(9)
    extra = LAYOUTS[0].crc_extra
    return bytes((V1,)) + body + crc16(body + extra).to_bytes(2, "little")


def unknown(payload: bytes, sender: Address = SENDER, *, is_signed: bool = False) -> bytes:
    header = bytes((V2, len(payload), is_signed, 0, 5, *sender, 0x01, 0xFF, 0x7F))
    return header + payload + b"\x12\x34" + (bytes(range(13)) if is_signed else b"")


PIECES = st.one_of(
    st.sampled_from([heartbeat(), heartbeat(3), v1_heartbeat(), b"\xfd", b"\xfe", b"\xfd\x00"]),
    st.sampled_from([unknown(b"abc"), unknown(b"abc", is_signed=True), unknown(b"abc", Address(0, 1))]),
    st.binary(max_size=24),
    st.binary(max_size=40).map(unknown),
    st.builds(
        lambda byte, count: bytes((byte,)) * count, st.sampled_from([V1, V2, 0, 9, 255]), st.integers(1, 40)
    ),
    st.builds(
        lambda frame, at: frame[:at], st.sampled_from([heartbeat(), unknown(bytes(30))]), st.integers(1, 20)
    ),
    st.lists(st.sampled_from([0, 1, 9, V1, V2]), max_size=24).map(bytes),
)
STREAMS = st.lists(PIECES, max_size=14).map(b"".join)


@pytest.mark.parametrize("datagram", [True, False], ids=["datagrams", "stream"])
@given(data=STREAMS, chunk=st.integers(1, 60), most_looks=st.integers(1, 9), most_frames=st.integers(1, 3))
@example(
    data=bytes.fromhex("fd0900000007010000000000fd0000000001000000010000"),
    chunk=12,
    most_looks=1,
    most_frames=1,
)
@example(data=b"\xfe" * 5 + heartbeat(), chunk=60, most_looks=1, most_frames=1)
@example(data=b"\xfd\xfd" + heartbeat(), chunk=60, most_looks=1, most_frames=1)
@example(data=b"\xfe\xfe\xfe" + v1_heartbeat(), chunk=7, most_looks=2, most_frames=1)
def test_the_same_frames_are_found_for_any_bytes_in_any_pieces_and_however_often_it_stops(
    data: bytes, chunk: int, most_looks: int, most_frames: int, datagram: bool
) -> None:
    reference, finder, stopping = ReferenceFinder(datagram), FrameFinder(datagram), FrameFinder(datagram)
    for at in range(0, len(data), chunk):
        piece = data[at : at + chunk]
        expected = reference.feed(piece)
        assert [frame.data for frame in finder.feed(piece)] == expected
        stopping.put(piece)
        found = [frame.data for frame in stopping.find(most_frames, most_looks)]
        while stopping.is_behind:
            found += [frame.data for frame in stopping.find(most_frames, most_looks)]
        assert found == expected
    assert stopping.counters == finder.counters


@pytest.mark.parametrize("datagram", [True, False], ids=["datagrams", "stream"])
def test_a_megabyte_of_any_one_byte_value_costs_a_few_looks_a_chunk(datagram: bool) -> None:
    for value in (0, 1, 9, 127, V2, V1, 255):
        finder = FrameFinder(datagram)
        for _ in range(256):
            assert finder.feed(bytes((value,)) * CHUNK) == []
        assert finder.wasted_checks <= 256 * 6, f"{value:#x}"
        assert finder.counters.bytes_in == 256 * CHUNK
        assert finder.counters.bad_frames > 0


@pytest.mark.parametrize(
    "pattern",
    [b"\xfd\x00\x00", b"\xfe\x09", b"\xfd\xff\x00\x00\x00\x01\x01\x01\xff\x7f", b"\xfe\xfd\x00", b"\xfd\x05"],
)
def test_no_pattern_costs_more_than_two_looks_a_byte(pattern: bytes) -> None:
    data = pattern * (8 * CHUNK // len(pattern))
    finder = FrameFinder(datagram=False)
    for at in range(0, len(data), CHUNK):
        finder.feed(data[at : at + CHUNK])
    assert finder.wasted_checks <= 2 * len(data)


@pytest.mark.parametrize("datagram", [True, False], ids=["datagrams", "stream"])
@pytest.mark.parametrize("is_signed", [True, False])
def test_an_unknown_message_between_known_ones_is_found_whole(datagram: bool, is_signed: bool) -> None:
    pieces = [heartbeat(), unknown(b"abc", is_signed=is_signed), heartbeat(1), unknown(b"z")]
    finder = FrameFinder(datagram)
    assert [frame.data for frame in finder.feed(b"".join(pieces))] == pieces
    assert (finder.counters.unknown, finder.counters.frames_in, finder.counters.bad_frames) == (2, 2, 0)


def test_frames_waste_no_look_and_have_a_limit_of_their_own() -> None:
    finder = FrameFinder(datagram=False)
    finder.put(b"".join(heartbeat(n) for n in range(100)))
    assert len(finder.find(most_frames=10, most_wasted_looks=1)) == 10
    assert finder.is_behind
    assert len(finder.find(most_wasted_looks=1)) == 90
    assert finder.wasted_checks == 0
