"""A boat that calls a station does so from the same UDP port after each restart."""

import socket
from collections.abc import Iterator

import pytest

from companion.links.udp import UdpOutPort


@pytest.fixture
def station() -> Iterator[socket.socket]:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as listener:
        listener.bind(("127.0.0.1", 0))
        listener.settimeout(10.0)
        yield listener


def call(station: socket.socket) -> UdpOutPort:
    port = UdpOutPort("127.0.0.1", station.getsockname()[1])
    (link,) = port.accept()
    assert link.send(b"hello")
    return port


def source(station: socket.socket) -> int:
    return int(station.recvfrom(100)[1][1])


def test_boats_side_by_side_have_ports_of_their_own_and_find_them_again(station: socket.socket) -> None:
    rounds = []
    for _ in range(2):
        boats = [call(station) for _ in range(5)]
        rounds.append([source(station) for _ in boats])
        for boat in boats:
            boat.close()
    assert rounds[0] == rounds[1]
    assert len(set(rounds[0])) == 5


def test_a_port_that_somebody_else_has_is_left_out(station: socket.socket) -> None:
    port = call(station)
    usual = source(station)
    port.close()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        other.bind(("", usual))
        port = call(station)
        assert source(station) not in (usual, other.getsockname()[1])
        port.close()


@pytest.mark.parametrize("destination", [1, 55_280, 55_281, 65_535])
def test_any_destination_has_a_source_port(destination: int) -> None:
    port = UdpOutPort("127.0.0.1", destination)
    source_port = port._link._socket.getsockname()[1]
    assert 1024 < source_port <= 65_535
    assert (source_port > destination) is (destination <= 55_280)
    port.close()


def test_beyond_the_usual_ports_a_boat_calls_from_any(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("companion.links.udp._SOURCE_PORTS", 1)
    boats = [UdpOutPort("127.0.0.1", 14550) for _ in range(2)]
    first, other = (boat._link._socket.getsockname()[1] for boat in boats)
    assert other != first
    assert other > 1024
    for boat in boats:
        boat.close()
