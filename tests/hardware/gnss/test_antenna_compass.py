"""The heading of two antennas in the boat's parts: sentences, the compass in reserve, configuration."""

import math
from pathlib import Path

import pytest
from twins.lines import HandClock, PtyLine
from twins.ubx_messages import sentence

from companion.app.parts import open_compass, open_gnss
from companion.config.boat_config import BoatConfig, decode_config
from companion.core.errors import HardwareError
from companion.core.readings import HeadingReading
from companion.core.status_text import Severity, StatusText
from companion.core.vectors import Vector
from companion.hal.gnss.nmea import NmeaGnss
from companion.hal.gnss.receiver import GnssReceiver
from companion.hal.heading.antennas import AntennaCompass
from companion.links.memory import MemoryLink, MemoryPort, memory_pair
from companion.sensors.gnss_heading import GnssHeading


class Reserve:
    """A compass that points south."""

    def __init__(self, clock: HandClock) -> None:
        self.is_closed = False
        self.texts: list[StatusText] = []
        self.field_mg: Vector | None = None
        self.died_s = math.inf
        self._clock = clock

    def read(self) -> HeadingReading:
        time_s = min(self._clock(), self.died_s)
        return HeadingReading(time_s, math.pi, roll_rad=1.2, field_mg=self.field_mg, is_magnetic=True)

    def take_texts(self) -> list[StatusText]:
        return self.texts

    def close(self) -> None:
        self.is_closed = True


class Bench:
    def __init__(self, antenna_bearing_deg: float = 0.0) -> None:
        self.clock = HandClock()
        near, self.line = memory_pair(is_datagram=False)
        heading = GnssHeading(math.radians(antenna_bearing_deg), latency_s=0.05, fallback="bno055")
        self.gnss = NmeaGnss(MemoryPort(near), self.clock, 0.05, heading)
        self.reserve = Reserve(self.clock)
        self.compass = AntennaCompass(heading, self.reserve, self.clock)

    def hear(self, *bodies: str) -> None:
        self.line.send(b"".join(map(sentence, bodies)))
        self.gnss.step()

    @property
    def heading_deg(self) -> float:
        reading = self.compass.read()
        assert reading is not None
        return math.degrees(reading.heading_rad) % 360.0


@pytest.mark.parametrize(
    ("body", "heading_deg"),
    [
        ("GNHDT,123.4,T", 123.4),
        ("GNTHS,123.4,A", 123.4),
        ("GNHPR,092700.00,123.4,1.2,0.0,4,12,1.0,0004", 123.4),
        ("GNHPR,092700.00,123.4,1.2,0.0,5,12,1.0,0004", 180.0),  # floating: the ambiguities are open
        ("GNTHS,123.4,V", 180.0),
        ("GNHDT,,T", 180.0),
        ("HCHDG,123.4,,,1.0,W", 180.0),  # a magnetic heading is not the antennas'
    ],
)
def test_sentences_of_a_receiver_with_two_antennas_are_its_heading(body: str, heading_deg: float) -> None:
    bench = Bench()
    bench.hear(body)
    assert bench.heading_deg == pytest.approx(heading_deg)


def test_the_antennas_may_stand_across_the_hull() -> None:
    bench = Bench(antenna_bearing_deg=90.0)  # the other antenna to starboard of the reference
    bench.hear("GNHDT,90.0,T")
    assert bench.heading_deg == pytest.approx(0.0, abs=1e-9)


def test_the_compass_in_reserve_is_used_where_a_heading_a_second_would_be_overdue() -> None:
    bench = Bench()
    bench.hear("GNHDT,10.0,T")
    bench.clock.advance(1.4)
    assert bench.heading_deg == pytest.approx(10.0)
    assert bench.gnss.read() is None
    bench.clock.advance(0.1)
    assert bench.heading_deg == pytest.approx(180.0)
    bench.hear("GNHDT,10.0,T")
    assert bench.heading_deg == pytest.approx(10.0)


def test_the_loss_is_told_after_three_seconds_with_what_is_used_instead() -> None:
    bench = Bench()
    bench.hear("GNHDT,10.0,T")
    bench.clock.advance(3.0)
    bench.gnss.step()
    assert bench.gnss.take_texts() == []
    bench.clock.advance(0.1)
    bench.gnss.step()
    bench.gnss.step()
    assert bench.gnss.take_texts() == [
        StatusText(Severity.WARNING, "GNSS heading lost: receiver silent; using bno055")
    ]
    bench.hear("GNHDT,10.0,T")
    assert bench.gnss.take_texts() == [StatusText(Severity.NOTICE, "GNSS heading is back")]


