"""Internet addresses for the UDP and TCP links."""

import socket
from typing import NamedTuple

from companion.core.errors import LinkError


class SocketAddress(NamedTuple):
    """A resolved address: IPv4 (host, port) or IPv6 with flow and scope."""

    family: int
    sockaddr: tuple[str, int] | tuple[str, int, int, int]


def resolve(kind: str, host: str, port: int) -> SocketAddress:
    """Resolve a host, IPv4 preferred. An empty host means all local addresses.

    Raises:
        LinkError: names kind, host and port.
    """
    try:
        found = socket.getaddrinfo(host or "0.0.0.0", port, type=socket.SOCK_STREAM)  # noqa: S104
    except (OSError, UnicodeError) as error:
        reason = getattr(error, "strerror", None) or error
        raise LinkError(f"{kind}:{show(host, port)}: host {host!r} is not known: {reason}") from None
    found.sort(key=lambda entry: entry[0] != socket.AF_INET)
    family, _, _, _, sockaddr = found[0]
    return SocketAddress(family, sockaddr)  # type: ignore[arg-type]


def show(host: str, port: int) -> str:
    """Host and port as text."""
    return f"[{host}]:{port}" if ":" in host else f"{host}:{port}"
