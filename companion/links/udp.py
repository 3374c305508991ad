"""UDP links: to one fixed station, or to all stations that call."""

import contextlib
import errno
import socket
from collections import deque
from collections.abc import Callable, Iterator

from companion.links.interfaces import Link
from companion.links.internet import SocketAddress, listen, resolve, show

PEER_IDLE_S = 60.0
MAX_PEERS = 256  # limit of memory; `router/admission.py` selects the links that stay
_DATAGRAM_BYTES = 65535
_DATAGRAM_OVERHEAD_BYTES = 64  # memory per datagram, against empty ones
_DATAGRAMS_PER_CALL = 32  # limit against flooding stations
_DATAGRAMS_PER_ROUND = 256  # per socket, while each link is read once
_QUEUE_BYTES = 128 * 1024  # per peer; the oldest datagrams are dropped
_SOURCE_OFFSET = 10_000  # from destination to source port: beyond the ports of stations, 14550 …
_SOURCE_PORTS = 256  # tried from there: as many as MAVLink systems
_PORTS = 65_536
_SYSTEM_QUEUE_BYTES = 4 << 20  # requested; covers pauses of the computer on fast links


class UdpOutPort:
    """`udpout:HOST:PORT`: one link to one destination, from a constant source port.

    The socket is not connected: the boat may start before the network, and a missing station must not be an
    error. Only datagrams of that host and port are accepted, unless the destination is a broadcast address.
    Raises LinkError: the host is unknown.
    """

    def __init__(self, host: str, port: int) -> None:
        address = resolve("udpout", host, port)
        self.name = f"udpout:{show(host, port)}"
        self._link = _UdpOutLink(self.name, address)
        self._fresh: list[Link] = [self._link]

    def accept(self) -> list[Link]:
        fresh, self._fresh = self._fresh, []
        return fresh

    def fileno(self) -> int:
        """−1: there is only one link."""
        return -1

    def close(self) -> None:
        self._link.close()


class _UdpOutLink:
    is_datagram = True

    def __init__(self, name: str, address: SocketAddress) -> None:
        self.name = name
        self.host = address.sockaddr[0]
        self._socket = socket.socket(address.family, socket.SOCK_DGRAM)
        self._socket.setblocking(False)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _SYSTEM_QUEUE_BYTES)
        _bind_source(self._socket, address.sockaddr[1])
        self._destination = address.sockaddr
        self._takes_any_source = False
        self.is_closed = False

    def receive(self) -> list[bytes]:
        return [
            data
            for data, source in _received(self._socket, _DATAGRAMS_PER_CALL)
            if data and (self._takes_any_source or source[:2] == self._destination[:2])
        ]

    def send(self, data: bytes) -> bool:
        try:
            self._socket.sendto(data, self._destination)
        except OSError as error:
            # The kernel refuses the first datagram to a broadcast address.
            if error.errno == errno.EACCES and not self._takes_any_source and not self.is_closed:
                self._takes_any_source = True
                self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)
                return self.send(data)
            return False
        return True

    def fileno(self) -> int:
        return self._socket.fileno()

    def close(self) -> None:
        self.is_closed = True
        self._socket.close()


def _received(udp: socket.socket, most: int) -> Iterator[tuple[bytes, tuple[str, int]]]:
    """Waiting datagrams with their sources, at most so many."""
    for _ in range(most):
        try:
            received = udp.recvfrom(_DATAGRAM_BYTES)
        except (BlockingIOError, InterruptedError):
            return
        except OSError:  # closed, or a reported ICMP error
            if udp.fileno() < 0:
                return
        else:
            yield received


def _bind_source(udp: socket.socket, destination_port: int) -> None:
    """Bind the same source port at every start, if it is free.

    A station remembers the source of frames; after a restart from another port it would send everything
    twice. Boats on one computer that call the same station get consecutive ports.
    """
    first = destination_port + _SOURCE_OFFSET
    first -= 0 if first + _SOURCE_PORTS <= _PORTS else 2 * _SOURCE_OFFSET
    for port in range(first, first + _SOURCE_PORTS):
        with contextlib.suppress(OSError):
            udp.bind(("", port))
            return
    udp.bind(("", 0))


class UdpInPort:
    """`udpin:HOST:PORT`: every address that calls becomes a link.

    is_call: whether the first datagram of an address creates a link; others are dropped. A peer that is
    silent for PEER_IDLE_S is removed; beyond max_peers, new ones are ignored. With port 0 the system chooses;
    `name` shows the choice. Raises LinkError: the address is in use or not ours.
    """

    def __init__(
        self,
        host: str,
        port: int,
        now: Callable[[], float],
        max_peers: int = MAX_PEERS,
        is_call: Callable[[bytes], bool] = bool,
    ) -> None:
        self._socket, self.name = listen(
            "udpin", host, port, socket.SOCK_DGRAM, socket.SO_RCVBUF, _SYSTEM_QUEUE_BYTES
        )
        self._now = now
        self._max_peers = max_peers
        self._is_call = is_call
        self._peers: dict[object, _UdpPeer] = {}
        self._fresh: list[Link] = []

    def accept(self) -> list[Link]:
        """Links to new peers; idle ones are closed."""
        self._pump()
        oldest_s = self._now() - PEER_IDLE_S
        for peer in [peer for peer in self._peers.values() if peer.heard_s < oldest_s]:
            peer.close()
        fresh, self._fresh = self._fresh, []
        return fresh

    def fileno(self) -> int:
        """The shared socket, −1 once closed."""
        return self._socket.fileno()

    def close(self) -> None:
        for peer in list(self._peers.values()):
            peer.close()
        self._socket.close()

    def _pump(self) -> None:
        """Sort received datagrams by sender, with a limit per round."""
        most = max(_DATAGRAMS_PER_ROUND // (len(self._peers) + 1), 1)
        for data, source in _received(self._socket, most):
            peer = self._peers.get(source)
            if peer is None:
                if not self._is_call(data) or len(self._peers) >= self._max_peers:
                    continue
                peer = _UdpPeer(self, source)
                self._peers[source] = peer
                self._fresh.append(peer)
            peer.heard_s = self._now()
            if data:
                peer.keep(data)


class _UdpPeer:
    is_datagram = True

    def __init__(self, port: UdpInPort, source: tuple[str, int]) -> None:
        self.name = f"udp:{show(source[0], source[1])}"
        self.host = source[0]
        self._port = port
        self._source = source
        self._arrived: deque[bytes] = deque()
        self._arrived_bytes = 0
        self.heard_s = 0.0
        self.is_closed = False

    def keep(self, data: bytes) -> None:
        self._arrived.append(data)
        self._arrived_bytes += len(data) + _DATAGRAM_OVERHEAD_BYTES
        while self._arrived_bytes > _QUEUE_BYTES:
            self._arrived_bytes -= len(self._arrived.popleft()) + _DATAGRAM_OVERHEAD_BYTES

    def receive(self) -> list[bytes]:
        if not self.is_closed:
            self._port._pump()
        chunks = list(self._arrived)
        self._arrived.clear()
        self._arrived_bytes = 0
        return chunks

    def send(self, data: bytes) -> bool:
        if self.is_closed:
            return False
        try:
            self._port._socket.sendto(data, self._source)
        except OSError:
            return False
        return True

    def fileno(self) -> int:
        return -1 if self.is_closed else self._port.fileno()

    def close(self) -> None:
        if not self.is_closed:
            self.is_closed = True
            self._port._peers.pop(self._source, None)
