"""Corrections from stations: fragments as MAVLink defines them, frames as pyrtcm checks them."""

import random
from dataclasses import dataclass, field

import pytest
from boat_rig import QGC, Peer, Rig
from hypothesis import given
from hypothesis import strategies as st
from pyrtcm import RTCMReader
from pyrtcm.rtcmhelpers import calc_crc24q

from companion.core.status_text import StatusText
from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, dialect
from companion.sensors.rtcm import RtcmReader, crc24q, message_type
from companion.services.corrections import CorrectionService
from companion.services.outbox import Origin, Outbox
from companion.services.statustext import StatusTextService

# The example of RTCM 10403.1, section 4.2: a station's position, message 1005
STATION = bytes.fromhex("D300133ED7D30202980EDEEF34B4BD62AC0941986F33360B98")
MOST = 180


def frame(number: int, size: int, seed: int = 0) -> bytes:
    """A frame of an observation message with a payload of this size."""
    payload = (number << 4).to_bytes(2, "big") + random.Random(seed).randbytes(size - 2)
    head = b"\xd3" + size.to_bytes(2, "big") + payload
    return head + bit_by_bit_crc(head).to_bytes(3, "big")


def bit_by_bit_crc(data: bytes) -> int:
    crc = 0
    for byte in data:
        for bit in range(8):
            crc = (crc << 1) ^ ((byte << bit & 0x80) << 17)
            if crc & 0x1000000:
                crc ^= 0x1864CFB
    return crc & 0xFFFFFF


def rtcm_data(data: bytes, flags: int = 0) -> Message:
    message: Message = dialect.MAVLink_gps_rtcm_data_message(flags, len(data), data.ljust(MOST, b"\0"))
    return message


def fragments(data: bytes, sequence: int) -> list[Message]:
    """As QGroundControl and MAVProxy send a message."""
    if len(data) < MOST:
        return [rtcm_data(data, sequence << 3)]
    pieces = [data[at : at + MOST] for at in range(0, len(data), MOST)]
    return [rtcm_data(piece, 1 | number << 1 | (sequence & 31) << 3) for number, piece in enumerate(pieces)]


@dataclass
class Receiver:
    """A strict reader of what the boat sends."""

    frames: list[bytes] = field(default_factory=list)
    takes: bool = True

    def inject(self, data: bytes) -> bool:
        if self.takes:
            self.frames.append(data)
        return self.takes


class Bench:
    def __init__(self, receiver: Receiver | None = None) -> None:
        self.receiver = receiver or Receiver()
        self.texts: list[StatusText] = []
        texts = StatusTextService(Outbox())
        texts.listener = self.texts.append
        self.service = CorrectionService(self.receiver, texts)
        self.now_s = 100.0

    def hear(self, *messages: Message, sender: Address = QGC, channel: int = 1) -> "Bench":
        for message in messages:
            self.service.on_rtcm_data(message, Origin(channel, sender), self.now_s)
        return self


def test_the_example_of_the_standard_is_a_frame() -> None:
    assert RtcmReader().feed(STATION) == [STATION]
    assert message_type(STATION) == 1005
    assert RTCMReader.parse(STATION).identity == "1005"
    assert crc24q(STATION[:-3]) == bit_by_bit_crc(STATION[:-3]) == 0x360B98


@pytest.mark.parametrize("size", [2, 100, 173, 174, 175, 353, 354, 355, 500, 714])
def test_a_message_of_any_length_arrives_whole(size: int) -> None:
    wanted = frame(1077, size)
    bench = Bench().hear(*fragments(wanted, 7))
    assert bench.receiver.frames == [wanted]
    assert calc_crc24q(bench.receiver.frames[0]) == 0


@given(st.permutations(range(4)), st.integers(0, 31))
def test_fragments_in_any_order_make_the_message(order: list[int], sequence: int) -> None:
    wanted = frame(1087, 700)
    pieces = fragments(wanted, sequence)
    bench = Bench().hear(*(pieces[number] for number in order))
    assert bench.receiver.frames == [wanted]


def test_a_lost_fragment_loses_its_message_only() -> None:
    before, broken, after = frame(1077, 400, 1), frame(1087, 400, 2), frame(1097, 400, 3)
    for missing in range(3):
        bench = Bench().hear(*fragments(before, 1))
        bench.hear(*(piece for number, piece in enumerate(fragments(broken, 2)) if number != missing))
        bench.hear(*fragments(after, 3), *fragments(STATION, 4))
        assert bench.receiver.frames == [before, after, STATION]
        status = bench.service.status(bench.now_s)
        assert status is not None
        assert (status.lost, status.frames, status.malformed) == (1, 3, 0)
        assert (status.sender, status.bytes) == ("255/190", 2 * 406 + len(STATION))
        later = bench.service.status(bench.now_s + 2.5)
        assert later is not None
        assert later.age_s == pytest.approx(2.5)
        assert status.types == (1005, 1077, 1097)


