"""AIS receiver in memory.

The sentences of the types 1, 5, 18, 19 and 24 and their decodes are published with gpsd (test/sample.aivdm
and its page on AIVDM; DMA's AisLib repeats the values), that of type 27 with libais and aismessages. The
others are written by pyais' encoder.
"""

import importlib
import math
import socket
from contextlib import closing
from functools import reduce
from operator import xor
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from twins.daisy import Daisy, packet
from twins.lines import HandClock, MemoryLine, eventually, known

from companion.config.sensors import AisPart
from companion.core.errors import HardwareError
from companion.core.geo import LatLon
from companion.core.readings import AisReading, AisVessel
from companion.core.units import KNOT_M_S
from companion.hal.nmea_sensor import open_ais
from companion.hal.port_sensor import ParsedSensor
from companion.sensors.nmea.ais import LIFE_S, AisReader, nearest

pyais = pytest.importorskip("pyais")

TYPE_1 = b"!AIVDM,1,1,,B,177KQJ5000G?tO`K>RA1wUbN0TKH,0*5C"
TYPE_4 = b"!AIVDM,1,1,,A,403OviQuMGCqWrRO9>E6fE700@GO,0*4D"
TYPE_5 = (
    b"!AIVDM,2,1,1,A,55?MbV02;H;s<HtKR20EHE:0@T4@Dn2222222216L961O5Gf0NSQEp6ClRp8,0*1C",
    b"!AIVDM,2,2,1,A,88888888880,2*25",
)
TYPE_18 = b"!AIVDM,1,1,,A,B52K>;h00Fc>jpUlNV@ikwpUoP06,0*4C"
TYPE_19 = b"!AIVDM,1,1,,B,C5N3SRgPEnJGEBT>NhWAwwo862PaLELTBJ:V00000000S0D:R220,0*0B"
TYPE_24 = (
    b"!AIVDM,1,1,,A,H42O55i18tMET00000000000000,2*6D",
    b"!AIVDM,1,1,,A,H42O55lt0000000D3nink000?0500,0*70",
)
TYPE_27 = b"!AIVDM,1,1,,B,KC5E2b@U19PFdLbMuc5=ROv62<7m,0*16"
PUBLISHED = (TYPE_1, TYPE_4, *TYPE_5, TYPE_18, TYPE_19, *TYPE_24, TYPE_27)


def said(
    kind: int = 1,
    mmsi: int = 211_000_001,
    channel: str = "A",
    sentence: str = "VDM",
    **fields: Any,  # noqa: ANN401
) -> bytes:
    """By pyais' encoder; a position near Cowes unless another is given."""
    message = {
        "msg_type": kind,
        "mmsi": mmsi,
        "lat": 50.76,
        "lon": -1.3,
        "heading": 511,
        "course": 360.0,
    } | fields
    lines = pyais.encode_dict(message, radio_channel=channel, sentence_type=sentence, seq_id=1)
    return b"".join(line.encode() + b"\r\n" for line in lines)


def with_sum(body: bytes) -> bytes:
    return b"!" + body + b"*%02X" % reduce(xor, body, 0)


def place(one: AisVessel) -> tuple[float, float]:
    return one.position.lat_deg, one.position.lon_deg


@pytest.fixture
def reader() -> AisReader:
    return AisReader(pyais.decode)


def heard(reader: AisReader, *lines: bytes, time_s: float = 100.0) -> tuple[AisVessel, ...]:
    return known(reader.feed(b"".join(line.rstrip() + b"\r\n" for line in lines), time_s)).vessels


def vessel(reader: AisReader, *lines: bytes, time_s: float = 100.0) -> AisVessel:
    (one,) = heard(reader, *lines, time_s=time_s)
    return one


def test_a_report_of_class_a_is_read_as_published(reader: AisReader) -> None:
    one = vessel(reader, TYPE_1)
    assert (one.mmsi, one.status, one.time_s) == (477_553_000, 5, 100.0)
    assert place(one) == pytest.approx((47.582833, -122.345833), abs=1e-6)
    assert (one.speed_m_s, one.turn_rad_s) == (0.0, 0.0)
    assert one.course_rad == pytest.approx(math.radians(51.0))
    assert one.heading_rad == pytest.approx(math.radians(181.0))
    assert (one.is_class_b, one.is_accurate) == (False, False)


