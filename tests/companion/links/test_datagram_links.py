"""UDP ports over loopback, with sockets as stations."""

import socket
from collections.abc import Iterator

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from patience import MOMENT_S
from twins.lines import HandClock, eventually, gather

from companion.core.errors import LinkError
from companion.links.interfaces import Link
from companion.links.port_url import open_port
from companion.links.udp import UdpInPort, UdpOutPort
from companion.mavlink.address import Address
from companion.mavlink.codec import Encoder
from companion.mavlink.dialect import dialect
from companion.mavlink.framing import begins_with_frame

HERE = "127.0.0.1"


@pytest.fixture
def server(clock: HandClock) -> Iterator[UdpInPort]:
    port = UdpInPort(HERE, 0, clock)
    yield port
    port.close()


class Station:
    """A ground station's socket."""

    def __init__(self, number: int = 0) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind((HERE, number))
        self._socket.settimeout(MOMENT_S)
        self.number: int = self._socket.getsockname()[1]

    def __enter__(self) -> "Station":
        return self

    def __exit__(self, *_: object) -> None:
        self._socket.close()

    def say(self, data: bytes, number: int) -> None:
        self._socket.sendto(data, (HERE, number))

    def hear(self) -> tuple[bytes, int]:
        data, source = self._socket.recvfrom(65535)
        return data, source[1]


def number_of(port: UdpInPort) -> int:
    return int(port.name.rpartition(":")[2])


def source_port_of(port: UdpOutPort) -> int:
    return int(port._link._socket.getsockname()[1])


def call_in(port: UdpInPort, station: Station, data: bytes = b"hello") -> Link:
    station.say(data, number_of(port))
    (link,) = port.accept()
    return link


def test_every_peer_becomes_a_link_of_its_own(server: UdpInPort) -> None:
    with Station() as near, Station() as far:
        near_link, far_link = call_in(server, near, b"near"), call_in(server, far, b"far")
        assert near_link.receive() == [b"near"]
        assert far_link.receive() == [b"far"]
        assert near_link.is_datagram
        assert near_link.name == f"udp:127.0.0.1:{near.number}"
        assert far_link.send(b"to far")
        assert near_link.send(b"to near")
        assert not near_link.send(bytes(70_000)), "longer than a datagram may be"
        assert near.hear() == (b"to near", number_of(server))
        assert far.hear() == (b"to far", number_of(server))
        assert server.accept() == []


def test_an_idle_peer_is_forgotten_and_may_call_again(server: UdpInPort, clock: HandClock) -> None:
    with Station() as station:
        link = call_in(server, station)
        clock.advance(59.0)
        station.say(b"still here", number_of(server))
        server.accept()
        clock.advance(59.0)
        server.accept()
        assert link.send(b"noted")
        clock.advance(2.0)
        server.accept()
        assert link.is_closed
        assert not link.send(b"anyone?")
        assert link.fileno() == -1
        assert call_in(server, station) is not link


def test_beyond_the_limit_newcomers_are_not_heard(clock: HandClock) -> None:
    port = UdpInPort(HERE, 0, clock, max_peers=2)
    with Station() as first, Station() as second, Station() as third:
        call_in(port, first)
        link = call_in(port, second)
        third.say(b"me too", number_of(port))
        assert port.accept() == []
        link.close()
        call_in(port, third)
    port.close()


def test_who_does_not_begin_with_a_frame_becomes_no_link_and_leaves_no_trace(clock: HandClock) -> None:
    port = open_port(f"udpin:{HERE}:0", clock, is_call=begins_with_frame)
    assert isinstance(port, UdpInPort)
    frame = Encoder(Address(255, 190)).encode(dialect.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3))
    with Station() as station, Station() as stranger:
        for garbage in (b"\0", b"hello", b"\xfd" * 1400, frame[:-1], b"x" + frame, bytes(2000), b""):
            stranger.say(garbage, number_of(port))
        station.say(frame, number_of(port))
        (link,) = port.accept()
        assert link.name == f"udp:127.0.0.1:{station.number}"
        assert link.host == HERE
        assert link.receive() == [frame]
        stranger.say(frame, number_of(port))
        assert len(port.accept()) == 1
    port.close()


def test_what_a_flooding_peer_has_waiting_is_bounded_and_the_newest_is_kept(server: UdpInPort) -> None:
    with Station() as station:
        link = call_in(server, station, b"first")
        for number in range(40):
            station.say(bytes(8000) + bytes((number,)), number_of(server))
            server.accept()
        chunks = link.receive()
        assert sum(map(len, chunks)) <= 128 * 1024
        assert [chunk[-1] for chunk in chunks] == list(range(40 - len(chunks), 40))
        for _ in range(1500):
            station.say(b"", number_of(server))
            station.say(b"x", number_of(server))
            server.accept()
        assert len(link.receive()) <= 128 * 1024 // 64
        station.say(b"later", number_of(server))
        assert link.receive() == [b"later"]


