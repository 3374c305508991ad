"""The packed parameter file `@PARAM/param.pck`: all parameters in a few blocks of a file transfer.

Format after the MAVLink guide, "Parameters over MAVLink FTP". A header of three 16-bit numbers (magic, number
of entries, total number of parameters; in an upload the file's length instead), then the entries:

    type and flags | shared and new length of the name | new part of the name | value | default

The type is the low half of its byte; bit 4 is the flag "a default follows". The shared length is the low half
of the second byte, the new length less one the high half. Zeros before an entry are padding, so that a value
never spans two blocks.
"""

import struct
from collections.abc import Iterable, Sequence
from itertools import takewhile
from typing import NamedTuple

from companion.config.parameters import Parameters, ParameterType

BLOCK_BYTES = 239  # of a file transfer; padding is for blocks of this size
NAME_BYTES = 16
_HEADER = struct.Struct("<HHH")
_MAGIC, _MAGIC_DEFAULTS = 0x671B, 0x671C
_HAS_DEFAULT = 0x10
_SHARED_MAX = 15
# ArduPilot's own type numbers, not MAV_PARAM_TYPE
_TYPES = {ParameterType.INT8: 1, ParameterType.INT16: 2, ParameterType.INT32: 3, ParameterType.REAL32: 4}
_VALUES = {1: struct.Struct("<b"), 2: struct.Struct("<h"), 3: struct.Struct("<i"), 4: struct.Struct("<f")}


class PackError(ValueError):
    """Not a packed parameter file; says where and why."""


class PackedParameter(NamedTuple):
    """One parameter of a file."""

    name: str
    kind: ParameterType
    value: float
    default: float


def entries_of(parameters: Parameters) -> list[PackedParameter]:
    """All parameters with their present values, in order of index."""
    return [
        PackedParameter(row.name, row.kind, parameters.value(row), parameters.default(row))
        for row in parameters.rows
    ]


def pack(entries: Sequence[PackedParameter], total: int, *, with_defaults: bool = False) -> bytes:
    """The file of these entries; total: number of parameters. A default equal to the value is omitted."""
    file = bytearray(_HEADER.pack(_MAGIC_DEFAULTS if with_defaults else _MAGIC, len(entries), total))
    last = ""
    for name, kind, value, default in entries:
        number = _TYPES[kind]
        coding = _VALUES[number]
        has_default = with_defaults and default != value
        shared = min(_common(last, name), len(name) - 1, _SHARED_MAX)
        new = name[shared:].encode("ascii")
        entry = bytes((number | (_HAS_DEFAULT if has_default else 0), shared | (len(new) - 1) << 4)) + new
        values = [value, default] if has_default else [value]
        entry += b"".join(coding.pack(_fitting(kind, one)) for one in values)
        tail = len(values) * coding.size
        beyond = (len(file) + len(entry)) % BLOCK_BYTES
        if 0 < beyond < tail:
            file += bytes(tail - beyond)
        file += entry
        last = name
    return bytes(file)


def _common(one: str, other: str) -> int:
    return sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], zip(one, other, strict=False)))


def _fitting(kind: ParameterType, value: float) -> float:
    """The value limited to the range of its type."""
    if kind is ParameterType.REAL32:
        return value
    limit = {ParameterType.INT8: 0x7F, ParameterType.INT16: 0x7FFF, ParameterType.INT32: 0x7FFFFFFF}[kind]
    return max(-limit, min(round(value), limit))


def unpack_upload(file: bytes) -> list[tuple[str, float]]:
    """Names and values of an uploaded file. A PackError says where it is damaged."""
    if len(file) < _HEADER.size:
        raise PackError(f"{len(file)} bytes are too few for a parameter file")
    magic, count, length = _HEADER.unpack_from(file)
    if magic != _MAGIC:
        raise PackError(f"magic {magic:#06x}, expected {_MAGIC:#06x}")
    if length != len(file):
        raise PackError(f"{len(file)} bytes, but the header says {length}")
    values = list(_entries(file))
    if len(values) != count:
        raise PackError(f"{len(values)} entries, but the header says {count}")
    return values


def _entries(file: bytes) -> Iterable[tuple[str, float]]:
    at, end, last = _HEADER.size, len(file), b""
    while at < end:
        if file[at] == 0:
            at += 1
            continue
        coding = _VALUES.get(file[at])  # an upload has no flags
        if coding is None:
            raise PackError(f"byte {at}: {file[at]:#04x} is not a value type")
        lengths = file[at + 1] if at + 1 < end else 0
        shared, new = lengths & 0x0F, (lengths >> 4) + 1
        name = last[:shared] + file[at + 2 : at + 2 + new]
        value_at = at + 2 + new
        if value_at + coding.size > end:
            raise PackError(f"byte {at}: an entry is cut short")
        if shared > len(last) or len(name) > NAME_BYTES or not name.isascii():
            raise PackError(f"byte {at}: {name!r} is not a parameter name")
        (value,) = coding.unpack_from(file, value_at)
        yield name.decode("ascii"), float(value)
        at, last = value_at + coding.size, name
