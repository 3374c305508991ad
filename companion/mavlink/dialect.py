"""The only import of the generated dialect: module, message type and CRC."""

from collections.abc import Callable
from typing import Any, Protocol, TypeAlias

from pymavlink.dialects.v20 import all as dialect

__all__ = ["Message", "MessageType", "crc16", "dialect"]

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


def _crc16_interpreted(data: bytes) -> int:
    crc: int = dialect.x25crc(data).crc
    return crc


crc16: Callable[[bytes], int] = dialect.mcrf4xx or _crc16_interpreted
"""CRC-16/MCRF4XX of some bytes; compiled code where the dialect found it."""
