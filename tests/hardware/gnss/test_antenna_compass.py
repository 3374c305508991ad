"""The heading of two antennas in the boat's parts: sentences, the compass in reserve, configuration."""

import math

import pytest
from twins.lines import HandClock, known
from twins.ubx_messages import sentence

from companion.core.readings import HeadingReading
from companion.core.status_text import Severity, StatusText
from companion.core.vectors import Vector
from companion.hal.gnss.receiver import NmeaGnss
from companion.hal.heading.antennas import AntennaCompass
from companion.links.memory import MemoryPort, memory_pair
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
        reading = known(self.compass.read())
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


def test_a_magnetometer_in_reserve_can_be_calibrated_meanwhile() -> None:
    bench = Bench()
    bench.reserve.field_mg = (190.0, 20.0, 440.0)
    bench.hear("GNHDT,10.0,T")
    reading = known(bench.compass.read())
    assert math.degrees(reading.heading_rad) == pytest.approx(10.0)
    assert not reading.is_magnetic
    assert reading.field_mg == (190.0, 20.0, 440.0)
    assert bench.compass.read() is reading
