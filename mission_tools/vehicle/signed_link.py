"""MAVSDK over a signed link: it hands us its frames as bytes, and we move, sign and check them."""

import asyncio
import time
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from pathlib import Path

from mavsdk.asyncio import Mavsdk

from companion.core.errors import LinkError
from companion.links.interfaces import Link, Port
from companion.links.port_url import open_port
from companion.links.readable import readable
from companion.links.serial_port import LineFormat, SerialPort
from companion.mavlink.finder import FrameFinder
from companion.mavlink.framing import begins_with_frame
from companion.mavlink.signing import Signatory, SigningGuard, Stamps, timestamp_at, without_signature
from companion.mavlink.signing_key import SigningKey, read_key_file
from mission_tools.errors import NoVehicle, UsageError
from mission_tools.vehicle.link_url import LinkUrl

RAW = "raw://"
_FLOW_CONTROL = "serial_flowcontrol://"
_LINK_ID = 1
_POLL_S = 0.05  # between looks for new connections


def read_sign_key(path: Path) -> SigningKey:
    """The key of `--sign-key`. Raises UsageError: no file, readable by others, or no key; says what to do."""
    try:
        return read_key_file(path)
    except ValueError as error:
        raise UsageError(str(error)) from None


class SignedStream:
    """One link to one vehicle. is_datagram: each chunk that comes in stands for itself."""

    def __init__(self, key: SigningKey, is_datagram: bool) -> None:
        self._stamps = Stamps()
        self._guard = SigningGuard(Signatory(key, self._stamps), "required", _LINK_ID)
        self._incoming, self._outgoing = FrameFinder(is_datagram), FrameFinder(datagram=True)

    def set_date(self, timestamp: int) -> None:
        """What time it is, as `companion.mavlink.signing.timestamp_at` has it."""
        self._stamps.clock = timestamp

    def sign(self, data: bytes) -> list[bytes]:
        """Whole frames, one behind the other, each signed. What is none is left out."""
        sealed = [self._guard.seal(frame.data) for frame in self._outgoing.feed(data)]
        return [frame for frame in sealed if frame is not None]

    def open(self, data: bytes) -> list[bytes]:
        """The frames that these bytes complete and whose signatures hold, without them. Never raises."""
        found = self._incoming.feed(data)
        return [without_signature(frame.data) for frame in found if self._guard.admits(frame.data)]

    def warning(self) -> str:
        """Why nothing came in, if something was said; empty otherwise."""
        counters = self._guard.counters
        if counters.verified:
            return ""
        if counters.forged:
            return "what it says is signed with another key"
        if counters.old:
            return "what it says is out of date: are both clocks right?"
        if counters.unsigned:
            return "what it says is not signed: give the boat the same key, or leave --sign-key out"
        return ""


class SignedWire:
    """A port as one way to one vehicle: of several callers, to the last one; by datagrams, to the last whose
    signature holds.

    hear: gets the vehicle's frames, without their signatures. date: in Unix seconds.
    """

    def __init__(
        self, port: Port, stream: SignedStream, hear: Callable[[bytes], object], date: Callable[[], float]
    ) -> None:
        self._port, self._stream, self._hear, self._date = port, stream, hear, date
        self._links: list[Link] = []  # the last is spoken to

    def send(self, data: bytes) -> None:
        """Send frames; they are lost without a peer."""
        self._stream.set_date(timestamp_at(self._date()))
        for frame in self._stream.sign(data):
            if self._links:
                self._links[-1].send(frame)

    def poll(self) -> None:
        """Take what has come in."""
        self._stream.set_date(timestamp_at(self._date()))
        for link in self._port.accept():
            if link.is_datagram:
                self._links.insert(0, link)
            else:
                for older in self._links:
                    older.close()
                self._links.append(link)
        self._links = [link for link in self._links if not link.is_closed]
        for link in self._links.copy():
            frames = [frame for chunk in link.receive() for frame in self._stream.open(chunk)]
            for frame in frames:
                self._hear(frame)
            if frames:
                self._links.remove(link)
                self._links.append(link)

    async def run(self) -> None:
        """Take what comes in, until cancelled."""
        while True:
            self.poll()
            await readable({self._port.fileno(), *(link.fileno() for link in self._links)} - {-1}, _POLL_S)


def _open(url: str) -> Port:
    """The port of a url as MAVSDK writes it."""
    if url.startswith(_FLOW_CONTROL):
        device, _, baud = url.removeprefix(_FLOW_CONTROL).rpartition(":")
        return SerialPort(device, int(baud), time.monotonic, line=LineFormat(has_flow_control=True))
    return open_port(url, time.monotonic, is_call=begins_with_frame)


@asynccontextmanager
async def signed_link(
    mavsdk: Mavsdk, link: LinkUrl, key: SigningKey, date: Callable[[], float] = time.time
) -> AsyncIterator[SignedStream]:
    """Open the link and let MAVSDK speak over it, for as long as the context lasts. date: in Unix seconds.
    Raises NoVehicle: the link cannot be opened.
    """
    raw = mavsdk._mavsdk  # the asyncio wrapper leaves the raw connection's two functions out
    loop = asyncio.get_running_loop()

    def on_send(data: bytes) -> None:  # on a thread of MAVSDK's
        if not loop.is_closed():
            loop.call_soon_threadsafe(wire.send, data)

    stream = SignedStream(key, is_datagram=link.mavsdk.startswith("udp"))
    try:
        port = _open(link.mavsdk)
    except LinkError as error:
        raise NoVehicle(f"{link.typed}: cannot be opened ({error}): {link.advice}") from None
    wire = SignedWire(port, stream, raw.pass_received_raw_bytes, date)
    try:
        await mavsdk.add_any_connection(RAW)
        handle = raw.subscribe_raw_bytes_to_be_sent(on_send)
        running = asyncio.create_task(wire.run())
        try:
            yield stream
        finally:
            raw.unsubscribe_raw_bytes_to_be_sent(handle)
            running.cancel()
            await asyncio.gather(running, return_exceptions=True)
    finally:
        port.close()
