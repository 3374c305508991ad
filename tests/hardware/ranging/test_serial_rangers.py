"""Rangers on serial lines, over a pseudo-terminal: A02YYUW and TFmini."""

import math
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import pytest
from boat_rig import nav_at
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace
from twins.lines import HandClock, PtyLine, eventually
from twins.rangers import a02yyuw_frame, tfmini_frame

from companion.config.sensors import RangerPart
from companion.config.tuning import AvoidanceSetting
from companion.core.errors import HardwareError
from companion.core.geo import Point
from companion.core.readings import SonarReading
from companion.hal.ranging.mounted_ranger import MountedRanger, open_ranger
from companion.hal.ranging.serial_ranger import (
    A02YYUW,
    TFMINI,
    RangerReader,
    SerialRanger,
    a02yyuw_range_m,
    tfmini_range_m,
)
from companion.links.memory import MemoryPort, memory_pair
from companion.links.port_url import open_line
from companion.obstacles.perception.perception import ObstaclePerception

tfmini = partial(tfmini_range_m, min_strength=100)


def test_the_frames_of_the_data_sheets() -> None:
    assert RangerReader(A02YYUW).split(bytes.fromhex("FF07A1A7")) == [bytes.fromhex("FF07A1A7")]
    assert a02yyuw_range_m(bytes.fromhex("FF07A1A7")) == 1.953  # the example of the data sheet
    assert a02yyuw_frame(1953) == bytes.fromhex("FF07A1A7")
    assert tfmini(tfmini_frame(1000)) == 10.0


def test_open_water_is_no_echo() -> None:
    assert a02yyuw_range_m(a02yyuw_frame(0)) is None
    assert tfmini(tfmini_frame(-1, 30)) is None  # 5.4, table 8: strength below 100
    assert tfmini(tfmini_frame(500, 99)) is None
    assert tfmini(tfmini_frame(500, 100)) == 5.0
    assert tfmini_range_m(tfmini_frame(500, 20), min_strength=20) == 5.0


@pytest.mark.parametrize(("centimetres", "strength"), [(-2, -1), (-4, 2000), (300, -1)])
def test_a_blinded_lidar_is_a_fault_and_not_free_water(centimetres: int, strength: int) -> None:
    with pytest.raises(HardwareError, match="blinded"):
        tfmini(tfmini_frame(centimetres, strength))


@given(st.lists(st.integers(0, 4500)), st.data())
def test_frames_are_found_among_garbage_in_any_pieces(ranges: list[int], data: st.DataObject) -> None:
    garbage = st.binary(max_size=12).map(lambda noise: noise.replace(b"\xff", b""))
    stream = b"".join(data.draw(garbage) + a02yyuw_frame(one) for one in ranges)
    parser, found = RangerReader(A02YYUW), list[bytes]()
    while stream:
        size = data.draw(st.integers(1, 9))
        found += parser.split(stream[:size])
        stream = stream[size:]
    assert found == [a02yyuw_frame(one) for one in ranges]


@given(st.binary(max_size=200))
def test_garbage_is_never_raised_and_not_kept(noise: bytes) -> None:
    for kind in (A02YYUW, TFMINI):
        parser = RangerReader(kind)
        for frame in parser.split(noise):
            assert sum(frame[:-1]) & 0xFF == frame[-1]
        assert len(parser._held) < kind.length


def test_a_stray_header_costs_no_frame() -> None:
    good = a02yyuw_frame(1953)
    assert RangerReader(A02YYUW).split(b"\xff" + good + b"\xff\xff" + good) == [good, good]


@pytest.fixture
def line(tmp_path: Path) -> Iterator[PtyLine]:
    line = PtyLine(tmp_path / "ranger")
    yield line
    line.unplug()


@pytest.fixture
def ranger(line: PtyLine) -> Iterator[SerialRanger]:
    port = open_line(line.device, 9600, HandClock())
    ranger = SerialRanger(port, A02YYUW, a02yyuw_range_m, 4.5, HandClock())
    yield ranger
    ranger.close()
    ranger.close()


@pytest.mark.realtime
def test_what_was_measured_before_a_turn_is_dropped(line: PtyLine, ranger: SerialRanger) -> None:
    line.say(a02yyuw_frame(1000) + a02yyuw_frame(1000)[:2])
    assert ranger.ping_m() == 1.0
    line.say(a02yyuw_frame(1000)[2:])
    ranger.forget()
    line.say(a02yyuw_frame(3000))
    assert ranger.ping_m() == 3.0


class Ticking(HandClock):
    """A clock that moves on at each look."""

    def __call__(self) -> float:
        self.now_s += 0.2
        return self.now_s


def test_a_silent_line_is_a_fault_within_half_a_second(line: PtyLine) -> None:
    clock = Ticking()
    ranger = SerialRanger(open_line(line.device, 9600, clock), A02YYUW, a02yyuw_range_m, 4.5, clock)
    began_s = clock.now_s
    with pytest.raises(HardwareError, match="A02YYUW: no frames; check its wires and serial:"):
        ranger.ping_m()
    assert clock.now_s - began_s < 1.5
    ranger.close()


def readings(sonar: MountedRanger, into: list[SonarReading]) -> list[SonarReading]:
    into += sonar.read()
    return into


@pytest.mark.realtime
def test_an_unplugged_ranger_pings_again_when_it_is_back(line: PtyLine) -> None:
    clock = HandClock()
    part = RangerPart(driver="tfmini", port=line.device)
    sonar = open_ranger(part, clock)
    seen: list[SonarReading] = []
    try:
        line.say(tfmini_frame(300))
        eventually(lambda: readings(sonar, seen))
        assert (seen[0].range_m, seen[0].bearing_rad) == (3.0, 0.0)
        assert (seen[0].min_range_m, seen[0].max_range_m) == (0.1, 12.0)
        line.unplug()
        line.plug_in()

        def is_back() -> bool:
            clock.advance(0.1)
            line.say(tfmini_frame(700))
            return any(reading.range_m == 7.0 for reading in readings(sonar, seen))

        eventually(is_back)
    finally:
        sonar.close()


def test_a_tfmini_shows_the_boats_map_what_is_nine_metres_ahead() -> None:
    """From the bytes on the line to a solid cell, and to water that counts as looked at."""
    near, far = memory_pair("tfmini")
    clock = HandClock()
    ranger = MountedRanger(SerialRanger(MemoryPort(near), TFMINI, tfmini, 12.0), clock, range_m=(0.3, 12.0))
    setting = AvoidanceSetting(lookahead_m=12.0, beam_rad=math.radians(3.6))
    perception = ObstaclePerception(setting)
    perception.water.is_used = True
    for _ in range(3):
        far.send(tfmini_frame(900))
        ranger.step()
        pings = [(reading, None) for reading in ranger.read()]
        perception.ingest(pings, replace(nav_at(), time_s=clock.now_s), setting, clock.now_s)
        clock.now_s += 0.1
    assert perception.reach_m == 12.0
    assert {round(cell.north_m) for cell in perception.solid(clock.now_s)} == {9}
    assert perception.water.is_known(Point(8.2, 0.0))
    assert not perception.water.is_known(Point(9.5, 0.0))
    ranger.close()
