"""The boat's modes, with ArduPilot Rover's numbers and names."""

from enum import IntEnum


class Mode(IntEnum):
    """The modes of this boat. Other numbers are refused."""

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
        """Whether the mode uses the position estimate, if only for the speed over ground."""
        return self not in (Mode.MANUAL, Mode.HOLD)

    @property
    def is_by_hand(self) -> bool:
        """Whether the operator steers manually."""
        return self in (Mode.MANUAL, Mode.ACRO, Mode.STEERING, Mode.SIMPLE)


COMES_INSIDE = (Mode.LOITER, Mode.RTL)
"""Entered outside the fence, these modes return inside first."""


def mode_from_number(number: int) -> Mode | None:
    """The mode with this Rover number, or None."""
    try:
        return Mode(number)
    except ValueError:
        return None
