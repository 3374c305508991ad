"""MAVSDK over a signed link: it hands us its frames as bytes, and we move, sign and check them."""

import asyncio
import time
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from pathlib import Path

from mavsdk.asyncio import Mavsdk

from companion.mavlink.signing import (
    Signatory,
    SignatureVerdict,
    SigningGuard,
    Stamps,
    timestamp_at,
    without_signature,
)
from companion.mavlink.signing_key import SigningKey, read_key_file
from mission_tools.errors import NoVehicle, UsageError
from mission_tools.vehicle.byte_link import open_byte_link
from mission_tools.vehicle.link_url import LinkUrl

RAW = "raw://"


def read_sign_key(path: Path) -> SigningKey:
    """The key that `--sign-key` names.

    Raises:
        UsageError: no such file, one that others may read, or no key in it; says what to do.
    """
    try:
        return read_key_file(path)
    except ValueError as error:
        raise UsageError(str(error)) from None


_MAGIC_V1, _MAGIC_V2, _SIGNED = 0xFE, 0xFD, 0x01
_OVERHEAD, _BLOCK = 12, 13
_LINK_ID = 1


class SignedStream:
    """One link to one vehicle.

    is_datagram: each chunk that comes in stands for itself; otherwise they are pieces of one stream, of which
    at most one unfinished frame is kept.
    """

    def __init__(self, key: SigningKey, is_datagram: bool) -> None:
        self.verified = 0
        self.unsigned = 0
        self.forged = 0
        self.old = 0
        self._is_datagram = is_datagram
        self._signatory = Signatory(key, Stamps())
        self._guard = SigningGuard(self._signatory, "required", _LINK_ID)
        self._rest = b""

    def set_date(self, timestamp: int) -> None:
        """What time it is, as `companion.mavlink.signing.timestamp_at` has it."""
        self._signatory.stamps.clock = timestamp

    def sign(self, frames: bytes) -> list[bytes]:
        """Whole MAVLink 2 frames, one behind the other, each signed. What is none is left out."""
        sealed: list[bytes] = []
        at = 0
        while at + _OVERHEAD <= len(frames) and frames[at] == _MAGIC_V2:
            end = at + _length(frames, at)
            if end <= len(frames) and (frame := self._guard.seal(frames[at:end])) is not None:
                sealed.append(frame)
            at = end
        return sealed

    def open(self, data: bytes) -> list[bytes]:
        """The frames that these bytes complete and whose signatures hold, without them. Never raises."""
        data, at = self._rest + data, 0
        opened: list[bytes] = []
        while (at := data.find(_MAGIC_V2, at)) >= 0:
            if at + 3 > len(data) or (end := at + _length(data, at)) > len(data):
                if not self._is_datagram:
                    self._rest = data[at:]
                    return opened
                at += 1
                continue
            frame = data[at:end]
            verdict = self._signatory.check(frame)
            if verdict is SignatureVerdict.GOOD:
                self.verified += 1
                opened.append(without_signature(frame))
            elif verdict is SignatureVerdict.OLD:
                self.old += 1
            else:
                if end == len(data) or data[end] in (_MAGIC_V1, _MAGIC_V2):
                    self.unsigned += verdict is SignatureVerdict.UNSIGNED
                    self.forged += verdict is SignatureVerdict.FORGED
                end = at + 1  # what only looks like a frame may hide one
            at = end
        self._rest = b""
        return opened

    def warning(self) -> str:
        """Why nothing came in, if something was said; empty otherwise."""
        if self.verified:
            return ""
        if self.forged:
            return "what it says is signed with another key"
        if self.old:
            return "what it says is out of date: are both clocks right?"
        if self.unsigned:
            return "what it says is not signed: give the boat the same key, or leave --sign-key out"
        return ""


def _length(data: bytes, at: int) -> int:
    """How long the frame at a magic byte says it is."""
    return _OVERHEAD + data[at + 1] + (_BLOCK if data[at + 2] & _SIGNED else 0)


@asynccontextmanager
async def signed_link(
    mavsdk: Mavsdk, link: LinkUrl, key: SigningKey, date: Callable[[], float] = time.time
) -> AsyncIterator[SignedStream]:
    """Open the link and let MAVSDK speak over it, for as long as the context lasts. date: in Unix seconds.

    Raises:
        NoVehicle: the link cannot be opened.
    """
    raw = mavsdk._mavsdk  # the asyncio wrapper leaves the raw connection's two functions out
    loop = asyncio.get_running_loop()

    def on_bytes(data: bytes) -> bool:
        stream.set_date(timestamp_at(date()))
        frames = stream.open(data)
        for frame in frames:
            raw.pass_received_raw_bytes(frame)
        return bool(frames)

    def send(data: bytes) -> None:
        stream.set_date(timestamp_at(date()))
        for frame in stream.sign(data):
            wire.send(frame)

    def on_send(data: bytes) -> None:  # on a thread of MAVSDK's
        if not loop.is_closed():
            loop.call_soon_threadsafe(send, data)

    stream = SignedStream(key, is_datagram=link.mavsdk.startswith("udp"))
    try:
        wire = await open_byte_link(link.mavsdk, on_bytes)
    except OSError as error:
        reason = error.strerror or str(error)
        raise NoVehicle(f"{link.typed}: cannot be opened ({reason}): {link.advice}") from None
    try:
        await mavsdk.add_any_connection(RAW)
        handle = raw.subscribe_raw_bytes_to_be_sent(on_send)
        try:
            yield stream
        finally:
            raw.unsubscribe_raw_bytes_to_be_sent(handle)
    finally:
        wire.close()
