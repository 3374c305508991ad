"""The boat's modes, with ArduPilot Rover's numbers and names."""

from enum import IntEnum


class Mode(IntEnum):
    """Modes that this boat has. A number that is missing here is refused, never pretended."""

    MANUAL = 0
    ACRO = 1
    STEERING = 3
    HOLD = 4
    LOITER = 5
    FOLLOW = 6
    SIMPLE = 7
    CIRCLE = 9
    AUTO = 10
    RTL = 11
    SMART_RTL = 12
    GUIDED = 15

    @property
    def needs_position(self) -> bool:
        """Whether the mode steers by the position estimate, be it only for the speed over ground."""
        return self not in (Mode.MANUAL, Mode.HOLD)

    @property
    def is_by_hand(self) -> bool:
        """Whether the operator's sticks steer."""
        return self in (Mode.MANUAL, Mode.ACRO, Mode.STEERING, Mode.SIMPLE)


COMES_INSIDE = (Mode.LOITER, Mode.RTL)
"""Begun outside the fence, they lead back inside first."""


def mode_from_number(number: int) -> Mode | None:
    """The mode with this Rover number, None where this boat has no such mode."""
    try:
        return Mode(number)
    except ValueError:
        return None
