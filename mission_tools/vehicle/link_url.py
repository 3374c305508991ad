"""Connection strings: the forms that people know from MAVProxy, pymavlink and MAVSDK, told to MAVSDK."""

import re
from dataclasses import dataclass

from mission_tools.errors import UsageError

DEFAULT_LINK = "tcp:127.0.0.1:5760"
DEFAULT_BAUD = 57600
DEFAULT_SYSTEM_ID = 246  # 245 is what MAVSDK's own ground stations take

FORMS = (
    "tcp:HOST:PORT, tcpin:HOST:PORT, udp:HOST:PORT or udpin:HOST:PORT (listen), udpout:HOST:PORT, "
    "HOST:PORT (listen on UDP), /dev/ttyUSB0 or /dev/ttyUSB0,57600, serial:///dev/ttyUSB0:57600"
)

_SCHEMES = {
    "tcp": "tcpout",
    "tcpout": "tcpout",
    "tcpin": "tcpin",
    "udp": "udpin",  # as MAVProxy's --master: listen
    "udpin": "udpin",
    "udpout": "udpout",
}
_DEFAULT_PORT = {"tcpout": 5760, "tcpin": 5760, "udpin": 14550, "udpout": 14550}
_SERIAL_PATH = re.compile(r"(?P<path>/dev/[^\s,:]+|COM\d+)(?:[,:](?P<baud>[^,:]*))?", re.ASCII)
_NETWORK = re.compile(r"(?P<host>\[[0-9A-Fa-f:.]+\]|[A-Za-z0-9._-]*)(?::(?P<port>\d{0,5}))?", re.ASCII)


@dataclass(frozen=True, slots=True)
class LinkUrl:
    """A link as it was typed and as MAVSDK wants it."""

    typed: str
    mavsdk: str

    @property
    def advice(self) -> str:
        """What to try when no vehicle answers."""
        scheme = self.mavsdk.partition("://")[0]
        return {
            "tcpout": "is the boat (or `boat-sitl serve`) running, and is this its address?",
            "tcpin": "is the boat set to connect to this port?",
            "udpin": "does the boat send to this port, and does no other program hold it?",
            "udpout": "is the boat listening on this port?",
        }.get(scheme, "is the radio plugged in, is the baud rate right, may this user open the port?")


def parse_link(text: str) -> LinkUrl:
    """Understand what a person typed after --connect. Raises UsageError: names what was typed, says what is
    wrong with it and lists the forms.
    """
    typed = text.strip()
    scheme, separator, rest = _split(typed)
    if scheme in {"serial", "serial_flowcontrol"}:
        return LinkUrl(typed, f"{scheme}://{_serial(typed, rest)}")
    if _SERIAL_PATH.fullmatch(typed) or typed.startswith("/"):
        return LinkUrl(typed, f"serial://{_serial(typed, typed)}")
    if scheme in _SCHEMES:
        kind = _SCHEMES[scheme]
        return LinkUrl(typed, f"{kind}://{_network(typed, kind, rest)}")
    if separator == "://":
        raise _refusal(typed, f"'{scheme}' is not a kind of link")
    if not separator:
        raise _refusal(typed, "it names no port" if typed else "it is empty")
    return LinkUrl(typed, f"udpin://{_network(typed, 'udpin', typed)}")


def _split(typed: str) -> tuple[str, str, str]:
    separator = "://" if "://" in typed else ":"
    scheme, found, rest = typed.partition(separator)
    return scheme.lower(), found, rest


def _network(typed: str, kind: str, rest: str) -> str:
    match = _NETWORK.fullmatch(rest.rstrip("/"))
    if match is None:
        raise _refusal(typed, f"'{rest}' is not HOST:PORT")
    host, port_text = match["host"], match["port"]
    if host.isdecimal() and port_text is None:  # `udpin:14550`
        host, port_text = "", host
    if not host and kind in {"tcpout", "udpout"}:
        raise _refusal(typed, "a link that calls out needs a host")
    port = int(port_text[:6]) if port_text else _DEFAULT_PORT[kind]
    if not 1 <= port <= 65535:
        raise _refusal(typed, f"port {port} is outside 1..65535")
    return f"{host or '0.0.0.0'}:{port}"  # noqa: S104 - an empty host means every interface, as in MAVSDK


def _serial(typed: str, rest: str) -> str:
    match = _SERIAL_PATH.fullmatch(rest)
    if match is None:
        raise _refusal(typed, "it is not the path of a serial port")
    baud_text = match["baud"]
    if baud_text is None:
        return f"{match['path']}:{DEFAULT_BAUD}"
    if not re.fullmatch(r"[0-9]{1,8}", baud_text) or int(baud_text) == 0:
        raise _refusal(typed, f"baud rate '{baud_text}' is not a positive whole number")
    return f"{match['path']}:{int(baud_text)}"


def _refusal(typed: str, reason: str) -> UsageError:
    return UsageError(f"--connect '{typed}': {reason}. Forms: {FORMS}")
