"""Requests and replies in the payload of FILE_TRANSFER_PROTOCOL.

After the MAVLink guide, "File Transfer Protocol": twelve bytes of header, then up to 239 of data.
"""

import struct
from enum import IntEnum
from typing import NamedTuple

from companion.mavlink.dialect import dialect

DATA_BYTES = 239
SESSION_AT = 2  # offset of the session
# sequence, session, opcode, size, request's opcode, burst complete, padding, offset
_HEADER = struct.Struct("<HBBBBBBI")
_ACK: int = dialect.MAV_FTP_OPCODE_ACK
_NAK: int = dialect.MAV_FTP_OPCODE_NAK


class Opcode(IntEnum):
    """Requests."""

    NONE = 0
    TERMINATE_SESSION = 1
    RESET_SESSIONS = 2
    LIST_DIRECTORY = 3
    OPEN_FILE_RO = 4
    READ_FILE = 5
    CREATE_FILE = 6
    WRITE_FILE = 7
    REMOVE_FILE = 8
    CREATE_DIRECTORY = 9
    REMOVE_DIRECTORY = 10
    OPEN_FILE_WO = 11
    TRUNCATE_FILE = 12
    RENAME = 13
    CALC_FILE_CRC32 = 14
    BURST_READ_FILE = 15


class Code(IntEnum):
    """Reasons for a NAK."""

    FAIL = 1
    FAIL_ERRNO = 2
    INVALID_DATA_SIZE = 3
    INVALID_SESSION = 4
    NO_SESSIONS_AVAILABLE = 5
    END_OF_FILE = 6
    UNKNOWN_COMMAND = 7
    FILE_EXISTS = 8
    FILE_PROTECTED = 9
    FILE_NOT_FOUND = 10


class Refusal(Exception):  # noqa: N818
    """A request that is answered with a NAK. number: errno, if code is FAIL_ERRNO."""

    def __init__(self, code: Code, number: int = 0) -> None:
        super().__init__(code.name)
        self.code = code
        self.number = number


class Request(NamedTuple):
    """A request. raw: its bytes, to recognise repeats."""

    sequence: int
    session: int
    opcode: int
    size: int
    offset: int
    data: bytes
    raw: bytes


def parse_request(payload: bytes) -> Request | None:
    """Parse a payload. None for a reply, which is never answered, or a short payload."""
    if len(payload) < _HEADER.size:
        return None
    sequence, session, opcode, size, _, _, _, offset = _HEADER.unpack_from(payload)
    if opcode >= _ACK:
        return None
    end = _HEADER.size + min(size, DATA_BYTES)
    return Request(sequence, session, opcode, size, offset, payload[_HEADER.size : end], payload[:end])


class Reply(NamedTuple):
    """An answer to a request. code: of a NAK; 0 with an ACK."""

    sequence: int
    session: int
    opcode: int  # of the request
    code: int
    is_burst_over: bool
    offset: int
    data: bytes


def make_request(sequence: int, session: int, opcode: int, offset: int, size: int, data: bytes) -> bytes:
    """Payload of a request. size: bytes asked for, or the length of data."""
    header = _HEADER.pack(sequence & 0xFFFF, session, opcode, size, 0, 0, 0, offset)
    return header + data.ljust(DATA_BYTES, b"\x00")


def parse_reply(payload: bytes) -> Reply | None:
    """Parse a payload. None for a request, or for one that is short or claims more than it holds."""
    if len(payload) < _HEADER.size:
        return None
    sequence, session, opcode, size, answered, is_over, _, offset = _HEADER.unpack_from(payload)
    data = payload[_HEADER.size : _HEADER.size + size]
    if opcode not in (_ACK, _NAK) or size > DATA_BYTES:
        return None
    code = 0
    if opcode == _NAK:
        code = data[0] if data and data[0] else Code.FAIL
    return Reply(sequence, session, answered, code, bool(is_over), offset, data)


def ack(
    request: Request,
    data: bytes = b"",
    *,
    opcode: int = _ACK,
    session: int | None = None,
    offset: int | None = None,
    sequence: int | None = None,
    is_burst_over: bool = False,
) -> bytes:
    """Payload of an ACK. Omitted values are those of the request."""
    return _HEADER.pack(
        (request.sequence + 1 if sequence is None else sequence) & 0xFFFF,
        request.session if session is None else session,
        opcode,
        len(data),
        request.opcode,
        is_burst_over,
        0,
        request.offset if offset is None else offset,
    ) + data.ljust(DATA_BYTES, b"\x00")


def nak(
    request: Request, refusal: Refusal, *, offset: int | None = None, sequence: int | None = None
) -> bytes:
    """Payload of a NAK."""
    is_numbered = refusal.code is Code.FAIL_ERRNO
    data = bytes((refusal.code, refusal.number & 0xFF)) if is_numbered else bytes((refusal.code,))
    is_over = refusal.code is Code.END_OF_FILE and request.opcode == Opcode.BURST_READ_FILE
    return ack(request, data, opcode=_NAK, offset=offset, sequence=sequence, is_burst_over=is_over)
