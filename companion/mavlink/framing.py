"""Parsing of one frame at one position: header, length and CRC, MAVLink 1 and 2.

    v1: FE len seq sys comp id8 payload crc16
    v2: FD len incompat compat seq sys comp id24 payload crc16 [signature, 13 bytes]

A frame is accepted by its CRC; until then its length is unverified. Headers are checked first, so that a
stray magic byte seldom delays the frames after it.
"""

from enum import Enum
from struct import Struct as Packing

from msgspec import Struct

from companion.mavlink.address import Address, address
from companion.mavlink.dialect import crc16
from companion.mavlink.layout import LAYOUTS, Layout

MAGIC_V1 = 0xFE
MAGIC_V2 = 0xFD
_MAGICS = (bytes((MAGIC_V1,)), bytes((MAGIC_V2,)))
SIGNED = 0x01
SIGNATURE_LENGTH = 13

_OVERHEAD_V1 = 8
_OVERHEAD_V2 = 12
_HEADER_V2 = Packing("<BBBBBBHB")  # all but the magic
_read_header_v2 = _HEADER_V2.unpack_from


class Frame(Struct, frozen=True, gc=False):
    """A frame with a valid CRC, or of an unknown message (layout None).

    data: the whole frame; payload may be shorter or longer than the layout.
    """

    message_id: int
    sender: Address
    sequence: int
    payload: bytes
    data: bytes
    layout: Layout | None


class Flaw(Enum):
    """Why there is no frame at a position."""

    INCOMPLETE = "more bytes are claimed than there are"
    HEADER = "the header cannot be one of ours"
    UNKNOWN = "a message that the dialect does not have"
    CRC = "the checksum does not fit"


def claimed_length(data: bytes, at: int) -> int:
    """Frame length by its header, 1 if that is incomplete."""
    if at + 3 > len(data):
        return 1
    if data[at] == MAGIC_V1:
        return _OVERHEAD_V1 + data[at + 1]
    return _OVERHEAD_V2 + data[at + 1] + (SIGNATURE_LENGTH if data[at + 2] & SIGNED else 0)


def read_frame(data: bytes, at: int) -> Frame | Flaw:
    """The frame with its magic byte at `at`, or its flaw. Never raises."""
    return _read_v2(data, at) if data[at] == MAGIC_V2 else _read_v1(data, at)


def begins_with_frame(data: bytes) -> bool:
    """Whether the bytes begin with a frame of the dialect."""
    return data[:1] in _MAGICS and isinstance(read_frame(data, 0), Frame)


def message_id_of(frame: bytes) -> int:
    """Message number of a valid frame."""
    return int.from_bytes(frame[7:10], "little") if frame[0] == MAGIC_V2 else frame[5]


def _read_v2(data: bytes, at: int) -> Frame | Flaw:
    available = len(data) - at
    if available < _OVERHEAD_V2:
        # unknown incompatibility flags: discard, as in the guide
        return Flaw.HEADER if available >= 3 and data[at + 2] & ~SIGNED else Flaw.INCOMPLETE
    length, incompat, _, sequence, system, component, id_low, id_high = _read_header_v2(data, at + 1)
    if incompat & ~SIGNED:
        return Flaw.HEADER
    message_id = id_low | id_high << 16
    layout = LAYOUTS.get(message_id)
    if layout is None:
        return Flaw.UNKNOWN
    crc_at = at + 10 + length
    end = crc_at + 2 + (SIGNATURE_LENGTH if incompat else 0)
    if end > len(data):
        return Flaw.INCOMPLETE
    if crc16(data[at + 1 : crc_at] + layout.crc_extra) != data[crc_at] | data[crc_at + 1] << 8:
        return Flaw.CRC
    return Frame(
        message_id, address(system, component), sequence, data[at + 10 : crc_at], data[at:end], layout
    )


def _read_v1(data: bytes, at: int) -> Frame | Flaw:
    available = len(data) - at
    if available < 6:
        return Flaw.INCOMPLETE
    _, length, sequence, system, component, message_id = data[at : at + 6]
    layout = LAYOUTS.get(message_id)
    if layout is None:
        return Flaw.UNKNOWN
    if length > layout.size:
        return Flaw.HEADER  # version 1 has no extensions
    crc_at = at + 6 + length
    if crc_at + 2 > len(data):
        return Flaw.INCOMPLETE
    if crc16(data[at + 1 : crc_at] + layout.crc_extra) != data[crc_at] | data[crc_at + 1] << 8:
        return Flaw.CRC
    return Frame(
        message_id, address(system, component), sequence, data[at + 6 : crc_at], data[at : crc_at + 2], layout
    )


def read_unknown(data: bytes, at: int) -> Frame | Flaw:
    """The frame of an unknown message with a complete header at `at`; only its length is checked.

    System 0 is not a valid sender.
    """
    begin = at + (10 if data[at] == MAGIC_V2 else 6)
    end = at + claimed_length(data, at)
    if data[at] == MAGIC_V2:
        _, _, _, sequence, system, component, id_low, id_high = _read_header_v2(data, at + 1)
        message_id = id_low | id_high << 16
    else:
        sequence, system, component, message_id = data[at + 2 : at + 6]
    if system == 0:
        return Flaw.UNKNOWN
    if end > len(data):
        return Flaw.INCOMPLETE
    payload = data[begin : begin + data[at + 1]]
    return Frame(message_id, address(system, component), sequence, payload, data[at:end], None)


def build_frame(address: Address, sequence: int, layout: Layout, payload: bytes) -> bytes:
    """A MAVLink 2 frame; trailing zeros of the payload are truncated."""
    payload = payload.rstrip(b"\0") or b"\0"
    id_low, id_high = layout.message_id & 0xFFFF, layout.message_id >> 16
    head = _HEADER_V2.pack(len(payload), 0, 0, sequence, *address, id_low, id_high)
    body = head + payload
    return b"\xfd" + body + crc16(body + layout.crc_extra).to_bytes(2, "little")
