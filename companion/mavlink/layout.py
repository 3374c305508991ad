"""Payload layout of each message, from the generated classes.

The generated code packs and parses messages in a general way, at about 6 µs each. What is constant per
message (field order, arrays, strings) is precomputed here; the message classes are the generated ones.
"""

from collections.abc import Callable, Iterable, Sequence
from operator import attrgetter, itemgetter
from typing import Any

from companion.mavlink.dialect import Message, MessageType, dialect


class Layout:
    """Payload of one message.

    size: full length in bytes, with extensions; crc_extra: the byte that ties the CRC to this definition.
    `pack` encodes a message at full length; `unpack` decodes a payload that may be truncated (trailing zeros)
    or too long (newer definition).
    """

    __slots__ = ("crc_extra", "message_id", "pack", "size", "unpack")

    def __init__(self, message_id: int, message_type: MessageType) -> None:
        self.message_id = message_id
        self.size: int = message_type.unpacker.size
        self.crc_extra = bytes((message_type.crc_extra,))
        has_arrays = len(message_type.fieldnames) == 1 or any(n > 1 for n in message_type.lengths)
        self.pack: Callable[[Message], bytes] = (_packer_of_arrays if has_arrays else _packer)(message_type)
        self.unpack: Callable[[bytes], Message] = (_unpacker_of_arrays if has_arrays else _unpacker)(
            message_type
        )


def _wire_names(message_type: MessageType) -> Iterable[str]:
    """Attribute names in wire order; a text is also kept as bytes."""
    types = dict(zip(message_type.fieldnames, message_type.fieldtypes, strict=True))
    for name in message_type.ordered_fieldnames:
        yield f"_{name}_raw" if types[name] == "char" else name


def _packer(message_type: MessageType) -> Callable[[Message], bytes]:
    pack, values = message_type.unpacker.pack, attrgetter(*_wire_names(message_type))

    def pack_scalars(message: Message) -> bytes:
        payload: bytes = pack(*values(message))
        return payload

    return pack_scalars


def _packer_of_arrays(message_type: MessageType) -> Callable[[Message], bytes]:
    pack = message_type.unpacker.pack
    plan = tuple(zip(_wire_names(message_type), message_type.lengths, strict=True))

    def pack_arrays(message: Message) -> bytes:
        values: list[Any] = []
        for name, length in plan:
            value = getattr(message, name)
            if length == 1:
                values.append(value)
            else:
                values.extend(value[:length])
        payload: bytes = pack(*values)
        return payload

    return pack_arrays


def _unpacker(message_type: MessageType) -> Callable[[bytes], Message]:
    unpack, size = message_type.unpacker.unpack, message_type.unpacker.size
    in_field_order = itemgetter(*message_type.orders)

    def unpack_scalars(payload: bytes) -> Message:
        if len(payload) != size:
            payload = payload[:size].ljust(size, b"\0")
        message: Message = message_type(*in_field_order(unpack(payload)))
        return message

    return unpack_scalars


def _unpacker_of_arrays(message_type: MessageType) -> Callable[[bytes], Message]:
    unpack, size = message_type.unpacker.unpack, message_type.unpacker.size
    plan = tuple(_places(message_type.orders, message_type.lengths))

    def unpack_arrays(payload: bytes) -> Message:
        values = unpack(payload[:size].ljust(size, b"\0"))
        message: Message = message_type(
            *[values[at] if n == 1 else list(values[at : at + n]) for at, n in plan]
        )
        return message

    return unpack_arrays


def _places(orders: Sequence[int], lengths: Sequence[int]) -> Iterable[tuple[int, int]]:
    """Offset of each field's values, and their number."""
    for order in orders:
        yield sum(lengths[:order]), lengths[order]


LAYOUTS: dict[int, Layout] = {
    message_id: Layout(message_id, message_type) for message_id, message_type in dialect.mavlink_map.items()
}
"""Every message of the dialect, by number."""