def test_reports_of_class_b_are_read_as_published(reader: AisReader) -> None:
    short = vessel(reader, TYPE_18)
    assert (short.mmsi, short.is_class_b, short.heading_rad) == (338_087_471, True, None)
    assert short.speed_m_s == pytest.approx(0.1 * KNOT_M_S)
    assert short.course_rad == pytest.approx(math.radians(79.6))
    _, long = heard(reader, TYPE_19)
    assert (long.mmsi, long.name, long.kind) == (367_059_850, "CAPT.J.RIMES", 70)
    assert (long.bow_m, long.stern_m, long.port_m, long.starboard_m) == (5, 21, 4, 4)
    assert long.speed_m_s == pytest.approx(8.7 * KNOT_M_S)
    assert place(long) == pytest.approx((29.543695, -88.8103917), abs=1e-6)


def test_static_data_join_the_vessel_in_any_order(reader: AisReader) -> None:
    assert heard(reader, *TYPE_5) == ()
    one = vessel(reader, said(mmsi=351_759_000))
    assert (one.name, one.callsign, one.kind) == ("EVER DIADEM", "3FOF8", 70)
    assert (one.bow_m, one.stern_m, one.port_m, one.starboard_m) == (225, 70, 1, 31)
    _, small = heard(reader, said(18, 271_041_815), *TYPE_24)
    assert (small.name, small.callsign, small.kind, small.is_class_b) == ("PROGUY", "TC6163", 60, True)
    assert (small.bow_m, small.stern_m, small.port_m, small.starboard_m) == (0, 15, 0, 5)


def test_a_long_range_report_is_coarse(reader: AisReader) -> None:
    one = vessel(reader, TYPE_27)
    assert (one.mmsi, one.status) == (206_914_217, 2)
    assert one.error_m == pytest.approx(185.0)
    assert place(one) == pytest.approx((4.84, 137.023333))
    assert one.speed_m_s == pytest.approx(57.0 * KNOT_M_S)
    assert one.course_rad == pytest.approx(math.radians(167.0))


def test_a_base_station_shows_that_the_receiver_hears_and_is_no_vessel(reader: AisReader) -> None:
    assert reader.feed(TYPE_4 + b"\r\n", 7.0) == AisReading(7.0, ())


@pytest.mark.parametrize(
    ("fields", "name", "value"),
    [
        ({"speed": 102.3}, "speed_m_s", None),
        ({"speed": 102.2}, "speed_m_s", 102.2 * KNOT_M_S),
        ({"course": 360.0}, "course_rad", None),
        ({"course": 359.9}, "course_rad", math.radians(359.9)),
        ({"heading": 511}, "heading_rad", None),
        ({"turn": -128}, "turn_rad_s", None),
        ({"turn": -127}, "turn_rad_s", -math.inf),
        ({"accuracy": 1}, "error_m", 10.0),
        ({"accuracy": 0}, "error_m", 13.0),
    ],
)
def test_values_that_are_not_known_are_none(
    reader: AisReader, fields: dict[str, Any], name: str, value: float | None
) -> None:
    found = getattr(vessel(reader, said(**fields)), name)
    assert found == (value if value is None or math.isinf(value) else pytest.approx(value))


def test_a_vessel_without_a_position_is_not_shown(reader: AisReader) -> None:
    assert heard(reader, said(lat=91.0, lon=181.0)) == ()
    assert vessel(reader, said(), time_s=101.0).time_s == 101.0
    assert vessel(reader, said(lat=91.0, lon=181.0), time_s=110.0).time_s == 101.0


def test_the_own_boat_is_no_vessel() -> None:
    reader = AisReader(pyais.decode, own_mmsi=211_000_009)
    assert [one.mmsi for one in heard(reader, said(), said(mmsi=211_000_009))] == [211_000_001]
    assert heard(reader, said(sentence="VDO")) == ()
    assert heard(reader, said()) == (), "its report comes back by a repeater"