def test_one_round_over_all_links_takes_a_bounded_number_of_datagrams(server: UdpInPort) -> None:
    with Station() as flood:
        links = []
        for _ in range(20):
            with Station() as station:
                links.append(call_in(server, station))
        flooded = call_in(server, flood)
        for link in [*links, flooded]:
            link.receive()
        for _ in range(600):
            flood.say(b"x", number_of(server))
        for link in links:
            assert link.receive() == []
        assert 0 < len(flooded.receive()) <= 256


def test_the_same_port_can_be_taken_again_after_close(clock: HandClock) -> None:
    port = UdpInPort(HERE, 0, clock)
    with Station() as station:
        link = call_in(port, station)
    port.close()
    port.close()
    assert link.is_closed
    assert link.receive() == [b"hello"]
    assert port.accept() == []
    UdpInPort(HERE, number_of(port), clock).close()


def test_udpout_keeps_one_source_port_and_hears_only_its_station() -> None:
    with Station() as station, Station() as stranger:
        port = UdpOutPort(HERE, station.number)
        (link,) = port.accept()
        assert port.accept() == []
        assert (link.name, link.host) == (f"udpout:127.0.0.1:{station.number}", HERE)
        for data in (b"one", b"two"):
            assert link.send(data)
            assert station.hear() == (data, source_port_of(port))
        stranger.say(b"evil", source_port_of(port))
        station.say(b"good", source_port_of(port))
        assert link.receive() == [b"good"]
        port.close()
        port.close()
        assert link.is_closed
        assert not link.send(b"late")
        assert link.receive() == []


def test_a_station_that_is_not_there_is_no_error_and_is_heard_once_it_is() -> None:
    with Station() as station:
        number = station.number
    port = UdpOutPort(HERE, number)
    (link,) = port.accept()
    for _ in range(5):  # each of these is answered by an ICMP refusal
        assert link.send(b"anyone?")
        assert link.receive() == []
    with Station(number) as station:
        station.say(b"here I am", source_port_of(port))
        assert link.receive() == [b"here I am"]
        assert not link.is_closed
    port.close()


def test_a_broadcast_address_is_sent_to_and_answers_come_from_anyone() -> None:
    port = UdpOutPort("127.255.255.255", 9)
    (link,) = port.accept()
    assert link.send(b"anyone?")
    with Station() as station:
        station.say(b"I am", source_port_of(port))
        assert link.receive() == [b"I am"]
    port.close()


def test_a_host_that_nobody_knows_is_named() -> None:
    with pytest.raises(LinkError, match=r"udpout:no such host:14550: host 'no such host' is not known"):
        UdpOutPort("no such host", 14550)


@settings(max_examples=12)
@given(st.lists(st.binary(min_size=1, max_size=1400), min_size=1, max_size=20))
def test_any_bytes_come_through_as_they_were(datagrams: list[bytes]) -> None:
    server = UdpInPort(HERE, 0, HandClock())
    client = UdpOutPort(HERE, number_of(server))
    (out,) = client.accept()
    for datagram in datagrams:
        assert out.send(datagram)
    (link,) = server.accept()
    assert link.receive() == datagrams
    for datagram in datagrams:
        assert link.send(datagram)
    heard: list[bytes] = []
    eventually(lambda: len(gather(out.receive, heard)) >= len(datagrams))
    assert heard == datagrams
    client.close()
    server.close()


# A boat that calls a station does so from the same UDP port after each restart


def call(station: Station) -> tuple[UdpOutPort, int]:
    """A port that has sent, and the number that it sent from."""
    port = UdpOutPort(HERE, station.number)
    (link,) = port.accept()
    assert link.send(b"hello")
    return port, station.hear()[1]


def test_boats_side_by_side_have_ports_of_their_own_and_find_them_again() -> None:
    rounds = []
    with Station() as station:
        for _ in range(2):
            boats = [call(station) for _ in range(5)]
            rounds.append([source for _, source in boats])
            for port, _ in boats:
                port.close()
    assert rounds[0] == rounds[1]
    assert len(set(rounds[0])) == 5


def test_a_port_that_somebody_else_has_is_left_out() -> None:
    with Station() as station:
        port, usual = call(station)
        port.close()
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
            other.bind(("", usual))
            port, source = call(station)
            assert source not in (usual, other.getsockname()[1])
            port.close()


@pytest.mark.parametrize("destination", [1, 55_280, 55_281, 65_535])
def test_any_destination_has_a_source_port(destination: int) -> None:
    port = UdpOutPort(HERE, destination)
    assert 1024 < source_port_of(port) <= 65_535
    assert (source_port_of(port) > destination) is (destination <= 55_280)
    port.close()


def test_beyond_the_usual_ports_a_boat_calls_from_any(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("companion.links.udp._SOURCE_PORTS", 1)
    boats = [UdpOutPort(HERE, 14550) for _ in range(2)]
    first, other = map(source_port_of, boats)
    assert other != first
    assert other > 1024
    for boat in boats:
        boat.close()
