"""MAVLink addresses.

A target of 0 means all systems, or all components of a system (MAVLink guide, "Routing").
"""

from functools import cache
from typing import NamedTuple

ALL = 0


class Address(NamedTuple):
    """A MAVLink system and component, both 1..255."""

    system: int
    component: int


@cache
def address(system: int, component: int) -> Address:
    return Address(system, component)


def is_named(own: Address, target_system: int, target_component: int) -> bool:
    """Whether our system is addressed explicitly; the component may be 0.

    Required for conversations: a mission offered to system 0 would be accepted by every boat in range.
    """
    return target_system == own.system and target_component in (ALL, own.component)


def concerns(own: Address, target_system: int, target_component: int) -> bool:
    """Whether a message with this target is for us: to all, to our system, or to our component."""
    return target_system == ALL or is_named(own, target_system, target_component)
