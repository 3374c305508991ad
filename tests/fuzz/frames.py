"""Valid frames with hostile fields: bytes of the fuzzer's own become a message that the boat believes."""

import struct
from functools import cache
from typing import Any

from pymavlink.dialects.v20 import all as dialect

_TARGETS = {"target_system": 1, "target_component": 1, "target": 1}


@cache
def _targets_of(message_id: int) -> dict[int, int]:
    """Where a message says whom it is for, and what makes that the boat."""
    kind = dialect.mavlink_map[message_id]
    found, at = {}, 0
    for name, size, length in zip(kind.ordered_fieldnames, _sizes(kind), kind.lengths, strict=False):
        if name in _TARGETS and size == 1:
            found[at] = _TARGETS[name]
        at += size * max(1, length)
    return found


def _sizes(kind: Any) -> list[int]:  # noqa: ANN401  the generated dialect is untyped
    types = dict(zip(kind.fieldnames, kind.fieldtypes, strict=True))
    width = {"char": 1, "int8_t": 1, "uint8_t": 1, "int16_t": 2, "uint16_t": 2, "int32_t": 4, "uint32_t": 4}
    width |= {"float": 4, "int64_t": 8, "uint64_t": 8, "double": 8}
    return [width[types[name]] for name in kind.ordered_fieldnames]


def frame(
    message_id: int, payload: bytes, sequence: int = 0, system: int = 255, component: int = 190
) -> bytes:
    """A MAVLink 2 frame, addressed to the boat where it can be, with a checksum that fits."""
    kind = dialect.mavlink_map[message_id]
    body = bytearray(payload[: kind.unpacker.size].ljust(kind.unpacker.size, b"\0"))
    for at, value in _targets_of(message_id).items():
        body[at] = value
    trimmed = bytes(body).rstrip(b"\0") or b"\0"
    head = struct.pack(
        "<BBBBBBHB",
        len(trimmed),
        0,
        0,
        sequence & 0xFF,
        system,
        component,
        message_id & 0xFFFF,
        message_id >> 16,
    )
    crc = dialect.x25crc(head + trimmed + bytes((kind.crc_extra,))).crc
    return b"\xfd" + head + trimmed + struct.pack("<H", crc)