def test_wrong_checksums_and_forms_are_counted_and_other_sentences_skipped(reader: AisReader) -> None:
    lines = (
        TYPE_1.replace(b"*5C", b"*5D"), TYPE_1[:-3], TYPE_1.replace(b"177K", b"177L"), b"!AIVDM,1,1*6B",
        b"!AIVDM,1,1,,B,,0*25", b"!AIVDM,1,1,,B,w,0*52",
    )  # fmt: skip
    assert reader.feed(b"\r\n".join((*lines, b"$GPZDA,,*4A", b"")), 1.0) is None
    assert reader.malformed == len(lines)
    assert heard(reader, b"!AIVDM,1,1,,B,177KQ" + TYPE_1), "after a sentence that breaks off"
    assert heard(reader, rb"\s:station,c:1671533231*5F" + b"\\" + TYPE_1), "with a tag block"


def test_a_daisy_is_read_whose_messages_are_cut_elsewhere(reader: AisReader) -> None:
    daisy, static = Daisy(), packet(*(line.split(b",")[5].decode() for line in TYPE_5))[:53]
    for number in range(12):
        lines = daisy.hear(static, "AB"[number % 2])
        assert (lines.count(b"\r\n"), lines.split(b",")[3]) == (2, b"%d" % (number % 9 + 1))
        assert reader.feed(lines, 1.0 + number) is not None
    position = daisy.hear(packet(TYPE_19.split(b",")[5].decode()), "B")
    assert position == TYPE_19 + b"\r\n"
    assert [one.name for one in heard(reader, position, said(mmsi=351_759_000))] == [
        "CAPT.J.RIMES",
        "EVER DIADEM",
    ]
    assert reader.malformed == 0


@pytest.mark.parametrize("order", [(1,), (1, 0), (0, 0), (1, 1)])
def test_parts_that_are_lost_or_out_of_order_make_no_message(
    reader: AisReader, order: tuple[int, ...]
) -> None:
    lines = [TYPE_5[number] for number in order]
    assert reader.feed(b"\r\n".join([*lines, b""]), 1.0) is None
    assert reader.malformed == sum(order)
    assert reader.feed(b"\r\n".join([*TYPE_5, b""]), 2.0) is not None, "the next whole one does"


def test_parts_on_both_channels_may_alternate(reader: AisReader) -> None:
    first, second = said(5, 211_000_002, "B", shipname="OTHER").splitlines()
    heard(reader, TYPE_5[0], first, TYPE_5[1], second)
    names = {one.mmsi: one.name for one in heard(reader, said(mmsi=351_759_000), said(mmsi=211_000_002))}
    assert names == {351_759_000: "EVER DIADEM", 211_000_002: "OTHER"}


def test_a_part_that_comes_late_belongs_to_another_message(reader: AisReader) -> None:
    assert reader.feed(TYPE_5[0] + b"\r\n", 1.0) is None
    assert reader.feed(TYPE_5[1] + b"\r\n", 2.1) is None
    assert reader.malformed == 1


def test_a_vessel_that_jumps_is_dropped_until_two_positions_agree(reader: AisReader) -> None:
    assert vessel(reader, said(speed=10.0))
    assert vessel(reader, said(speed=10.0, lat=50.7605), time_s=110.0), "56 m in 10 s at 10 knots"
    assert heard(reader, said(speed=10.0, lat=50.80), time_s=120.0) == ()
    assert heard(reader, said(speed=10.0, lat=50.7605), time_s=130.0) == ()
    back = vessel(reader, said(speed=10.0, lat=50.761), time_s=140.0)
    assert place(back) == pytest.approx((50.761, -1.3))


@pytest.mark.parametrize(
    ("speed_kn", "metres", "is_shown"),
    [(0.0, 60.0, False), (0.0, 40.0, True), (102.3, 460.0, True), (102.3, 600.0, False)],
)
def test_a_vessel_moves_no_farther_than_its_speed_and_error_allow(
    reader: AisReader, speed_kn: float, metres: float, is_shown: bool
) -> None:
    heard(reader, said(speed=speed_kn))
    later = heard(reader, said(speed=speed_kn, lat=50.76 + metres / 111_250.0), time_s=110.0)
    assert bool(later) is is_shown


def test_a_vessel_is_forgotten_ten_minutes_after_its_last_position(reader: AisReader) -> None:
    heard(reader, said())
    assert heard(reader, TYPE_4, time_s=100.0 + LIFE_S)
    assert heard(reader, TYPE_4, time_s=100.1 + LIFE_S) == ()


def test_of_many_vessels_those_heard_last_are_kept(reader: AisReader) -> None:
    for number in range(900):
        part = with_sum(b"AIVDM,9,1,%d,A,0,0" % number)
        found = heard(reader, said(mmsi=201_000_000 + number), part)
    assert len(reader._parts) <= 10
    assert [one.mmsi for one in found] == [201_000_150 + number for number in range(750)]


