"""Internet addresses for the UDP and TCP links."""

import socket
from typing import NamedTuple

from companion.core.errors import LinkError

_BACKLOG = 128  # stations are not rejected because of simultaneous strangers


class SocketAddress(NamedTuple):
    """A resolved address: IPv4 (host, port) or IPv6 with flow and scope."""

    family: int
    sockaddr: tuple[str, int] | tuple[str, int, int, int]


def resolve(kind: str, host: str, port: int) -> SocketAddress:
    """Resolve a host, IPv4 preferred. An empty host means all local addresses.
    Raises LinkError: names kind, host and port.
    """
    try:
        found = socket.getaddrinfo(host or "0.0.0.0", port, type=socket.SOCK_STREAM)  # noqa: S104
    except (OSError, UnicodeError) as error:
        reason = getattr(error, "strerror", None) or error
        raise LinkError(f"{kind}:{show(host, port)}: host {host!r} is not known: {reason}") from None
    found.sort(key=lambda entry: entry[0] != socket.AF_INET)
    family, _, _, _, sockaddr = found[0]
    return SocketAddress(family, sockaddr)  # type: ignore[arg-type]


def listen(
    kind: str, host: str, port: int, socket_kind: socket.SocketKind, option: int, value: int
) -> tuple[socket.socket, str]:
    """A bound socket that does not block, and its url with the port, which the system chooses for port 0.

    option: of SOL_SOCKET, set to value.
    Raises LinkError: the host is unknown, or the address is in use or not ours.
    """
    address = resolve(kind, host, port)
    bound = socket.socket(address.family, socket_kind)
    bound.setblocking(False)
    bound.setsockopt(socket.SOL_SOCKET, option, value)
    try:
        bound.bind(address.sockaddr)
        if socket_kind is socket.SOCK_STREAM:
            bound.listen(_BACKLOG)
    except OSError as error:
        bound.close()
        where = show(host, port)
        raise LinkError(f"{kind}:{where}: cannot listen on {where}: {error.strerror}") from None
    return bound, f"{kind}:{show(host, bound.getsockname()[1])}"


def show(host: str, port: int) -> str:
    """Host and port as text."""
    return f"[{host}]:{port}" if ":" in host else f"{host}:{port}"
