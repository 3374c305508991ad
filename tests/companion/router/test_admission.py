"""Which links stay when a thousand come: nobody who proves himself is locked out."""

import logging
from dataclasses import dataclass

import pytest
from boat_rig import QGC, Rig
from guarded_rig import KEY, GuardedRig

from companion.links.memory import MemoryPort, memory_pair
from companion.mavlink.address import Address
from companion.mavlink.dialect import dialect
from companion.router.admission import PLACES, SILENT_S, Standing, excess_links
from companion.router.channels import Channels


@dataclass
class Caller:
    """A link by what counts."""

    host: str = "203.0.113.1"
    standing: Standing = Standing.STRANGER
    heard_s: float = 0.0


def strangers(count: int, host: str = "203.0.113.1") -> list[Caller]:
    return [Caller(host) for _ in range(count)]


def proven(count: int, heard_s: float = 0.0, host: str = "203.0.113.1") -> list[Caller]:
    return [Caller(host, Standing.PROVEN, heard_s) for _ in range(count)]


def test_whoever_has_proved_himself_stays_before_a_thousand_who_have_not() -> None:
    assert excess_links([*strangers(PLACES), *proven(PLACES)], 0.0) == []
    friend = Caller("198.51.100.1", Standing.PROVEN)
    links = [friend, *strangers(1000)]
    gone = excess_links(links, 1000.0)
    assert len(gone) == 1000 - PLACES
    assert friend not in gone
    assert all(a is b for a, b in zip(gone, links[1:], strict=False))


def test_speech_counts_more_than_silence_even_from_an_address_that_may_be_forged() -> None:
    speaking = Caller("198.51.100.1", Standing.SPEAKING)
    assert speaking not in excess_links([speaking, *strangers(1000)], 0.0)
    talkers = [Caller(f"203.0.113.{n}", Standing.SPEAKING) for n in range(PLACES)]
    newcomer, quiet = Caller("198.51.100.1"), Caller("198.51.100.2")
    assert excess_links([*talkers, newcomer], 0.0) == [talkers[0]], "a newcomer is let in"
    assert excess_links([*talkers[1:], quiet, newcomer], 0.0) == [quiet]


def test_a_host_with_many_links_loses_one_of_its_own() -> None:
    assert (PLACES, SILENT_S) == (32, 10.0)
    quiet = Caller("198.51.100.1")
    links = [quiet, *strangers(PLACES)]
    assert excess_links(links, 0.0) == [links[1]]


def test_one_who_fell_silent_makes_way_for_one_more_who_has_proved_himself() -> None:
    links = [*proven(PLACES, heard_s=100.0), Caller("198.51.100.1", Standing.PROVEN, 100.0)]
    links[7].heard_s = 100.0 - SILENT_S
    now_s = 100.0 + 0.1
    assert excess_links(links, now_s) == [links[7]]


def test_those_who_talk_stay_and_the_newest_of_the_host_that_has_most_goes() -> None:
    newcomer = Caller("198.51.100.1", Standing.PROVEN, 100.0)
    links = [*proven(PLACES, heard_s=100.0), newcomer]
    assert excess_links(links, 100.0 + SILENT_S) == [links[PLACES - 1]]


def test_what_a_station_has_said_decides_its_standing() -> None:
    rig = Rig()
    (channel,) = rig.boat.channels.open.values()
    standings = [channel.standing]
    rig.ask(dialect.MAV_CMD_REQUEST_MESSAGE, 148)
    standings.append(channel.standing)
    rig.peer.heartbeat()
    rig.receive()
    standings.append(channel.standing)
    assert standings == [Standing.STRANGER, Standing.SPEAKING, Standing.PROVEN]


def test_on_a_signed_link_only_a_signature_takes_a_place_from_others() -> None:
    rig = GuardedRig("required")
    friend = rig.station(KEY)
    friend.heartbeat()
    rig.run(0.5)
    for number in range(50):
        stranger = rig.station(None, Address(number + 1, 190))
        stranger.heartbeat()
        rig.run(0.12)
    late = rig.station(KEY, Address(254, 190))
    late.heartbeat()
    rig.run(1.0)
    for number in range(40):
        rig.station(None, Address(number + 1, 190)).heartbeat()
        rig.run(0.12)
    for station in (friend, late):
        station.forget()
        rig.run(1.5)
        assert station.said("ATTITUDE")


def test_a_thousand_links_that_come_and_go_do_not_fill_the_log(caplog: pytest.LogCaptureFixture) -> None:
    port = MemoryPort()
    channels = Channels([port], QGC)
    with caplog.at_level(logging.INFO):
        for tick in range(1000):
            port.offer(memory_pair(f"caller {tick}")[0])
            channels.accept()
            list(channels.receive(0.02 * tick))
            channels.drop_closed()
        assert 40 <= len(caplog.messages) <= 40 + 20 + 1
        caplog.clear()
        list(channels.receive(60.0))
        port.offer(memory_pair("one more")[0])
        channels.accept()
        list(channels.receive(60.1))
        channels.drop_closed()
    assert "lines about other links were left out" in caplog.messages[0]
    assert not any("left out" in line for line in caplog.messages[1:])
