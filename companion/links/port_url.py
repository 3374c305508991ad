"""Port urls, in the forms used by ground stations, and their ports.

    udpout:HOST:PORT        send to one station; also its broadcast address
    udpin:HOST:PORT         wait for stations (also udp:HOST:PORT)
    tcpin:HOST:PORT         serve stations
    tcpout:HOST:PORT        connect to a server (also tcp:HOST:PORT)
    serial:DEVICE:BAUD      a radio or UART (also DEVICE,BAUD or DEVICE:BAUD)

`kind://…` is accepted as well, an IPv6 host is in brackets, and the host of a waiting port may be empty.
"""

from collections.abc import Callable
from dataclasses import dataclass

from companion.core.errors import ConfigError
from companion.links.interfaces import Port
from companion.links.internet import show
from companion.links.serial_port import LINE_8N1, LineFormat, SerialPort
from companion.links.tcp import TcpInPort, TcpOutPort
from companion.links.udp import UdpInPort, UdpOutPort

DEFAULT_BAUD = 57600
_KINDS = {
    "udpin": "udpin",
    "udp": "udpin",
    "udpout": "udpout",
    "udpbcast": "udpout",
    "tcpin": "tcpin",
    "tcpout": "tcpout",
    "tcp": "tcpout",
}
_FORMS = "udpin:HOST:PORT, udpout:HOST:PORT, tcpin:HOST:PORT, tcpout:HOST:PORT or serial:DEVICE:BAUD"


@dataclass(frozen=True, slots=True)
class PortUrl:
    """A parsed port url. `place`: host or device, `number`: port or baud rate."""

    kind: str
    place: str
    number: int

    def __str__(self) -> str:
        """As the ports name themselves."""
        return f"{self.kind}:{show(self.place, self.number)}"


def parse_port_url(url: str) -> PortUrl:
    """Parse a url. Raises ConfigError: names the url and the expected form."""
    text = url.strip()
    if text.startswith("/"):
        return _serial(url, text)
    kind, colon, rest = text.partition(":")
    if not colon:
        raise ConfigError(f"port {url!r}: expected {_FORMS}")
    kind = kind.lower()
    rest = rest.removeprefix("//") if kind != "serial" or rest.startswith("///") else rest
    if kind == "serial":
        return _serial(url, rest)
    if kind not in _KINDS:
        raise ConfigError(f"port {url!r}: unknown kind {kind!r}; expected {_FORMS}")
    return _internet(url, _KINDS[kind], rest)


def open_port(
    url: str,
    now: Callable[[], float],
    queue_bytes: int | None = None,
    is_call: Callable[[bytes], bool] = bool,
    line: LineFormat = LINE_8N1,
) -> Port:
    """Open the port of a url. `now` is the boat's clock, in seconds.

    queue_bytes: output queue of a stream; None: the driver's default. is_call: whether a datagram from a new
    address creates a link; default: any non-empty one. line: of a serial device.
    Raises ConfigError: the url is invalid; LinkError: the port cannot be opened.
    """
    parsed = parse_port_url(url)
    queue = {} if queue_bytes is None else {"queue_bytes": queue_bytes}
    if parsed.kind == "serial":
        return SerialPort(parsed.place, parsed.number, now, **queue, line=line)
    if parsed.kind == "udpin":
        return UdpInPort(parsed.place, parsed.number, now, is_call=is_call)
    if parsed.kind == "udpout":
        return UdpOutPort(parsed.place, parsed.number)
    if parsed.kind == "tcpin":
        return TcpInPort(parsed.place, parsed.number, **queue)
    return TcpOutPort(parsed.place, parsed.number, now, **queue)


def open_line(place: str, baud: float, now: Callable[[], float], line: LineFormat = LINE_8N1) -> Port:
    """Open a part's serial device at a baud rate, or any other port url.
    Raises ConfigError: the url is invalid; LinkError: the port cannot be opened.
    """
    return open_port(line_url(place, baud), now, line=line)


def line_url(place: str, baud: float = DEFAULT_BAUD) -> str:
    """The port url of a part: a device has the part's baud rate, and may have colons in its name."""
    return f"{place},{int(baud)}" if place.startswith("/") and "," not in place else place


def _internet(url: str, kind: str, rest: str) -> PortUrl:
    host, colon, number = rest.rpartition(":")
    form = f"{kind}:HOST:PORT"
    if not colon:
        raise ConfigError(f"port {url!r}: expected {form}, such as {kind}:127.0.0.1:14550")
    if host.startswith("[") and host.endswith("]"):
        host = host[1:-1]
    elif ":" in host:
        raise ConfigError(f"port {url!r}: expected {form}; an IPv6 host stands in brackets")
    if not host and kind.endswith("out"):
        raise ConfigError(f"port {url!r}: expected {form}; the host is missing")
    lowest = 1 if kind.endswith("out") else 0
    if not (_is_number(number) and lowest <= int(number) <= 65535):
        raise ConfigError(f"port {url!r}: {number!r} is not a port number, {lowest} to 65535")
    return PortUrl(kind, host or "0.0.0.0", int(number))  # noqa: S104


def _serial(url: str, rest: str) -> PortUrl:
    separator = "," if "," in rest else ":"
    device, colon, baud = rest.partition(separator)
    baud = baud if colon else str(DEFAULT_BAUD)
    if not device:
        raise ConfigError(f"port {url!r}: expected serial:DEVICE:BAUD, such as serial:/dev/ttyUSB0:57600")
    if not (_is_number(baud) and int(baud) > 0):
        raise ConfigError(f"port {url!r}: {baud!r} is not a baud rate, such as {DEFAULT_BAUD}")
    return PortUrl("serial", device, int(baud))


def _is_number(text: str) -> bool:
    return text.isascii() and text.isdigit() and len(text) <= 9
