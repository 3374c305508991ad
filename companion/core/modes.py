"""The boat's modes, with ArduPilot Rover's numbers and names, and what each may do."""

from enum import IntEnum
from typing import Final, NamedTuple


class ModeRules(NamedTuple):
    """What a mode needs and may do. What else it lacks now (a mission, a home …) its controller says.

    title: as QGroundControl's Rover plug-in spells it, whose buttons find a mode by these letters.
    needs_position: a position and a heading, to be entered and to be armed in. is_by_hand: the operator's
    sticks steer. comes_inside: it may be armed outside the fence, because it first leads back inside.
    returns_home: it ends where the boat was armed, at home or at a rally point. keeps_station: calibration
    may run in it. is_resumable: it is continued after a power loss. is_advanced: stations may list it apart.
    """

    title: str
    needs_position: bool = True
    is_by_hand: bool = False
    comes_inside: bool = False
    returns_home: bool = False
    keeps_station: bool = False
    is_resumable: bool = False
    is_advanced: bool = False


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
    def rules(self) -> ModeRules:
        """Its row of the table."""
        return RULES[self]


RULES: Final[dict[Mode, ModeRules]] = {
    Mode.MANUAL: ModeRules("Manual", needs_position=False, is_by_hand=True),
    Mode.ACRO: ModeRules("Acro", is_by_hand=True, is_advanced=True),
    Mode.STEERING: ModeRules("Steering", is_by_hand=True, is_advanced=True),
    Mode.HOLD: ModeRules("Hold", needs_position=False),
    Mode.LOITER: ModeRules("Loiter", comes_inside=True, keeps_station=True),
    Mode.FOLLOW: ModeRules("Follow", is_advanced=True),
    Mode.SIMPLE: ModeRules("Simple", is_by_hand=True, is_advanced=True),
    Mode.CIRCLE: ModeRules("Circle"),
    Mode.AUTO: ModeRules("Auto", is_resumable=True),
    Mode.RTL: ModeRules("RTL", comes_inside=True, returns_home=True, is_resumable=True),
    Mode.SMART_RTL: ModeRules("Smart RTL", returns_home=True, is_resumable=True),
    Mode.GUIDED: ModeRules("Guided", keeps_station=True),
}


def mode_from_number(number: int) -> Mode | None:
    """The mode with this Rover number, or None."""
    try:
        return Mode(number)
    except ValueError:
        return None
