"""Rangers on serial lines, over a pseudo-terminal: A02YYUW and TFmini."""

from collections.abc import Iterator
from functools import partial

import pytest
from hypothesis import given
from hypothesis import strategies as st
from twins.lines import HandClock, PtyLine
from twins.rangers import a02yyuw_frame, tfmini_frame

from companion.core.errors import HardwareError
from companion.hal.ranging.serial_ranger import (
    A02YYUW,
    TFMINI,
    RangerReader,
    SerialRanger,
    a02yyuw_range_m,
    tfmini_range_m,
)
from companion.links.port_url import open_line

tfmini = partial(tfmini_range_m, min_strength=100)


def test_the_frames_of_the_data_sheets() -> None:
    assert RangerReader(A02YYUW).split(bytes.fromhex("FF07A1A7")) == [bytes.fromhex("FF07A1A7")]
    assert a02yyuw_range_m(bytes.fromhex("FF07A1A7")) == 1.953  # the example of the data sheet
    assert (A02YYUW.baud, TFMINI.baud) == (9600, 115_200)
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


@pytest.fixture
def ranger(line: PtyLine) -> Iterator[SerialRanger]:
    port = open_line(line.device, 9600, HandClock())
    ranger = SerialRanger(port, A02YYUW, a02yyuw_range_m, 4.5, HandClock())
    yield ranger
    ranger.close()
    ranger.close()


def test_a_closed_ranger_leaves_its_port_to_others(line: PtyLine, ranger: SerialRanger) -> None:
    line.say(a02yyuw_frame(1000))
    assert ranger.ping_m() == 1.0
    (link,) = ranger._links
    ranger.close()
    assert link.is_closed


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
