"""Depth sounders over pseudo-terminals and in memory: NMEA 0183 and Ping1D, with their faults."""

import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st
from twins.lines import HandClock, MemoryLine, known
from twins.sounders import Ping1dTwin
from twins.ubx_messages import sentence

from companion.config.sensors import DepthPart
from companion.core.readings import DepthReading
from companion.hal.gnss.receiver import NmeaGnss
from companion.hal.nmea_sensor import NmeaSensor, SharedDepthSounder, depth_assembler
from companion.hal.ping1d import Ping1d, PingReader
from companion.sensors.nmea.depth import DEPTH_SENTENCES

PART = DepthPart(driver="nmea")


def sounding(sounder: NmeaSensor[DepthReading], wire: MemoryLine, *sentences: str) -> DepthReading | None:
    wire.say(b"".join(map(sentence, sentences)))
    sounder.step()
    return sounder.read()


@pytest.fixture
def sounder(wire: MemoryLine, clock: HandClock) -> NmeaSensor[DepthReading]:
    return NmeaSensor(wire.port, clock, DEPTH_SENTENCES, depth_assembler(PART).feed)


def test_dpt_is_below_the_transducer_and_its_offset_to_the_surface_counts(
    sounder: NmeaSensor[DepthReading], wire: MemoryLine, clock: HandClock
) -> None:
    reading = sounding(sounder, wire, "SDDPT,2.1,0.3")
    assert reading == DepthReading(clock(), 2.1, None, 0.3, 0.3, 100.0)
    assert reading.water_m == pytest.approx(2.4)
    keel = known(sounding(sounder, wire, "SDDPT,2.1,-0.5,100.0"))  # to the keel: says nothing of the surface
    assert keel.water_m == 2.1


@pytest.mark.parametrize(
    "body", ["SDDBT,006.9,f,002.1,M,001.1,F", "SDDBT,006.89,f,,M,,F", "SDDBT,,f,,M,1.148,F"]
)
def test_dbt_is_read_in_whichever_unit_it_has(
    sounder: NmeaSensor[DepthReading], wire: MemoryLine, body: str
) -> None:
    reading = known(sounding(sounder, wire, body))
    assert reading.depth_m == pytest.approx(2.1, abs=0.005)


def test_dpt_suppresses_dbt_for_two_seconds(
    sounder: NmeaSensor[DepthReading], wire: MemoryLine, clock: HandClock
) -> None:
    reading = known(sounding(sounder, wire, "SDDPT,2.1,0.3", "SDDBT,6.9,f,2.1,M,1.1,F"))
    assert reading.transducer_m == 0.3
    clock.advance(2.0)
    reading = known(sounding(sounder, wire, "SDDBT,13.1,f,4.0,M,2.2,F"))
    assert (reading.depth_m, reading.transducer_m) == (4.0, 0.0)


def test_the_temperature_lives_for_ten_seconds(
    sounder: NmeaSensor[DepthReading], wire: MemoryLine, clock: HandClock
) -> None:
    assert sounding(sounder, wire, "SDMTW,18.5,C") is None
    for age_s, celsius in ((10.0, 18.5), (0.1, None)):
        clock.advance(age_s)
        reading = known(sounding(sounder, wire, "SDDPT,2.1,"))
        assert reading.temperature_c == celsius


@pytest.mark.parametrize("depth", ["", "0.0", "-1.0", "100.1"])
def test_no_bottom_is_a_reading_without_a_depth(
    sounder: NmeaSensor[DepthReading], wire: MemoryLine, depth: str
) -> None:
    reading = known(sounding(sounder, wire, f"SDDPT,{depth},0.3"))
    assert reading.depth_m is reading.water_m is None


