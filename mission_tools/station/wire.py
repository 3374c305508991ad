"""What this client asks of a link and its port, and how it names itself."""

from collections.abc import Sequence
from typing import Protocol

from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, dialect

AUTOPILOT = 1  # the component of a boat that answers commands
OWN_COMPONENT: int = dialect.MAV_COMP_ID_MISSIONPLANNER  # as ground stations name themselves


class Link(Protocol):
    """A byte pipe to one peer. Never blocks, never raises once open."""

    @property
    def is_datagram(self) -> bool:
        """Whether a received chunk is a datagram."""

    @property
    def is_closed(self) -> bool:
        """True once the far side is gone for good."""

    def fileno(self) -> int:
        """A descriptor to wait on for received bytes, −1 without one."""

    def receive(self) -> list[bytes]:
        """All received chunks, oldest first."""

    def send(self, data: bytes) -> bool:
        """Send a frame whole, or drop it whole and return False."""


class Port(Protocol):
    """A source of links."""

    def accept(self) -> Sequence[Link]:
        """New links since the last call."""

    def close(self) -> None:
        """Close, with all links."""


def heartbeat(is_operator: bool) -> Message:
    """An operator's heartbeats hold off the boat's failsafe OPERATOR_LOST; those of other programs do not."""
    kind = dialect.MAV_TYPE_GCS if is_operator else dialect.MAV_TYPE_ONBOARD_CONTROLLER
    message: Message = dialect.MAVLink_heartbeat_message(
        kind, dialect.MAV_AUTOPILOT_INVALID, 0, 0, dialect.MAV_STATE_ACTIVE, 3
    )
    return message


def command_long(boat: Address, number: int, *params: float, repeat: int = 0) -> Message:
    """COMMAND_LONG; missing parameters are 0."""
    values = [*params, *([0.0] * (7 - len(params)))]
    message: Message = dialect.MAVLink_command_long_message(*boat, number, repeat, *values)
    return message
