"""The only import of the generated dialect: module, message type and CRC."""

from functools import cache
from typing import Any, Protocol, TypeAlias

from fastcrc.crc16 import mcrf4xx as crc16
from pymavlink.dialects.v20 import all as dialect

from companion.mavlink import metadata_messages  # noqa: F401  (they join the dialect when imported)

__all__ = [
    "Message", "MessageType", "build_message", "component_heartbeat", "constants", "crc16", "dialect",
    "message_ids",
]  # fmt: skip

MessageType: TypeAlias = Any
"""A generated message class."""


class Message(Protocol):
    """A message of the dialect. Its fields are attributes, named as in the MAVLink definition."""

    def get_type(self) -> str:
        """The name, such as `HEARTBEAT`."""

    def get_msgId(self) -> int:  # noqa: N802
        """The message number. (`id` may be a field.)"""

    def __getattr__(self, name: str) -> Any:  # noqa: ANN401
        """A field's value."""

    def __setattr__(self, name: str, value: object) -> None: ...


def constants(prefix: str, *names: str) -> tuple[int, ...]:
    """Numbers of the dialect by name, without their common prefix."""
    return tuple(int(getattr(dialect, f"{prefix}_{name}")) for name in names)


def message_ids(*names: str) -> tuple[int, ...]:
    """The numbers of messages."""
    return constants("MAVLINK_MSG_ID", *names)


def build_message(name: str, **fields: object) -> Message:
    """A message of the dialect. Omitted fields are zero or empty. Raises TypeError: no such field."""
    message_type, zeros = _zeros(name)
    message: Message = message_type(**{**zeros, **fields})
    return message


def component_heartbeat(kind: int) -> Message:
    """The heartbeat of what is no autopilot, at work. kind: a MAV_TYPE."""
    return build_message(
        "HEARTBEAT",
        type=kind,
        autopilot=dialect.MAV_AUTOPILOT_INVALID,
        system_status=dialect.MAV_STATE_ACTIVE,
        mavlink_version=3,
    )


@cache
def _zeros(name: str) -> tuple[MessageType, dict[str, object]]:
    message_type = getattr(dialect, f"MAVLink_{name.lower()}_message")
    lengths = dict(zip(message_type.ordered_fieldnames, message_type.lengths, strict=True))
    zeros: dict[str, object] = {
        field: b"" if kind == "char" else [0] * lengths[field] if lengths[field] > 1 else 0
        for field, kind in zip(message_type.fieldnames, message_type.fieldtypes, strict=True)
    }
    return message_type, zeros