def test_the_same_messages_on_two_links_reach_the_receiver_once() -> None:
    bench = Bench()
    for number, message in enumerate((frame(1077, 400), STATION)):
        for piece in fragments(message, number):
            bench.hear(piece, channel=1).hear(piece, channel=2)
    assert len(bench.receiver.frames) == 2
    bench.now_s += 1.0  # the station's position is sent again and again
    bench.hear(*fragments(STATION, 9))
    assert len(bench.receiver.frames) == 3


def test_a_second_base_is_heard_once_the_first_is_silent() -> None:
    bench = Bench().hear(*fragments(STATION, 1))
    other = Address(254, 1)
    bench.now_s += 4.9
    bench.hear(*fragments(frame(1077, 90), 1), sender=other)
    assert bench.receiver.frames == [STATION]
    bench.now_s += 0.2
    bench.hear(*fragments(frame(1077, 90), 1), sender=other)
    assert bench.receiver.frames == [STATION, frame(1077, 90)]


@given(st.lists(st.tuples(st.integers(0, 255), st.binary(max_size=MOST), st.integers(0, 255)), max_size=12))
def test_hostile_messages_give_the_receiver_nothing(messages: list[tuple[int, bytes, int]]) -> None:
    bench = Bench()
    for flags, data, length in messages:
        message = dialect.MAVLink_gps_rtcm_data_message(flags, length, data.ljust(MOST, b"\0"))
        bench.hear(message)
    for sent in bench.receiver.frames:
        assert calc_crc24q(sent) == 0
    assert sum(map(len, bench.service._fragments.values())) <= 4 * MOST
    bench.now_s += 3.0
    bench.hear(*fragments(STATION, 30), *fragments(frame(1077, 700), 31))
    assert frame(1077, 700) in bench.receiver.frames


def test_made_up_preambles_cost_a_few_checksums_a_message() -> None:
    bench, attack = Bench(), b"\xd3\x00\x40" * 60
    for number in range(50):
        bench.hear(rtcm_data(attack))
        status = bench.service.status(bench.now_s)
        assert status is not None
        assert status.malformed <= 3 * (number + 1)
    bench.hear(rtcm_data(STATION))
    assert bench.receiver.frames == [STATION]


def test_the_older_message_brings_a_stream_in_pieces() -> None:
    bench, stream = Bench(), STATION + frame(1077, 300) + STATION[:5]
    for at in range(0, len(stream), 110):
        piece = stream[at : at + 110]
        message = dialect.MAVLink_gps_inject_data_message(1, 1, len(piece), piece.ljust(110, b"\0"))
        bench.service.on_inject_data(message, Origin(1, QGC), bench.now_s)
    assert bench.receiver.frames == [STATION, frame(1077, 300)]


def test_the_operator_hears_of_the_first_frame_and_of_the_end() -> None:
    bench = Bench().hear(rtcm_data(STATION))
    bench.now_s += 1.0
    bench.hear(rtcm_data(STATION))
    bench.now_s += 30.0
    bench.service.tick(bench.now_s)
    assert len(bench.texts) == 1
    bench.now_s += 0.1
    bench.service.tick(bench.now_s)
    bench.service.tick(bench.now_s)
    assert len(bench.texts) == 2


def test_refused_frames_are_counted() -> None:
    bench = Bench(Receiver(takes=False)).hear(rtcm_data(STATION))
    status = bench.service.status(bench.now_s)
    assert status is not None
    assert (status.frames, status.refused) == (0, 1)


def send(peer: Peer, data: bytes, sequence: int) -> None:
    for message in fragments(data, sequence):
        peer.send(message)


def test_corrections_pass_through_the_whole_boat() -> None:
    receiver = Receiver()
    rig = Rig(corrections=receiver)
    rig.peer.heartbeat()
    send(rig.peer, frame(1077, 600), 1)
    send(rig.peer, STATION, 2)
    rig.run(0.1)
    assert receiver.frames == [frame(1077, 600), STATION]
    assert "GNSS corrections from 255/190" in rig.peer.texts


def test_a_preamble_among_noise_hides_no_frame_behind_it() -> None:
    for noise in (b"\xd3\xff", b"\xd3\xd3", b"\xd3\xfc\xd3"):
        assert RtcmReader().feed(noise + STATION) == [STATION]


def test_the_shortest_frames_have_no_type() -> None:
    empty = b"\xd3\x00\x00"
    empty += crc24q(empty).to_bytes(3, "big")
    assert RtcmReader().feed(empty) == [empty]
    assert message_type(empty) == 0
    assert message_type(frame(1077, 2)) == 1077
