"""The receivers' protocols: what frames say, and what becomes of anything else on the line."""

from itertools import pairwise

import pytest
from fastcrc.crc8 import dvb_s2 as crc8
from hypothesis import given
from hypothesis import strategies as st
from twins.lines import known

from companion.core.readings import RcReading
from companion.rc.parsers import PAUSE_S, CrsfParser, IbusParser, RcParser, SbusParser

CENTRED = bytes.fromhex(
    "c81816e0031ff8c0073ef0810f7ce0031ff8c0073ef0810f7cad"
)  # as the protocol's page has it
TICKS = st.lists(st.integers(172, 1811), min_size=16, max_size=16)


def packed(ticks: list[int]) -> bytes:
    bits = sum(tick << 11 * number for number, tick in enumerate(ticks))
    return bits.to_bytes(22, "little")


def pulses(ticks: list[int]) -> tuple[int, ...]:
    return tuple(1500 + round((tick - 992) * 5 / 8) for tick in ticks)


def crsf(kind: int, payload: bytes) -> bytes:
    body = bytes([kind]) + payload
    return bytes([0xC8, len(body) + 1]) + body + bytes([crc8(body)])


def statistics(quality: int, ahead: int = 60, aside: int = 0, antenna: int = 0) -> bytes:
    return crsf(0x14, bytes([ahead, aside, quality, 5, antenna, 2, 3, 70, 100, 6]))


def ibus(words: list[int]) -> bytes:
    body = bytes([0x20, 0x40]) + b"".join(word.to_bytes(2, "little") for word in words)
    return body + (0xFFFF - sum(body)).to_bytes(2, "little")


def sbus(ticks: list[int], flags: int = 0, end: int = 0) -> bytes:
    return bytes([0x0F]) + packed(ticks) + bytes([flags, end])


def test_the_published_example_is_sixteen_centred_channels() -> None:
    reading = CrsfParser().feed(CENTRED, 2.5)
    assert reading == RcReading(2.5, (1500,) * 16)
    assert crsf(0x16, packed([992] * 16)) == CENTRED


@given(TICKS)
def test_crsf_channels_come_in_their_order(ticks: list[int]) -> None:
    reading = known(CrsfParser().feed(crsf(0x16, packed(ticks)), 0.0))
    assert reading.channels_us == pulses(ticks)


def test_the_ends_of_the_scale_are_988_and_2012_microseconds() -> None:
    reading = known(CrsfParser().feed(crsf(0x16, packed([172, 1811] * 8)), 0.0))
    assert reading.channels_us[:2] == (988, 2012)
    widest = known(CrsfParser().feed(crsf(0x16, packed([0, 2047] * 8)), 0.0))
    assert widest.channels_us[:2] == (880, 2159)


def test_a_link_without_quality_is_the_failsafe_until_there_is_some_again() -> None:
    parser = CrsfParser()
    parser.feed(CENTRED, 0.0)
    lost = known(parser.feed(statistics(0), 0.1))
    assert lost.is_failsafe
    repeated = known(parser.feed(CENTRED, 0.2))  # some receivers go on with the last channels
    assert repeated.is_failsafe
    found = known(parser.feed(statistics(100) + CENTRED, 0.3))
    assert not found.is_failsafe


@pytest.mark.parametrize(
    ("ahead", "aside", "antenna", "signal_dbm"), [(60, 75, 0, -60.0), (60, 75, 1, -75.0), (0, 75, 0, None)]
)
def test_the_signal_is_that_of_the_antenna_in_use(
    ahead: int, aside: int, antenna: int, signal_dbm: float | None
) -> None:
    heard = known(CrsfParser().feed(statistics(97, ahead, aside, antenna) + CENTRED, 0.0))
    assert (heard.quality, heard.rssi_dbm) == (0.97, signal_dbm)


def test_crsf_frames_of_other_kinds_are_passed_over_whole() -> None:
    parser = CrsfParser()
    gps = crsf(0x02, b"\xc8" * 15)
    assert parser.feed(gps + CENTRED, 0.0) is not None
    assert parser.skipped == 0


@given(st.lists(st.integers(0, 0x0FFF), min_size=14, max_size=14))
def test_ibus_channels_are_microseconds(words: list[int]) -> None:
    reading = IbusParser().feed(ibus(words), 1.0)
    assert reading == RcReading(1.0, tuple(words))


def test_ibus_channels_15_to_18_come_in_the_upper_bits() -> None:
    extra = [1000, 1500, 2000, 1234]
    nibbles = [channel >> shift & 0xF for channel in extra for shift in (0, 4, 8)]
    words = [1500 | nibble << 12 for nibble in nibbles] + [1500, 1500]
    reading = known(IbusParser().feed(ibus(words), 0.0))
    assert reading.channels_us == (1500,) * 14 + tuple(extra)


