"""Who sends and who is meant.

A target of 0 means all systems, or all components of a system (MAVLink guide, "Routing").
"""

from functools import cache
from typing import NamedTuple

ALL = 0


class Address(NamedTuple):
    """A MAVLink system and one of its components, both 1..255 for a real one."""

    system: int
    component: int


@cache
def address(system: int, component: int) -> Address:
    """The address of two bytes of a header, made once: there are no more than 65,536."""
    return Address(system, component)


def concerns(own: Address, target_system: int, target_component: int) -> bool:
    """Whether a message with this target is for us: to all, to all of our system, or to us alone.

    A message without target fields concerns everybody; its caller need not ask.
    """
    if target_system == ALL:
        return True
    return target_system == own.system and target_component in (ALL, own.component)


def is_named(own: Address, target_system: int, target_component: int) -> bool:
    """Whether our system is meant by its number; the component may be left open.

    This is the rule for conversations: a mission offered to system 0 is offered to nobody, or every boat
    within reach would take it.
    """
    return target_system == own.system and target_component in (ALL, own.component)
