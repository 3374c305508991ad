"""Links that carry as badly as their settings say, whatever driver is below."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.core.errors import ConfigError
from companion.links.memory import MemoryPort, memory_pair
from sitl.radio.channel import WHOLE, LinkSettings, Quality
from sitl.run.air import Air, AirLink, AirPort
from sitl.scenarios.scenario import load_scenario
from sitl.world.computer import Computer


class Line:
    """A link over the air with its far end, and the time."""

    def __init__(self, settings: LinkSettings, seed: int = 1) -> None:
        self.now_s = 0.0
        self.computer = Computer()
        near, self.far = memory_pair("line")
        self.near = AirLink(near, Air(settings, seed, self.computer, lambda: self.now_s))

    def carry(self, count: int, step_s: float = 0.01) -> tuple[list[bytes], list[bytes]]:
        """Send so many each way and wait a while: what came in, and what came out."""
        inward: list[bytes] = []
        outward: list[bytes] = []
        for number in range(count + 500):
            if number < count:
                self.near.send(b"out%d" % number)
                self.far.send(b"in%d" % number)
            self.now_s += step_s
            inward += self.near.receive()
            outward += self.far.receive()
        return inward, outward


def test_loss_holds_both_ways_and_each_way_by_itself() -> None:
    inward, outward = Line(LinkSettings(loss=0.5)).carry(1000)
    assert 400 < len(inward) < 600
    assert 400 < len(outward) < 600
    assert [data[2:] for data in inward] != [data[3:] for data in outward]


@given(
    st.builds(
        LinkSettings,
        loss=st.floats(0.0, 1.0),
        delay_s=st.floats(0.0, 1.0),
        jitter_s=st.floats(0.0, 1.0),
        duplication=st.floats(0.0, 1.0),
        reordering=st.floats(0.0, 1.0),
    )
)
def test_nothing_is_made_up_or_altered_and_nothing_is_late_beyond_its_bounds(settings: LinkSettings) -> None:
    inward, outward = Line(settings).carry(30)
    assert set(inward) <= {b"in%d" % number for number in range(30)}
    assert set(outward) <= {b"out%d" % number for number in range(30)}
    if settings.loss == 0.0:
        assert len(set(inward)) == len(set(outward)) == 30


def test_an_outage_swallows_what_is_sent_in_it_and_nothing_else() -> None:
    inward, outward = Line(LinkSettings(outages=((0.5, 1.0),))).carry(200)
    gone = {b"in%d" % number for number in range(200)} - set(inward)
    assert 48 <= len(gone) <= 52
    assert 48 <= 200 - len(outward) <= 52


def test_a_fault_comes_on_top_of_the_settings_and_goes_again() -> None:
    line = Line(LinkSettings(delay_s=0.1))
    line.computer.link_quality = Quality(loss=1.0)
    assert line.carry(10) == ([], [])
    line.computer.link_quality = Quality(delay_s=0.4)
    line.far.send(b"late")
    sent_s = line.now_s
    while not line.near.receive():
        line.now_s += 0.01
    assert line.now_s - sent_s == pytest.approx(0.5, abs=0.02)


def test_what_was_on_its_way_arrives_after_the_fault_is_over() -> None:
    line = Line(LinkSettings())
    line.computer.link_quality = Quality(delay_s=0.4)
    line.near.send(b"slow")
    line.computer.link_quality = WHOLE
    line.near.send(b"behind")
    assert line.far.receive() == [b"behind"]
    line.now_s = 0.5
    line.near.receive()
    assert line.far.receive() == [b"slow"]


def test_a_port_hands_out_links_that_go_through_the_air() -> None:
    near, far = memory_pair("line")
    air = Air(LinkSettings(loss=1.0), 1, Computer(), lambda: 0.0)
    port = AirPort(MemoryPort(near, name="tcpin:1"), air)
    (link,) = port.accept()
    assert (port.name, port.fileno(), link.name, link.fileno()) == ("tcpin:1", -1, near.name, -1)
    assert link.is_datagram
    link.send(b"lost")
    assert far.receive() == []
    port.close()
    assert far.is_closed


def test_a_link_is_closed_only_when_all_that_was_on_its_way_has_come() -> None:
    line = Line(LinkSettings(delay_s=0.2))
    line.far.send(b"last words")
    assert line.near.receive() == []
    line.far.close()
    closed = [line.near.is_closed]
    line.now_s = 0.3
    assert line.near.receive() == [b"last words"]
    assert [*closed, line.near.is_closed] == [False, True]


@pytest.mark.parametrize(
    ("setting", "named"),
    [
        ("link.loss=1.5", "link.loss"),
        ("link.outages=[[5, 4]]", "outages"),
        ("link.los=0.1", "no such setting"),
    ],
)
def test_a_link_that_cannot_be_is_refused_by_key(setting: str, named: str) -> None:
    with pytest.raises(ConfigError) as refused:
        load_scenario("open", [setting])
    assert named in str(refused.value)
