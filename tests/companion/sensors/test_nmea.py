"""NMEA 0183, from bytes to fixes and headings."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from twins.lines import known
from twins.ubx_messages import sentence

from companion.core.readings import GnssFix, HeadingReading
from companion.sensors.nmea.fix import GNSS_SENTENCES, FixAssembler
from companion.sensors.nmea.heading import HEADING_SENTENCES, HeadingAssembler
from companion.sensors.nmea.sentences import NmeaReader

KNOT_M_S = 1852.0 / 3600.0


def stream(*bodies: str) -> bytes:
    return b"".join(map(sentence, bodies))


def gga(time: str = "092750.00", quality: int = 1) -> str:
    return f"GNGGA,{time},5030.0000,N,00112.0000,W,{quality},9,0.85,12.5,M,47.0,M,,"


def rmc(time: str = "092750.00", status: str = "A", course: str = "90.00") -> str:
    return f"GNRMC,{time},{status},5030.0000,N,00112.0000,W,2.000,{course},280524,,,A"


def fixes_from(data: bytes, time_s: float = 1.0) -> list[GnssFix]:
    reader, assembler = NmeaReader(GNSS_SENTENCES), FixAssembler()
    return [fix for said in reader.feed(data) for fix in assembler.feed(said, time_s)]


def heading_from(*bodies: str, correction_rad: float = 0.0) -> HeadingReading | None:
    reader, assembler = NmeaReader(HEADING_SENTENCES), HeadingAssembler(correction_rad)
    reading = None
    for said in reader.feed(stream(*bodies)):
        reading = assembler.feed(said, 1.0) or reading
    return reading


def test_the_sentences_of_one_epoch_make_one_fix() -> None:
    gsa = "GNGSA,A,3,1,2,3,,,,,,,,,,1.8,0.9,1.5"
    gst = "GNGST,092750.00,1.8,,,,3.0,4.0,2.2"
    (fix,) = fixes_from(stream(rmc(), gga(), gsa, gst, rmc("092751.00")))
    assert fix.position.lat_deg == pytest.approx(50.5)
    assert fix.position.lon_deg == pytest.approx(-1.2)
    assert (fix.fix_type, fix.satellites, fix.hdop, fix.altitude_m) == (3, 9, 0.85, 12.5)
    assert fix.north_m_s == pytest.approx(0.0, abs=1e-12)
    assert fix.east_m_s == pytest.approx(2.0 * KNOT_M_S)
    assert fix.horizontal_accuracy_m == pytest.approx(5.0)
    assert fix.unix_time_s == 1716888470.0  # 2024-05-28 09:27:50 UTC
    assert fix.time_of_day_s == 34_070.0


def test_from_the_second_epoch_on_a_fix_comes_with_its_last_sentence() -> None:
    reader, assembler = NmeaReader(GNSS_SENTENCES), FixAssembler()
    arrivals: list[tuple[float, float]] = []
    for second in range(3):
        time = f"09275{second}.00"
        for step, body in enumerate((rmc(time), gga(time), "GNVTG,90.00,T,,M,2.000,N,3.704,K,A")):
            time_s = second + 0.1 * step
            for said in reader.feed(sentence(body)):
                arrivals += [(time_s, fix.time_s) for fix in assembler.feed(said, time_s)]
    assert arrivals == [(1.0, 0.0), (1.2, 1.0), (2.2, 2.0)]


def test_a_receiver_whose_order_changes_is_learnt_anew() -> None:
    vtg = "GNVTG,180.00,T,,M,4.000,N,7.408,K,A"
    times = [f"09275{second}.00" for second in range(6)]
    fixes = fixes_from(stream(*(body for time in times for body in (gga(time), vtg))))
    assert [fix.north_m_s is not None for fix in fixes] == [True] * 6
    with_less = (gga("092800.00"), vtg, gga("092801.00"), gga("092802.00"), gga("092803.00"))
    fixes = fixes_from(stream(*with_less))
    assert [fix.north_m_s is not None for fix in fixes] == [True, False, False, False]


def test_one_gns_for_each_constellation_makes_one_fix() -> None:
    gns = "{}GNS,{},5030.0000,N,00112.0000,W,{},{},1.0,12.5,47.0,,"
    times = ("092750.00", "092751.00", "092752.00")
    bodies = [gns.format(*part) for time in times for part in (("GP", time, "A", 7), ("GL", time, "D", 5))]
    assert [fix.fix_type for fix in fixes_from(stream(*bodies))] == [4, 4, 4]


@pytest.mark.parametrize(
    ("quality", "fix_type"), [(0, 1), (1, 3), (2, 4), (3, 3), (4, 6), (5, 5), (6, 1), (7, 1), (8, 3), (9, 1)]
)
def test_the_quality_of_a_gga_becomes_mavlinks_fix_type(quality: int, fix_type: int) -> None:
    fix = fixes_from(stream(gga(quality=quality), gga("092751.00")))[0]
    assert fix.fix_type == fix_type


@pytest.mark.parametrize(
    ("modes", "fix_type"), [("N", 1), ("AAN", 3), ("AD", 4), ("FA", 5), ("RF", 6), ("EM", 1)]
)
def test_the_best_constellation_of_a_gns_decides_the_fix_type(modes: str, fix_type: int) -> None:
    gns = "GNGNS,{},5030.0000,N,00112.0000,W,{},12,1.0,12.5,47.0,,"
    fix = fixes_from(stream(gns.format("092750.00", modes), gns.format("092751.00", modes)))[0]
    assert (fix.fix_type, fix.satellites, fix.hdop) == (fix_type, 12, 1.0)


# What a GlobalTop receiver (MediaTek MT3339) sends after a cold start, before it has seen a satellite
COLD = """\
$GPRMC,003300.799,V,,,,,0.00,0.00,060180,,,N*45
$GPVTG,0.00,T,,M,0.00,N,0.00,K,N*32
$GPGGA,003301.799,,,,,0,0,,,M,,M,,*4E
$GPGSA,A,1,,,,,,,,,,,,,,,*1E
$GPRMC,003301.799,V,,,,,0.00,0.00,060180,,,N*44
$GPVTG,0.00,T,,M,0.00,N,0.00,K,N*32
$GPGGA,003302.799,,,,,0,0,,,M,,M,,*4D
$GPGSA,A,1,,,,,,,,,,,,,,,*1E
"""


def test_the_date_of_a_receiver_without_a_fix_is_never_given_out() -> None:
    for line in COLD.split():
        assert sentence(line[1:-3]) == f"{line}\r\n".encode()  # else it would be dropped
    fixes = fixes_from(COLD.replace("\n", "\r\n").encode())
    assert len(fixes) >= 2
    assert {(fix.fix_type, fix.unix_time_s) for fix in fixes} == {(1, None)}


def test_a_flat_solution_is_two_dimensional_and_a_warning_is_no_fix() -> None:
    gsa = "GNGSA,A,2,1,2,3,,,,,,,,,,1.8,0.9,1.5"
    (fix,) = fixes_from(stream(gga(), gsa, gga("092751.00")))
    assert fix.fix_type == 2
    (fix,) = fixes_from(stream(rmc(status="V"), gga(), rmc("092751.00")))
    assert fix.fix_type == 1
    assert fix.east_m_s is None


def test_a_receiver_without_a_fix_still_shows_that_it_is_alive() -> None:
    cold = ("GNRMC,,V,,,,,,,,,,N", "GNGGA,,,,,,0,03,,,,,,,")
    fixes = fixes_from(stream(*cold, *cold, *cold))
    assert [(fix.fix_type, fix.satellites) for fix in fixes] == [(1, 3), (1, 3), (1, 3)]
    warm = fixes_from(stream(rmc(), gga(), *cold, *cold))
    assert [fix.fix_type for fix in warm] == [3, 1, 1]
    assert warm[-1].position == warm[0].position


@pytest.mark.parametrize(
    ("body", "heading_deg"),
    [
        ("HEHDT,90.0,T", 90.0),
        ("HEHDT,270.0,T", -90.0),
        ("GNTHS,10.5,A", 10.5),
        ("HCHDG,100.0,2.0,E,7.0,W", 95.0),
        ("HCHDG,100.0,,,7.0,E", 107.0),
        ("HCHDG,100.0,2.0,W,,", 98.0),
        ("HCHDM,100.0,M", 100.0),
    ],
)
def test_every_kind_of_heading_is_understood(body: str, heading_deg: float) -> None:
    reading = known(heading_from(body))
    assert math.degrees(reading.heading_rad) == pytest.approx(heading_deg)
    turned = known(heading_from(body, correction_rad=0.1))
    assert turned.heading_rad == pytest.approx(reading.heading_rad + 0.1)


@pytest.mark.parametrize("body", ["GNTHS,10.5,V", "HEHDT,,T", "HCHDM,,M", "HCHDG,,,,7.0,W"])
def test_an_invalid_or_empty_heading_is_none(body: str) -> None:
    assert heading_from(body) is None


def test_a_true_heading_silences_a_magnetic_one_for_two_seconds() -> None:
    reader, assembler = NmeaReader(HEADING_SENTENCES), HeadingAssembler()
    true, magnetic = reader.feed(stream("HEHDT,90.0,T", "HCHDM,80.0,M"))
    assert assembler.feed(magnetic, 0.0) is not None
    assert assembler.feed(true, 0.1) is not None
    assert assembler.feed(magnetic, 2.0) is None
    assert assembler.feed(magnetic, 2.2) is not None


def test_rate_of_turn_becomes_the_yaw_rate() -> None:
    reading = known(heading_from("TIROT,60.0,A", "HEHDT,90.0,T"))
    assert reading.yaw_rate_rad_s == pytest.approx(math.radians(1.0))
    reading = known(heading_from("TIROT,60.0,V", "HEHDT,90.0,T"))
    assert reading.yaw_rate_rad_s is None


def test_faults_are_counted_and_the_next_sentence_is_read() -> None:
    reader = NmeaReader(GNSS_SENTENCES)
    good = sentence(gga())
    assert reader.feed(good.replace(b"5030", b"5031")) == []
    assert reader.feed(b"\xff\xfe garbage\r\n") == []
    assert reader.feed(good[:20] + good)[0].kind == "GGA"
    assert reader.feed(b"A" * 5000) == []
    assert reader.feed(b"\r\n" + good)[0].kind == "GGA"
    assert reader.feed(sentence("GPGSV,1,1,01,05,30,120,40")) == []
    assert (reader.accepted, reader.malformed, reader.skipped) == (2, 3, 1)


def test_half_a_sentence_waits_for_its_other_half_unless_the_line_was_cut() -> None:
    reader = NmeaReader(GNSS_SENTENCES)
    good = sentence(gga())
    assert reader.feed(good[:30]) == []
    assert [said.kind for said in reader.feed(good[30:])] == ["GGA"]
    reader.feed(good[:30])
    reader.forget()
    assert reader.feed(good[30:]) == []


SAMPLES = [
    gga(),
    gga("092751.00", 0),
    rmc(),
    rmc("092752.20", "V", ""),
    "GNVTG,90.00,T,,M,2.000,N,3.704,K,A",
    "GNGSA,A,3,1,2,3,,,,,,,,,,1.8,0.9,1.5",
    "GNGNS,092750.00,5030.0000,N,00112.0000,W,AAN,12,1.0,12.5,47.0,,",
    "GNGLL,5030.0000,N,00112.0000,W,092750.00,A,A",
    "GNGST,092750.00,1.8,,,,3.0,4.0,2.2",
    "HCHDG,100.0,2.0,E,7.0,W",
    "HEHDT,90.0,T",
    "GNTHS,10.5,A",
    "TIROT,60.0,A",
]


@given(st.lists(st.sampled_from(SAMPLES), max_size=12), st.lists(st.integers(1, 40)))
def test_where_the_stream_is_cut_makes_no_difference(bodies: list[str], cuts: list[int]) -> None:
    data = stream(*bodies)
    reader, rest, pieces = NmeaReader(GNSS_SENTENCES | HEADING_SENTENCES), data, []
    for cut in cuts:
        pieces.append(rest[:cut])
        rest = rest[cut:]
    kinds = [said.kind for piece in [*pieces, rest] for said in reader.feed(piece)]
    assert kinds == [body[2:5] for body in bodies]
    assert reader.malformed == 0


@given(
    st.lists(
        st.one_of(
            st.binary(max_size=60),
            st.sampled_from(SAMPLES).map(sentence),
            st.tuples(st.sampled_from(SAMPLES), st.integers(6, 60), st.characters(codec="ascii")).map(
                lambda change: sentence(change[0][: change[1]] + change[2] + change[0][change[1] + 1 :])
            ),
        )
    )
)
def test_garbage_and_wrong_fields_never_raise_and_never_leave_the_globe(pieces: list[bytes]) -> None:
    reader = NmeaReader(GNSS_SENTENCES | HEADING_SENTENCES)
    fixes, headings = FixAssembler(), HeadingAssembler()
    for piece in pieces:
        for said in reader.feed(piece):
            if said.kind in GNSS_SENTENCES:
                for fix in fixes.feed(said, 1.0):
                    assert 1 <= fix.fix_type <= 6
                    assert abs(fix.position.lat_deg) <= 90.0
                    assert math.isfinite(fix.hdop + fix.altitude_m)
            else:
                reading = headings.feed(said, 1.0)
                assert reading is None or -math.pi <= reading.heading_rad < math.pi
