"""Port urls in all their spellings."""

import socket

import pytest
from hypothesis import given
from hypothesis import strategies as st
from twins.lines import HandClock

from companion.core.errors import ConfigError, LinkError
from companion.links.internet import resolve
from companion.links.port_url import PortUrl, open_line, open_port, parse_port_url

ANYWHERE = "0.0.0.0"  # noqa: S104


@pytest.mark.parametrize(
    ("url", "expected"),
    [
        ("udpout:192.168.1.5:14550", PortUrl("udpout", "192.168.1.5", 14550)),
        ("udp:127.0.0.1:14550", PortUrl("udpin", "127.0.0.1", 14550)),
        ("udp://:14540", PortUrl("udpin", ANYWHERE, 14540)),
        ("udpbcast:192.168.1.255:14550", PortUrl("udpout", "192.168.1.255", 14550)),
        ("tcpin::0", PortUrl("tcpin", ANYWHERE, 0)),
        ("tcpout://boat.local:5760", PortUrl("tcpout", "boat.local", 5760)),
        ("TCP:127.0.0.1:5760", PortUrl("tcpout", "127.0.0.1", 5760)),
        ("tcpout:[::1]:5760", PortUrl("tcpout", "::1", 5760)),
        ("serial:/dev/ttyUSB0:57600", PortUrl("serial", "/dev/ttyUSB0", 57600)),
        ("serial:///dev/ttyUSB0:115200", PortUrl("serial", "/dev/ttyUSB0", 115200)),
        ("/dev/ttyAMA0,9600", PortUrl("serial", "/dev/ttyAMA0", 9600)),
        ("/dev/serial/by-path/pci-0:1,9600", PortUrl("serial", "/dev/serial/by-path/pci-0:1", 9600)),
        ("/dev/ttyUSB0", PortUrl("serial", "/dev/ttyUSB0", 57600)),
    ],
)
def test_every_spelling_is_understood(url: str, expected: PortUrl) -> None:
    assert parse_port_url(url) == expected


@pytest.mark.parametrize(
    ("url", "reason"),
    [
        ("", "expected udpin:HOST:PORT"),
        ("ftp:host:21", "unknown kind 'ftp'"),
        ("udpin:14550x", "expected udpin:HOST:PORT, such as"),
        ("udpin:host:0x10", "'0x10' is not a port number"),
        ("tcpin:host:65536", "'65536' is not a port number, 0 to 65535"),
        ("tcpout:host:0", "'0' is not a port number, 1 to 65535"),
        ("tcpout:host:²", "is not a port number"),
        ("tcpout::5760", "the host is missing"),
        ("tcpout:::1:5760", "an IPv6 host stands in brackets"),
        ("serial:", "expected serial:DEVICE:BAUD"),
        ("serial:/dev/ttyUSB0:fast", "'fast' is not a baud rate"),
        ("/dev/ttyUSB0,0", "'0' is not a baud rate"),
    ],
)
def test_what_cannot_be_read_is_named_with_what_is_expected(url: str, reason: str) -> None:
    with pytest.raises(ConfigError) as caught:
        parse_port_url(url)
    assert repr(url) in str(caught.value)
    assert reason in str(caught.value)


@given(st.builds("{}{}".format, st.sampled_from(["", "udp:", "tcp:", "serial:", "tcpout:"]), st.text()))
def test_any_text_is_read_or_refused_with_one_line(url: str) -> None:
    try:
        parsed = parse_port_url(url)
    except ConfigError as error:
        message = str(error)
        assert message.startswith(f"port {url!r}: ")
    else:
        assert parsed.kind in {"udpin", "udpout", "tcpin", "tcpout", "serial"}
        assert parsed.place


@pytest.mark.parametrize("url", ["tcpin:127.0.0.1:0", "udpin:127.0.0.1:0", "tcpin:[::1]:0"])
def test_a_waiting_port_shows_its_real_number_and_its_name_opens_it_again(url: str) -> None:
    port = open_port(url, HandClock())
    kind, place, number = (parsed := parse_port_url(port.name)).kind, parsed.place, parsed.number
    assert number > 0
    assert (kind, place) == (parse_port_url(url).kind, parse_port_url(url).place)
    with pytest.raises(LinkError, match="Address already in use"):
        open_port(port.name, HandClock())
    port.close()
    again = open_port(port.name, HandClock())
    assert again.name == port.name
    again.close()


def test_a_host_of_both_families_is_called_by_ipv4(monkeypatch: pytest.MonkeyPatch) -> None:
    both = [
        (socket.AF_INET6, socket.SOCK_STREAM, 6, "", ("::1", 5760, 0, 0)),
        (socket.AF_INET, socket.SOCK_STREAM, 6, "", ("127.0.0.1", 5760)),
    ]
    monkeypatch.setattr(socket, "getaddrinfo", lambda *_, **__: both)
    assert resolve("tcpout", "both", 5760) == (socket.AF_INET, ("127.0.0.1", 5760))


def test_a_parts_device_is_opened_at_its_baud_rate_unless_it_states_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    urls: list[str] = []
    monkeypatch.setattr("companion.links.port_url.open_port", lambda url, *_, **__: urls.append(url))
    for place in ("/dev/ttyAMA0", "/dev/ttyAMA0,4800", "tcp:boat.local:2947"):
        open_line(place, 9600.0, HandClock())
    assert urls == ["/dev/ttyAMA0,9600", "/dev/ttyAMA0,4800", "tcp:boat.local:2947"]


@pytest.mark.parametrize("url", ["udpout:127.0.0.1:14550", "tcpout:127.0.0.1:5760"])
def test_the_kinds_that_call_out_keep_their_url_as_name(url: str) -> None:
    port = open_port(url, HandClock())
    assert port.name == url
    port.close()
