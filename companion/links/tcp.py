"""TCP links: a server for stations, and a reconnecting client."""

import select
import socket
from collections.abc import Callable

from companion.links.interfaces import Link
from companion.links.internet import listen, resolve, show
from companion.links.retried import Backoff
from companion.links.stream import StreamLink

MAX_CLIENTS = 128  # limit of descriptors; `router/admission.py` selects the links that stay
_QUEUE_BYTES = 256 * 1024
_CONNECT_TIMEOUT_S = 5.0
_ACCEPTS_PER_CALL = 16


class TcpInPort:
    """`tcpin:HOST:PORT`: listens; every client is a link.

    With port 0 the system chooses; `name` shows the choice. Clients beyond max_clients are rejected.
    Raises LinkError: the address is in use or not ours.
    """

    def __init__(
        self, host: str, port: int, max_clients: int = MAX_CLIENTS, queue_bytes: int = _QUEUE_BYTES
    ) -> None:
        # Reuse the port after a restart, despite connections in TIME_WAIT.
        self._socket, self.name = listen("tcpin", host, port, socket.SOCK_STREAM, socket.SO_REUSEADDR, 1)
        self._max_clients = max_clients
        self._queue_bytes = queue_bytes
        self._links: list[StreamLink] = []

    def accept(self) -> list[Link]:
        """Links to the clients connected since the last call."""
        fresh: list[Link] = []
        for _ in range(_ACCEPTS_PER_CALL):
            try:
                connection, _ = self._socket.accept()
            except OSError:  # none waiting, gone again, or out of descriptors
                break
            self._links = [link for link in self._links if not link.is_closed]
            link = _link_over(connection, self._queue_bytes)
            if link is None or len(self._links) >= self._max_clients:
                connection.close()
                continue
            self._links.append(link)
            fresh.append(link)
        return fresh

    def fileno(self) -> int:
        """The listening socket, −1 once closed."""
        return self._socket.fileno()

    def close(self) -> None:
        self._socket.close()
        for link in self._links:
            link.close()


class TcpOutPort:
    """`tcpout:HOST:PORT`: connects, and reconnects with growing delays.

    Every connection is a new link. `accept` makes the attempts, without blocking.
    Raises LinkError: the host is unknown.
    """

    def __init__(
        self, host: str, port: int, now: Callable[[], float], queue_bytes: int = _QUEUE_BYTES
    ) -> None:
        self._address = resolve("tcpout", host, port)
        self.name = f"tcpout:{show(host, port)}"
        self._now = now
        self._queue_bytes = queue_bytes
        self._backoff = Backoff()
        self._dialling: socket.socket | None = None
        self._give_up_s = 0.0
        self._link: StreamLink | None = None
        self._is_closed = False

    def accept(self) -> list[Link]:
        """A new link for each connection."""
        now_s = self._now()
        if self._link is not None:
            if not self._link.is_closed:
                return []
            self._link = None
            self._backoff.failed(now_s)
        if self._is_closed:
            return []
        if self._dialling is None:
            if self._backoff.is_due(now_s):
                self._dial(now_s)
            if self._dialling is None:
                return []
        self._link = self._finish_dialling(self._dialling, now_s)
        return [] if self._link is None else [self._link]

    def fileno(self) -> int:
        """−1: `accept` polls the connection."""
        return -1

    def close(self) -> None:
        self._is_closed = True
        if self._dialling is not None:
            self._dialling.close()
            self._dialling = None
        if self._link is not None:
            self._link.close()

    def _dial(self, now_s: float) -> None:
        connection = socket.socket(self._address.family, socket.SOCK_STREAM)
        connection.setblocking(False)
        self._give_up_s = now_s + _CONNECT_TIMEOUT_S
        self._dialling = connection
        connection.connect_ex(self._address.sockaddr)  # errors are reported by SO_ERROR

    def _finish_dialling(self, connection: socket.socket, now_s: float) -> StreamLink | None:
        poll = select.poll()
        poll.register(connection, select.POLLOUT)
        if not poll.poll(0):
            if now_s < self._give_up_s:
                return None
        elif connection.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR) == 0:
            link = _link_over(connection, self._queue_bytes)
            if link is not None:
                self._dialling = None
                self._backoff.succeeded()
                return link
        connection.close()
        self._dialling = None
        self._backoff.failed(now_s)
        return None


def _link_over(connection: socket.socket, queue_bytes: int) -> StreamLink | None:
    """A link over a connected socket; None if the far side is already gone."""
    try:
        peer = connection.getpeername()
        if peer == connection.getsockname():
            return None  # a connection to a free local port may connect to itself
        connection.setblocking(False)
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        # A lost station is detected within half a minute.
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_KEEPIDLE, 10)
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_KEEPINTVL, 5)
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_KEEPCNT, 4)
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT, 30_000)
    except OSError:
        return None
    name = f"tcp:{show(peer[0], peer[1])}"
    return StreamLink(name, connection.fileno(), connection.close, queue_bytes, peer[0])
