"""Internet addresses for the UDP and TCP links."""

import socket
from typing import NamedTuple

from companion.core.errors import LinkError


class SocketAddress(NamedTuple):
    """An address that the system understands: IPv4 (host, port) or IPv6 with flow and scope."""

    family: int
    sockaddr: tuple[str, int] | tuple[str, int, int, int]


def resolve(kind: str, host: str, port: int) -> SocketAddress:
    """Look a host up, IPv4 first. An empty host means every local address.

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
    """Host and port as people write them."""
    return f"[{host}]:{port}" if ":" in host else f"{host}:{port}"
