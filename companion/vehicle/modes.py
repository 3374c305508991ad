"""The boat's modes, with ArduPilot Rover's numbers and names."""

from enum import IntEnum


class Mode(IntEnum):
    """Modes that this boat has. A number that is missing here is refused, never pretended."""

    MANUAL = 0
    HOLD = 4
    LOITER = 5
    AUTO = 10
    RTL = 11
    GUIDED = 15

    @property
    def needs_position(self) -> bool:
        """Whether the mode steers by the position estimate."""
        return self not in (Mode.MANUAL, Mode.HOLD)


def mode_from_number(number: int) -> Mode | None:
    """The mode with this Rover number, None where this boat has no such mode."""
    try:
        return Mode(number)
    except ValueError:
        return None
