"""What the boat does when something goes wrong, and when it counts as wrong."""

import math
from typing import Annotated

from msgspec import Meta

from companion.config.section import NonNegative, Positive, Section, Share

ActionNumber = Annotated[int, Meta(ge=0, le=6)]
ClearingNumber = Annotated[int, Meta(ge=0, le=7)]
MotorNumber = Annotated[int, Meta(ge=0, le=8)]
GroundNumber = Annotated[int, Meta(ge=0, le=9)]


class Failsafe(Section, frozen=True):
    """Limits and actions of the failsafes; `vehicle/failsafes/table.py` has them all side by side.

    Actions are Rover's FS_ACTION numbers: 0 told only, 1 RTL, 2 HOLD, 3 SMART_RTL or RTL, 4 SMART_RTL or
    HOLD, 5 disarm, 6 LOITER or HOLD; and the boat's own, 7: clear the propellers by pulses astern, go on,
    8: try the motors one by one, and go on with what answers, 9: get off the shore.
    """

    gcs_enabled: bool = True
    gcs_timeout_s: Positive = 5.0
    action: ActionNumber = 6
    long_timeout_s: NonNegative = 120.0  # operator or planner still lost after this; 0: never
    long_action: ActionNumber = 1
    rc_enabled: Annotated[int, Meta(ge=0, le=2)] = 1  # transmitter or sticks lost: 0 off, 1 on, 2 not in AUTO
    manual_timeout_s: Positive = 1.0  # MANUAL_CONTROL and RC override go stale after this
    rc_timeout_s: NonNegative = 1.5  # and helm or transmitter count as lost so much later
    planner_timeout_s: NonNegative = 5.0  # 0: off
    planner_action: ActionNumber = 6
    battery_low_v: NonNegative = 10.2  # 0: off
    battery_low_s: Positive = 10.0
    battery_action: ActionNumber = 1
    battery_critical_v: NonNegative = 9.6  # 0: off
    battery_critical_action: ActionNumber = 1
    range_action: ActionNumber = 1
    range_margin: Annotated[float, Meta(ge=1.0, le=10.0)] = 1.5  # of the charge that the way home takes
    range_reserve: Share = 0.1  # of the capacity, not to be used at all
    fence_action: ActionNumber = 1  # outside the fence; LOITER is then on the nearest water inside
    position_action: ActionNumber = 6
    dead_reckoning_s: NonNegative = 300.0  # without a position, bow into the water, before it gives up
    heading_action: ActionNumber = 6  # without a heading it drifts, and stays where it finds it again
    gnss_action: ActionNumber = 0
    compass_action: ActionNumber = 0
    sonar_action: ActionNumber = 0
    sonar_timeout_s: Positive = 3.0
    steering_action: MotorNumber = 8
    motor_action: MotorNumber = 8
    stuck_action: ClearingNumber = 7
    aground_action: GroundNumber = 9
    clearing_tries: Annotated[int, Meta(ge=1, le=10)] = 2
    headway_action: ActionNumber = 1
    capsize_rad: Annotated[float, Meta(ge=0.0, le=math.pi)] = math.radians(60.0)  # 0: off
    capsize_action: ActionNumber = 5
    leak_action: ActionNumber = 1
    max_temperature_c: NonNegative = 85.0  # of hull or computer; 0: off
    temperature_action: ActionNumber = 1
    overrun_action: ActionNumber = 6
    storage_action: ActionNumber = 0
    resume: Annotated[int, Meta(ge=0, le=2)] = 1  # a mission cut by a power loss: 0 forget, 1 ask, 2 go on
