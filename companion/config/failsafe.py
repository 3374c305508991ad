"""Configuration of the failsafes: thresholds and actions."""

import math
from typing import Annotated

from msgspec import Meta

from companion.config.section import NonNegative, Positive, Section, Share

ActionNumber = Annotated[int, Meta(ge=0, le=6)]
ClearingNumber = Annotated[int, Meta(ge=0, le=7)]
MotorNumber = Annotated[int, Meta(ge=0, le=8)]
GroundNumber = Annotated[int, Meta(ge=0, le=9)]


class Failsafe(Section, frozen=True):
    """Thresholds and actions; `failsafe/table.py` lists all failsafes.

    Actions are Rover's FS_ACTION numbers: 0 report only, 1 RTL, 2 HOLD, 3 SMART_RTL or RTL, 4 SMART_RTL or
    HOLD, 5 disarm, 6 LOITER or HOLD; and the boat's own: 7 clear the propellers by pulses astern, 8 test the
    motors one by one and continue with those that work, 9 get off the shore.
    """

    gcs_enabled: bool = True
    gcs_timeout_s: Positive = 5.0
    action: ActionNumber = 6
    long_timeout_s: NonNegative = 120.0  # operator or planner lost for this long; 0: never
    long_action: ActionNumber = 1
    # transmitter or manual input lost: 0 off, 1 on, 2 not in AUTO
    rc_enabled: Annotated[int, Meta(ge=0, le=2)] = 1
    manual_timeout_s: Positive = 1.0  # lifetime of MANUAL_CONTROL and RC override
    rc_timeout_s: NonNegative = 1.5  # delay of the RC failsafe
    planner_timeout_s: NonNegative = 5.0  # 0: off
    planner_action: ActionNumber = 6
    battery_low_v: NonNegative = 10.2  # 0: off
    battery_low_s: Positive = 10.0
    battery_action: ActionNumber = 1
    battery_critical_v: NonNegative = 9.6  # 0: off
    battery_critical_action: ActionNumber = 1
    range_action: ActionNumber = 1
    range_margin: Annotated[float, Meta(ge=1.0, le=10.0)] = 1.5  # times the charge for the way home
    range_reserve: Share = 0.1  # of the capacity, never to be used
    fence_action: ActionNumber = 1  # outside the fence; LOITER goes to the nearest place inside
    position_action: ActionNumber = 6
    dead_reckoning_s: NonNegative = 300.0  # without a position, bow into the current, before HOLD
    heading_action: ActionNumber = 6  # without a heading the boat drifts
    gnss_action: ActionNumber = 0
    compass_action: ActionNumber = 0
    sonar_action: ActionNumber = 0
    sonar_timeout_s: Positive = 3.0
    steering_action: MotorNumber = 8
    motor_action: MotorNumber = 8
    stuck_action: ClearingNumber = 7
    aground_action: GroundNumber = 9
    min_depth_m: NonNegative = 1.0  # of the water, with a sounder: three times what it can measure; 0: off
    depth_action: ActionNumber = 3  # back over water that was deep enough; LOITER would stay in the shallows
    clearing_tries: Annotated[int, Meta(ge=1, le=10)] = 2
    headway_action: ActionNumber = 1
    capsize_rad: Annotated[float, Meta(ge=0.0, le=math.pi)] = math.radians(60.0)  # 0: off
    capsize_action: ActionNumber = 5
    leak_action: ActionNumber = 1
    max_temperature_c: NonNegative = 85.0  # of hull or computer; 0: off
    temperature_action: ActionNumber = 1
    overrun_action: ActionNumber = 6
    storage_action: ActionNumber = 0
    # mission interrupted by a power loss: 0 forget, 1 ask, 2 resume
    resume: Annotated[int, Meta(ge=0, le=2)] = 1