def test_in_a_port_the_near_vessel_is_kept_while_hundreds_farther_off_report(reader: AisReader) -> None:
    """400 under way tell their positions between two reports of the near one."""
    heard(reader, said(mmsi=201_000_000, lat=0.0, lon=179.999))
    for number in range(1, 400):
        found = heard(reader, said(mmsi=201_000_000 + number, lat=0.0, lon=179.9 - 0.001 * number))
    shown = nearest(AisReading(0.0, tuple(found)), LatLon(0.0, -179.999)).vessels
    assert [one.mmsi for one in shown] == [201_000_000 + number for number in range(100)]


@given(st.lists(st.sampled_from(PUBLISHED) | st.binary(max_size=90), max_size=12), st.data())
def test_reports_are_found_among_garbage_in_any_pieces(lines: list[bytes], data: st.DataObject) -> None:
    stream, reader = b"\n".join([*lines, TYPE_18, b""]), AisReader(pyais.decode)
    readings = []
    while stream:
        size = data.draw(st.integers(1, 200))
        readings.append(reader.feed(stream[:size], 1.0))
        stream = stream[size:]
    assert 338_087_471 in {one.mmsi for one in known(readings[-1]).vessels}


@given(st.binary(max_size=60), st.integers(0, 5))
def test_no_payload_with_a_right_checksum_raises(payload: bytes, fill: int) -> None:
    AisReader(pyais.decode).feed(with_sum(b"AIVDM,1,1,,A," + payload + b",%d" % fill) + b"\n", 1.0)


@given(st.floats(-90.0, 90.0), st.floats(-180.0, 180.0), st.sampled_from((1, 18, 27)))
def test_a_jump_to_anywhere_is_seen(lat: float, lon: float, kind: int) -> None:
    reader = AisReader(pyais.decode)
    heard(reader, said(kind, lat=10.0, lon=10.0))
    later = heard(reader, said(kind, lat=lat, lon=lon), time_s=101.0)
    assert later == () or math.hypot(lat - 10.0, lon - 10.0) < 0.1


def test_a_receiver_is_read_unplugged_and_read_again(wire: MemoryLine, clock: HandClock) -> None:
    reader = AisReader(pyais.decode)
    receiver = ParsedSensor(wire.port, clock, reader)
    receiver.step()
    assert receiver.read() is None
    wire.say(TYPE_1 + b"\r\n" + TYPE_5[0] + b"\r\n" + TYPE_18[:20])
    receiver.step()
    assert len(known(receiver.read()).vessels) == 1
    wire.far.close()
    receiver.step()
    wire.plug_in()
    clock.advance(1.0)
    wire.say(TYPE_5[1] + b"\r\n" + TYPE_18 + b"\r\n")
    receiver.step()
    reading = known(receiver.read())
    assert (reading.time_s, len(reading.vessels)) == (101.0, 2)
    assert reader.malformed == 1
    receiver.close()


@pytest.mark.realtime
def test_a_program_on_the_same_computer_is_read_over_udp(clock: HandClock) -> None:
    """rtl_ais sends the sentences of a message in one datagram."""
    receiver = open_ais(AisPart(driver="nmea", port="udpin:127.0.0.1:0"), clock)
    place = receiver._port.name.rpartition(":")[2]
    with closing(receiver), socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as program:

        def is_heard() -> bool:
            program.sendto(b"\r\n".join([*TYPE_5, TYPE_1, b""]), ("127.0.0.1", int(place)))
            return receiver.read() is not None

        eventually(is_heard)
        assert [one.mmsi for one in known(receiver.read()).vessels] == [477_553_000]


def test_without_pyais_the_error_names_the_extra(monkeypatch: pytest.MonkeyPatch, clock: HandClock) -> None:
    def missing(module: str) -> None:
        raise ModuleNotFoundError(name=module)

    monkeypatch.setattr(importlib, "import_module", missing)
    said = r"AIS receiver: the Python module 'pyais' is missing; pip install '.\[pi\]'"
    with pytest.raises(HardwareError, match=said):
        open_ais(AisPart(driver="nmea", port="udpin:127.0.0.1:0"), clock)
