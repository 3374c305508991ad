"""MAVSDK over a signed link: it hands us its frames as bytes, and we move, sign and check them."""

import asyncio
import time
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from pathlib import Path

from mavsdk.asyncio import Mavsdk

from companion.mavlink.signing import timestamp_at
from companion.mavlink.signing_key import SigningKey, read_key_file
from mission_tools.errors import NoVehicle, UsageError
from mission_tools.vehicle.byte_link import open_byte_link
from mission_tools.vehicle.link_url import LinkUrl
from mission_tools.vehicle.signed_stream import SignedStream

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