def test_a_sounder_may_share_the_receivers_line(wire: MemoryLine, clock: HandClock) -> None:
    gnss = NmeaGnss(wire.port, clock)
    depth = SharedDepthSounder(DepthPart(driver="gnss"))
    depth.listen_to(gnss)
    assert depth.read() is None
    for second in ("00", "01"):
        wire.say(sentence(f"GNGGA,1200{second}.00,5000.00000,N,00112.00000,W,1,12,0.90,0.0,M,0.0,M,,"))
        wire.say(sentence(f"GNRMC,1200{second}.00,A,5000.00000,N,00112.00000,W,0.1,0.0,221126,,,A"))
        wire.say(sentence("SDDPT,2.1,0.3") + sentence("SDMTW,18.5,C"))
    gnss.step()
    reading = known(depth.read())
    assert reading.depth_m == 2.1
    assert gnss.read() is not None
    wire.say(sentence("SDDPT,2.2,0.3"))
    gnss.step()
    reading = known(depth.read())
    assert (reading.depth_m, reading.temperature_c) == (2.2, 18.5)
    depth.close()


# Ping1D


@pytest.fixture
def twin() -> Ping1dTwin:
    return Ping1dTwin()


@pytest.fixture
def ping(wire: MemoryLine, clock: HandClock) -> Ping1d:
    return Ping1d(wire.port, clock, DepthPart(driver="ping1d", transducer_m=0.15))


def interval(ping: Ping1d, twin: Ping1dTwin, wire: MemoryLine, clock: HandClock) -> DepthReading | None:
    """A tenth of a second: the part hears and measures, the driver reads."""
    ping.step()
    if said := twin.hear(wire.heard()) + twin.say():
        wire.say(said)
    ping.step()
    clock.advance(0.1)
    return ping.read()


def test_the_part_is_set_up_and_its_distance_is_the_depth(
    ping: Ping1d, twin: Ping1dTwin, wire: MemoryLine, clock: HandClock
) -> None:
    reading = interval(ping, twin, wire, clock)
    assert twin.settings == {1002: (1_480_000).to_bytes(4, "little"), 1003: b"\x01", 1004: b"\xc8\x00"}
    assert twin.streams == {1211}
    assert reading is not None
    assert (reading.depth_m, reading.quality) == (3.25, 0.97)
    assert reading.water_m == pytest.approx(3.4)
    assert twin.wrong_sums == ping.reader.skipped == 0


@pytest.mark.parametrize(("confidence", "is_found"), [(50, True), (49, False), (0, False)])
def test_an_uncertain_distance_is_no_bottom(
    ping: Ping1d, twin: Ping1dTwin, wire: MemoryLine, clock: HandClock, confidence: int, is_found: bool
) -> None:
    twin.confidence = confidence
    reading = known(interval(ping, twin, wire, clock))
    assert (reading.depth_m is not None) is is_found


def test_a_part_that_lost_its_supply_is_told_again_within_seconds_and_not_more_often(
    ping: Ping1d, twin: Ping1dTwin, wire: MemoryLine, clock: HandClock
) -> None:
    before = interval(ping, twin, wire, clock)
    twin.power_up()
    commands = []
    for _ in range(45):
        ping.step()
        if data := wire.heard():
            commands.append(clock() - 100.0)
            if len(commands) == 2:
                wire.say(twin.hear(data) + twin.say())
        clock.advance(0.1)
    assert commands == pytest.approx([2.1, 4.2], abs=0.11)
    ping.step()
    after = ping.read()
    assert before is not None
    assert after is not None
    assert after.time_s > before.time_s


@given(st.lists(st.integers(0, 100_000), max_size=8), st.data())
def test_frames_are_found_among_garbage_in_any_pieces(depths: list[int], data: st.DataObject) -> None:
    garbage = st.binary(max_size=20).map(lambda noise: noise.replace(b"B", b""))
    frames = [Ping1dTwin.frame(1211, struct.pack("<IB", depth, 90)) for depth in depths]
    stream = b"".join(data.draw(garbage) + frame for frame in frames)
    parser, found = PingReader(), list[bytes]()
    while stream:
        size = data.draw(st.integers(1, 30))
        found += [frame[8:-2] for frame in parser.split(stream[:size])]
        stream = stream[size:]
    assert found == [frame[8:-2] for frame in frames]


@given(st.binary(max_size=600))
def test_garbage_is_never_raised_and_not_kept(noise: bytes) -> None:
    parser = PingReader()
    parser.split(noise + b"BR" + noise)
    assert len(parser._held) < 270
