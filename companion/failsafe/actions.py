"""What a failsafe can do."""

from enum import IntEnum

from companion.core.modes import Mode


class Action(IntEnum):
    """ArduPilot Rover's FS_ACTION numbers, and three of the boat's own."""

    NONE = 0
    RTL = 1
    HOLD = 2
    SMART_RTL_OR_RTL = 3
    SMART_RTL_OR_HOLD = 4
    DISARM = 5
    LOITER_OR_HOLD = 6
    CLEAR_PROPELLERS = 7
    TRY_MOTORS = 8
    GET_OFF = 9


RETREATS: dict[Action, tuple[Mode, ...]] = {
    Action.RTL: (Mode.RTL, Mode.LOITER),
    Action.HOLD: (),
    Action.SMART_RTL_OR_RTL: (Mode.SMART_RTL, Mode.RTL, Mode.LOITER),
    Action.SMART_RTL_OR_HOLD: (Mode.SMART_RTL,),
    Action.LOITER_OR_HOLD: (Mode.LOITER,),
}
"""The modes of an action: the first that can be entered, else HOLD. Who cannot go home stays, not drifts."""

ON_THE_SPOT = (Action.CLEAR_PROPELLERS, Action.TRY_MOTORS, Action.GET_OFF)
"""In place of the mode, which goes on afterwards."""

WAYS_HOME = (Mode.RTL, Mode.SMART_RTL)