@given(TICKS, st.sampled_from([0x00, 0x04, 0x14, 0x24, 0x34]))
def test_sbus_channels_come_in_their_order_with_two_switches(ticks: list[int], end: int) -> None:
    reading = known(SbusParser().feed(sbus(ticks, flags=2, end=end), 0.0))
    assert reading.channels_us == (*pulses(ticks), 1000, 2000)


def test_an_sbus_frame_lost_on_the_air_is_no_reading_and_costs_quality() -> None:
    parser = SbusParser()
    assert parser.feed(sbus([992] * 16), 0.0) is not None
    for number in range(1, 50):
        assert parser.feed(sbus([992] * 16, flags=4), 0.01 * number) is None
    reading = known(parser.feed(sbus([992] * 16), 0.5))
    assert reading.quality is not None
    assert 0.3 < reading.quality < 0.45


@pytest.mark.parametrize(("flags", "switches"), [(0, (1000, 1000)), (1, (2000, 1000)), (3, (2000, 2000))])
def test_the_switches_of_sbus_are_bits_of_their_own(flags: int, switches: tuple[int, int]) -> None:
    reading = known(SbusParser().feed(sbus([992] * 16, flags=flags), 0.0))
    assert reading.channels_us[16:] == switches
    assert (reading.is_failsafe, reading.quality) == (False, 1.0)


@pytest.mark.parametrize(("flags", "end"), [(0x10, 0x00), (0xFF, 0x04), (0x00, 0x01), (0x00, 0x05)])
def test_sbus_with_unknown_flags_or_another_end_is_no_frame(flags: int, end: int) -> None:
    assert SbusParser().feed(sbus([992] * 16, flags=flags, end=end), 0.0) is None


def test_an_ibus_frame_of_another_command_is_no_frame() -> None:
    body = ibus([1500] * 14)[:-2].replace(b"\x20\x40", b"\x20\x41", 1)
    parser = IbusParser()
    assert parser.split(body + (0xFFFF - sum(body)).to_bytes(2, "little")) == []


def test_a_beginning_within_an_sbus_frame_is_not_taken_for_one() -> None:
    # with these channels 25 bytes that begin in the middle look like a frame, again and again
    frame = bytearray(sbus([0] * 16))
    frame[7] = 0x0F
    stream = bytes(frame) * 3
    parser = SbusParser()
    parser.feed(stream[5:20], 1.0)  # the reader comes in in mid-frame
    for number in range(4):
        assert parser.feed(stream[20 + number : 21 + number], 1.0 + 1e-4 * number) is None
    reading = known(parser.feed(bytes(frame), 1.01))
    assert reading.channels_us == SbusParser().feed(bytes(frame), 0.0).channels_us  # type: ignore[union-attr]


FRAMES = {"crsf": CENTRED, "ibus": ibus([1500] * 14), "sbus": sbus([992] * 16)}
PARSERS: dict[str, type[RcParser]] = {"crsf": CrsfParser, "ibus": IbusParser, "sbus": SbusParser}
LONGEST = {"crsf": 64, "ibus": 32, "sbus": 25}


@pytest.mark.parametrize("kind", PARSERS)
@given(chunks=st.lists(st.binary(max_size=300), max_size=8))
def test_after_any_noise_the_next_frames_are_heard(kind: str, chunks: list[bytes]) -> None:
    parser, now_s = PARSERS[kind](), 0.0
    for chunk in chunks:
        parser.feed(chunk, now_s)
        now_s += 1e-4
        assert len(parser._held) < LONGEST[kind]
    heard = []
    for _ in range(8):
        now_s += 2.0 * PAUSE_S
        heard.append(parser.feed(FRAMES[kind], now_s))
    assert all(reading is not None and len(reading.channels_us) >= 14 for reading in heard[-4:])


@pytest.mark.parametrize("kind", PARSERS)
@given(cuts=st.lists(st.integers(0, 200), max_size=12))
def test_frames_may_come_in_any_pieces(kind: str, cuts: list[int]) -> None:
    stream = FRAMES[kind] * 6
    places = sorted({0, len(stream), *(min(cut, len(stream)) for cut in cuts)})
    parser = PARSERS[kind]()
    assert [frame for begin, end in pairwise(places) for frame in parser.split(stream[begin:end])] == [
        FRAMES[kind]
    ] * 6
    assert parser.skipped == 0


@pytest.mark.parametrize("kind", ["crsf", "ibus"])
@given(place=st.integers(0, 25), flip=st.integers(1, 255))
def test_one_wrong_byte_costs_its_frame_and_no_other(kind: str, place: int, flip: int) -> None:
    frame = bytearray(FRAMES[kind])
    frame[place] ^= flip
    parser, good = PARSERS[kind](), FRAMES[kind]
    assert 3 <= len(parser.split(good + bytes(frame) + 4 * good)) <= 5
    assert parser.skipped > 0


def test_half_a_frame_of_before_is_forgotten_with_the_line() -> None:
    for kind, frame in FRAMES.items():
        parser = PARSERS[kind]()
        parser.feed(frame[:10], 0.0)
        parser.forget()
        assert parser.feed(frame, 1.0) is not None
        assert parser.skipped == 0
