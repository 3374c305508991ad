"""MAVLink over UDP: to one fixed station, or to whichever stations call."""

import contextlib
import errno
import socket
from collections import deque
from collections.abc import Callable

from companion.core.errors import LinkError
from companion.hal.interfaces import Link
from companion.links.internet import SocketAddress, resolve, show

PEER_IDLE_S = 60.0
MAX_PEERS = 256  # a bound on memory; which links stay is decided by `router/admission.py`
_DATAGRAM_BYTES = 65535
_DATAGRAM_OVERHEAD_BYTES = 64  # of memory: a queue of empty datagrams would be as long as one likes
_DATAGRAMS_PER_CALL = 32  # so that a flooding station cannot hold the boat's tick
_DATAGRAMS_PER_ROUND = 256  # of one socket, while each of its links is asked once
_QUEUE_BYTES = 128 * 1024  # of one peer; when it is full the oldest datagrams go
_SOURCE_OFFSET = 10_000  # from destination port to source port: beyond what stations listen on, 14550 …
_SOURCE_PORTS = 256  # tried from there on: as many as there are MAVLink systems
_PORTS = 65_536
_SYSTEM_QUEUE_BYTES = 4 << 20  # asked for; a bridge between fast links must get over a pause of its computer


class UdpOutPort:
    """`udpout:HOST:PORT`: one link to one destination, from one source port for life.

    The socket is never connected: the boat may start before its network does, and a station that is not
    there yet must not turn into an error. Only datagrams of that host and port are taken, unless the
    destination is a broadcast address.

    Raises:
        LinkError: the host is not known.
    """

    def __init__(self, host: str, port: int) -> None:
        address = resolve("udpout", host, port)
        self._name = f"udpout:{show(host, port)}"
        self._link = _UdpOutLink(self._name, address)
        self._fresh: list[Link] = [self._link]

    @property
    def name(self) -> str:
        """The url."""
        return self._name

    @property
    def source_port(self) -> int:
        """Where answers arrive."""
        return self._link.source_port

    def accept(self) -> list[Link]:
        """The link, once."""
        fresh, self._fresh = self._fresh, []
        return fresh

    def fileno(self) -> int:
        """−1: no second link will come."""
        return -1

    def close(self) -> None:
        """Close the link. May be called twice."""
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
        self.strangers = 0  # datagrams from somebody else

    @property
    def source_port(self) -> int:
        return int(self._socket.getsockname()[1])

    def receive(self) -> list[bytes]:
        chunks: list[bytes] = []
        for _ in range(_DATAGRAMS_PER_CALL):
            try:
                data, source = self._socket.recvfrom(_DATAGRAM_BYTES)
            except (BlockingIOError, InterruptedError):
                break
            except OSError:
                if self.is_closed:
                    break
                continue  # a reported ICMP refusal; the next datagram may be good
            if not (self._takes_any_source or source[:2] == self._destination[:2]):
                self.strangers += 1
            elif data:
                chunks.append(data)
        return chunks

    def send(self, data: bytes) -> bool:
        try:
            self._socket.sendto(data, self._destination)
        except OSError as error:
            # The kernel knows which addresses are broadcast: it refuses the first datagram to one.
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


def _bind_source(udp: socket.socket, destination_port: int) -> None:
    """Take the same source port at every start, where it is free.

    A station remembers where frames came from and goes on answering there: after a restart from another port
    it would send everything twice. Boats of one computer that call the same station get successive ports.
    """
    first = destination_port + _SOURCE_OFFSET
    first -= 0 if first + _SOURCE_PORTS <= _PORTS else 2 * _SOURCE_OFFSET
    for port in range(first, first + _SOURCE_PORTS):
        with contextlib.suppress(OSError):
            udp.bind(("", port))
            return
    udp.bind(("", 0))


class UdpInPort:
    """`udpin:HOST:PORT`: every address that calls here becomes a link.

    is_call: whether the first datagram of an address calls for a link; others are dropped and leave no trace.
    A peer that is silent for idle_s is forgotten; beyond max_peers at a time, newcomers are not heard.
    Port 0 lets the system choose; `name` shows the choice.

    Raises:
        LinkError: the address is in use or not ours.
    """

    def __init__(
        self,
        host: str,
        port: int,
        now: Callable[[], float],
        idle_s: float = PEER_IDLE_S,
        max_peers: int = MAX_PEERS,
        is_call: Callable[[bytes], bool] = bool,
    ) -> None:
        address = resolve("udpin", host, port)
        self._socket = socket.socket(address.family, socket.SOCK_DGRAM)
        self._socket.setblocking(False)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _SYSTEM_QUEUE_BYTES)
        try:
            self._socket.bind(address.sockaddr)
        except OSError as error:
            self._socket.close()
            where = show(host, port)
            raise LinkError(f"udpin:{where}: cannot listen on {where}: {error.strerror}") from None
        self._name = f"udpin:{show(host, self._socket.getsockname()[1])}"
        self._now = now
        self._idle_s = idle_s
        self._max_peers = max_peers
        self._is_call = is_call
        self._peers: dict[object, _UdpPeer] = {}
        self._fresh: list[Link] = []
        self.refused_datagrams = 0

    @property
    def name(self) -> str:
        """The url with the real port."""
        return self._name

    def accept(self) -> list[Link]:
        """Links to the peers that have called for the first time; idle ones are closed."""
        self._pump()
        oldest_s = self._now() - self._idle_s
        for peer in [peer for peer in self._peers.values() if peer.heard_s < oldest_s]:
            peer.close()
        fresh, self._fresh = self._fresh, []
        return fresh

    def fileno(self) -> int:
        """The socket that all peers share, −1 once closed."""
        return self._socket.fileno()

    def close(self) -> None:
        """Close the socket and every link. May be called twice."""
        for peer in list(self._peers.values()):
            peer.close()
        self._socket.close()

    def _pump(self) -> None:
        """Sort what has arrived by sender. The links take turns at it, so that a round has a bound."""
        for _ in range(max(_DATAGRAMS_PER_ROUND // (len(self._peers) + 1), 1)):
            try:
                data, source = self._socket.recvfrom(_DATAGRAM_BYTES)
            except (BlockingIOError, InterruptedError):
                return
            except OSError:
                if self._socket.fileno() < 0:
                    return
                continue
            peer = self._peers.get(source)
            if peer is None:
                if not self._is_call(data) or len(self._peers) >= self._max_peers:
                    self.refused_datagrams += 1
                    continue
                peer = _UdpPeer(self, source)
                self._peers[source] = peer
                self._fresh.append(peer)
            peer.heard_s = self._now()
            if data:
                peer.keep(data)

    def _send(self, data: bytes, destination: tuple[str, int]) -> bool:
        try:
            self._socket.sendto(data, destination)
        except OSError:
            return False
        return True

    def _forget(self, source: object) -> None:
        self._peers.pop(source, None)


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
        return not self.is_closed and self._port._send(data, self._source)

    def fileno(self) -> int:
        return -1 if self.is_closed else self._port.fileno()

    def close(self) -> None:
        if not self.is_closed:
            self.is_closed = True
            self._port._forget(self._source)
