"""Connection strings as people type them."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission_tools.errors import UsageError
from mission_tools.vehicle.link_url import DEFAULT_LINK, parse_link


@pytest.mark.parametrize(
    ("typed", "mavsdk"),
    [
        (DEFAULT_LINK, "tcpout://127.0.0.1:5760"),
        ("tcp://10.0.0.2:5760", "tcpout://10.0.0.2:5760"),
        ("tcpout://10.0.0.2:5760", "tcpout://10.0.0.2:5760"),
        ("tcp:boat", "tcpout://boat:5760"),
        ("tcpin::5761", "tcpin://0.0.0.0:5761"),
        ("udp:127.0.0.1:14550", "udpin://127.0.0.1:14550"),
        ("udp://:14540", "udpin://0.0.0.0:14540"),
        ("udpin:65535", "udpin://0.0.0.0:65535"),
        ("udp:10.0.0.2", "udpin://10.0.0.2:14550"),
        ("udpout:boat", "udpout://boat:14550"),
        ("tcpin:10.0.0.2", "tcpin://10.0.0.2:5760"),
        ("udpin:0.0.0.0:14550/", "udpin://0.0.0.0:14550"),
        ("UDPOUT://192.168.1.9:14550", "udpout://192.168.1.9:14550"),
        (":14550", "udpin://0.0.0.0:14550"),
        ("tcp:[::1]:5760", "tcpout://[::1]:5760"),
        ("/dev/ttyUSB0", "serial:///dev/ttyUSB0:57600"),
        ("/dev/ttyUSB0,115200", "serial:///dev/ttyUSB0:115200"),
        ("/dev/serial/by-id/usb-Radio_1-if00", "serial:///dev/serial/by-id/usb-Radio_1-if00:57600"),
        ("serial:///dev/ttyAMA0:921600", "serial:///dev/ttyAMA0:921600"),
        ("serial:/dev/ttyACM0:57600", "serial:///dev/ttyACM0:57600"),
        ("COM7", "serial://COM7:57600"),
        (" tcp:127.0.0.1:5760 ", "tcpout://127.0.0.1:5760"),
    ],
)
def test_every_form_that_people_know_is_understood(typed: str, mavsdk: str) -> None:
    assert parse_link(typed).mavsdk == mavsdk


@pytest.mark.parametrize(
    ("typed", "said"),
    [
        ("", "it is empty"),
        ("localhost", "it names no port"),
        ("foo://1.2.3.4:5", "'foo' is not a kind of link"),
        ("tcp::5760", "needs a host"),
        ("udpout:14550", "needs a host"),
        ("tcp:host:65536", "port 65536 is outside"),
        ("tcp:host:0", "port 0 is outside"),
        ("tcp:host:port", "'host:port' is not HOST:PORT"),
        ("tcp:ho st:1", "is not HOST:PORT"),
        ("/dev/ttyUSB0,fast", "baud rate 'fast'"),
        ("/dev/ttyUSB0,0", "baud rate '0'"),
        ("/home/boat", "not the path of a serial port"),
        ("serial://ttyUSB0:57600", "not the path of a serial port"),
    ],
)
def test_what_is_not_understood_is_repeated_with_the_reason_and_the_forms(typed: str, said: str) -> None:
    with pytest.raises(UsageError, match=said) as raised:
        parse_link(typed)
    assert f"'{typed}'" in str(raised.value)
    assert "/dev/ttyUSB0,57600" in str(raised.value)


@given(st.text(max_size=30) | st.from_regex(r"(tcp|udpin|serial):(//)?[^\n]{0,20}", fullmatch=True))
def test_any_text_is_a_link_or_a_usage_error(text: str) -> None:
    try:
        link = parse_link(text)
    except UsageError:
        return
    kinds = {"tcpout", "tcpin", "udpin", "udpout", "serial", "serial_flowcontrol"}
    assert link.mavsdk.partition("://")[0] in kinds
    assert parse_link(link.mavsdk).mavsdk == link.mavsdk


@pytest.mark.parametrize("typed", ["tcp:a:1", "tcpin:a:1", ":1", "udpout:a:1", "/dev/ttyUSB0"])
def test_every_kind_of_link_has_advice_of_its_own(typed: str) -> None:
    others = {parse_link(other).advice for other in ("tcp:a:1", "tcpin:a:1", ":1", "udpout:a:1", "/dev/x")}
    assert len(others) == 5
    assert parse_link(typed).advice in others