def test_the_first_heading_may_take_a_minute() -> None:
    bench = Bench()
    bench.hear("GNTXT,01,01,02,ANTSTATUS=OK")
    bench.clock.advance(60.0)
    bench.hear("GNTXT,01,01,02,ANTSTATUS=OK")
    assert bench.gnss.take_texts() == []
    bench.clock.advance(0.1)
    bench.gnss.step()
    assert [text for _, text in bench.gnss.take_texts()] == [
        "GNSS heading lost: no heading from the receiver; using bno055"
    ]


def test_messages_and_the_end_of_the_compass_in_reserve_are_passed_on() -> None:
    bench = Bench()
    bench.reserve.texts.append(StatusText(Severity.WARNING, "compass is silent"))
    assert bench.compass.take_texts() == bench.reserve.texts
    bench.compass.close()
    bench.compass.close()
    assert bench.reserve.is_closed


def test_a_receiver_of_its_own_reports_through_it() -> None:
    bench = Bench()
    alone = AntennaCompass(GnssHeading(), bench.reserve, bench.clock, bench.gnss)
    bench.gnss.notify(Severity.WARNING, "GNSS receiver is silent")
    assert [text for _, text in alone.take_texts()] == ["GNSS receiver is silent"]
    alone.close()
    assert bench.line.is_closed


def test_the_heading_goes_with_the_fixes_while_it_is_recent() -> None:
    bench = Bench()

    def fix_after(seconds: float, *more: str) -> float | None:
        bench.clock.advance(seconds)
        clock = f"0927{bench.clock() % 60.0:05.2f}"
        place = "5030.0,N,00112.0,W"
        bench.hear(
            *more, f"GNRMC,{clock},A,{place},2.0,90.0,280524,,,A", f"GNGGA,{clock},{place},1,9,0.8,9,M,,M,,"
        )
        fix = bench.gnss.read()
        return None if fix is None else fix.heading_rad

    fix_after(0.2, "GNHDT,90.0,T")
    assert fix_after(0.2) == pytest.approx(math.radians(90.0))
    assert fix_after(1.0) == pytest.approx(math.radians(90.0))
    assert fix_after(0.4) is None


def boat_with(device: str, **compass: object) -> BoatConfig:
    parts = {
        "gnss": {"driver": "nmea", "port": device, "antenna_bearing_rad": 0.5},
        "compass": {"driver": "gnss", **compass},
    }
    return decode_config({"links": ["udpin::14550"], "parts": parts}, "test")


@pytest.mark.realtime
def test_a_compass_of_antennas_opens_the_receivers_line_by_itself(tmp_path: Path) -> None:
    line, clock = PtyLine(tmp_path / "ttyGNSS"), HandClock()
    config = boat_with(line.device)
    gnss = open_gnss(config, clock)
    assert isinstance(gnss, GnssReceiver)
    gnss.close()
    alone = open_compass(config, clock)  # as the doctor opens it, without the receiver
    alone.close()
    again = open_gnss(config, clock)  # the line is free again
    again.close()
    line.unplug()


def test_a_heading_needs_a_receiver_with_antennas() -> None:
    config = decode_config({"links": ["udpin::14550"], "parts": {"compass": {"driver": "gnss"}}}, "test")
    with pytest.raises(HardwareError, match=r"parts\.compass\.driver"):
        open_compass(config, HandClock())


def test_a_link_in_memory_is_closed_with_its_receiver() -> None:
    bench = Bench()
    bench.gnss.close()
    assert isinstance(bench.line, MemoryLink)
    assert bench.line.is_closed


def test_a_magnetometer_in_reserve_can_be_calibrated_meanwhile() -> None:
    bench = Bench()
    bench.reserve.field_mg = (190.0, 20.0, 440.0)
    bench.hear("GNHDT,10.0,T")
    reading = bench.compass.read()
    assert reading is not None
    assert math.degrees(reading.heading_rad) == pytest.approx(10.0)
    assert not reading.is_magnetic
    assert reading.field_mg == (190.0, 20.0, 440.0)
    assert bench.compass.read() is reading


def test_what_a_dead_magnetometer_in_reserve_measured_last_is_not_passed_on_with_new_headings() -> None:
    bench = Bench()
    bench.reserve.field_mg = (190.0, 20.0, 440.0)
    bench.reserve.died_s = bench.clock()
    for _ in range(3):
        bench.clock.advance(1.0)
        bench.hear("GNHDT,10.0,T")
    reading = bench.compass.read()
    assert reading is not None
    assert math.degrees(reading.heading_rad) == pytest.approx(10.0)
    assert (reading.field_mg, reading.roll_rad) == (None, None)
