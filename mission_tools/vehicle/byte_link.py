"""Bytes to and from a vehicle over TCP, UDP or a serial line, on asyncio: for links that we sign."""

import asyncio
import contextlib
import os
from collections.abc import Callable
from typing import Protocol, cast

import serial

OnBytes = Callable[[bytes], bool]
"""Receives data; returns whether its sender is accepted as peer."""

_CHUNK_BYTES = 65536


class ByteLink(Protocol):
    """One way to one vehicle. What arrives goes to the function that it was opened with."""

    is_datagram: bool

    def send(self, data: bytes) -> None:
        """Send one frame; it is lost without a peer."""

    def close(self) -> None:
        """Close. May be called twice."""


async def open_byte_link(url: str, on_bytes: OnBytes) -> ByteLink:
    """Open a link by its url as MAVSDK writes it, such as `tcpout://127.0.0.1:5760`.

    Raises:
        OSError: the system refuses.
    """
    kind, _, place = url.partition("://")
    host, _, number = place.rpartition(":")
    if kind.startswith("serial"):
        return SerialLine(host, int(number), on_bytes, has_flow_control=kind == "serial_flowcontrol")
    host = host.strip("[]")
    loop = asyncio.get_running_loop()
    if kind == "tcpout":
        _, stream = await loop.create_connection(lambda: TcpLink(on_bytes), host, int(number))
        return stream
    if kind == "tcpin":
        waiting = TcpLink(on_bytes)
        waiting.server = await loop.create_server(lambda: waiting, host, int(number))
        return waiting
    udp = UdpLink(on_bytes)
    if kind == "udpin":
        await loop.create_datagram_endpoint(lambda: udp, local_addr=(host, int(number)))
    else:
        await loop.create_datagram_endpoint(lambda: udp, remote_addr=(host, int(number)))
    return udp


class TcpLink(asyncio.Protocol):
    """A connection, called or taken. Of those who call, the last one counts."""

    is_datagram = False

    def __init__(self, on_bytes: OnBytes) -> None:
        self.server: asyncio.Server | None = None
        self._on_bytes = on_bytes
        self._transport: asyncio.Transport | None = None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Replace the peer: the last caller counts."""
        if self._transport is not None:
            self._transport.abort()
        self._transport = cast(asyncio.Transport, transport)

    def data_received(self, data: bytes) -> None:
        """Hand the bytes to the receiver."""
        self._on_bytes(data)

    def send(self, data: bytes) -> None:
        """Send one frame to the peer, if there is one."""
        if self._transport is not None and not self._transport.is_closing():
            self._transport.write(data)

    def close(self) -> None:
        """Close the connection and stop listening."""
        if self._transport is not None:
            self._transport.close()
        if self.server is not None:
            self.server.close()


class UdpLink(asyncio.DatagramProtocol):
    """A UDP socket that sends to the last accepted peer, or to a known address."""

    is_datagram = True

    def __init__(self, on_bytes: OnBytes) -> None:
        self._on_bytes = on_bytes
        self._transport: asyncio.DatagramTransport | None = None
        self._peer: tuple[str, int] | None = None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """The socket is open."""
        self._transport = cast(asyncio.DatagramTransport, transport)
        self._peer = transport.get_extra_info("peername")

    def datagram_received(self, data: bytes, addr: tuple[str, int]) -> None:
        """Hand the bytes to the receiver; the sender becomes the peer if it accepts them."""
        if self._on_bytes(data):
            self._peer = addr

    def error_received(self, exc: Exception) -> None:
        """Nobody there yet; what was sent is lost, as on any link."""

    def send(self, data: bytes) -> None:
        if self._transport is not None and self._peer is not None and not self._transport.is_closing():
            connected = self._transport.get_extra_info("peername")
            self._transport.sendto(data, None if connected else self._peer)

    def close(self) -> None:
        if self._transport is not None:
            self._transport.close()


class SerialLine:
    """A radio or a cable. What it is too slow to take waits in the system's buffer, then is lost."""

    is_datagram = False

    def __init__(self, device: str, baud: int, on_bytes: OnBytes, *, has_flow_control: bool) -> None:
        self._on_bytes = on_bytes
        self._line = serial.Serial(device, baud, timeout=0, write_timeout=0, rtscts=has_flow_control)
        self._loop = asyncio.get_running_loop()
        self._descriptor: int = self._line.fileno()
        os.set_blocking(self._descriptor, False)
        self._loop.add_reader(self._descriptor, self._read)

    def _read(self) -> None:
        try:
            data = os.read(self._descriptor, _CHUNK_BYTES)
        except (BlockingIOError, InterruptedError):
            return
        except OSError:  # unplugged
            self.close()
            return
        if data:
            self._on_bytes(data)

    def send(self, data: bytes) -> None:
        with contextlib.suppress(OSError):
            if self._line.is_open:
                os.write(self._descriptor, data)

    def close(self) -> None:
        if self._line.is_open:
            self._loop.remove_reader(self._descriptor)
            self._line.close()
