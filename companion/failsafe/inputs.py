"""What the failsafes look at: one frozen value, made once a cycle by `companion.vehicle.failsafes`."""

import math

from msgspec import Struct

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point
from companion.core.modes import Mode
from companion.core.readings import BatteryReading, DepthReading, HeadingReading, HullReading
from companion.core.state import NavState
from companion.failsafe.motors.hypotheses import Hypothesis
from companion.failsafe.recovery.transition_table import State
from companion.geofence.fence import Fence
from companion.guidance.stall_detector import StallVerdict


class BoardReadings(Struct, frozen=True):
    """What the vehicle does not know itself: motors, senses and the computer.

    left, right, rudder: what motors and rudder are given. judges_motors: False where the hull does not move
    as the motors push, at an obstacle, at the shore or in a calibration trial. held_s: for how long the shore
    has held the boat. depth: the latest sounding that found the bottom. was_deep: the water has been deep
    enough since arming. load: share of the tick that the loop takes. has_lost_sonar: it has pinged, and is
    silent or noisy. storage_fault: why something could not be written, "".
    """

    left: float = 0.0
    right: float = 0.0
    rudder: float = 0.0
    judges_motors: bool = True
    stall: StallVerdict = StallVerdict.MAKING_WAY
    held_s: float = 0.0
    load: float = 0.0
    consumed_mah: float = 0.0
    heading: HeadingReading | None = None
    hull: HullReading | None = None
    depth: DepthReading | None = None
    was_deep: bool = False
    has_lost_sonar: bool = False
    storage_fault: str = ""


class FailsafeInputs(Struct, frozen=True, kw_only=True):
    """One cycle's inputs.

    operator_silent_s: NaN before the first heartbeat. planner_silent_s: NaN while no planner steers.
    sticks_dropped: a station's sticks steered, and are stale. radio_fault: what is wrong with a transmitter
    that has been heard. beyond_fence_m: 0 inside. station: where LOITER stays. range_fault: why the
    charge does not take the boat home. verdict: the motor fault inferred under way. needs_motor_check: only
    a check can tell. needs_motor_comparison: a propeller seems fouled. failed_motor: the one that a motor
    check has found, in words. rudder_fault: why the rudder does not steer, in words.
    """

    now_s: float
    config: BoatConfig
    mode: Mode = Mode.HOLD
    armed: bool = False
    nav: NavState | None = None
    battery: BatteryReading | None = None
    board: BoardReadings = BoardReadings()
    fence: Fence
    beyond_fence_m: float = 0.0
    station: Point | None = None
    operator_silent_s: float = math.nan
    planner_silent_s: float = math.nan
    sticks_dropped: bool = False
    has_station_sticks: bool = False
    radio_heard: bool = False
    radio_fault: str = ""
    range_fault: str = ""
    verdict: Hypothesis | None = None
    needs_motor_check: bool = False
    needs_motor_comparison: bool = False
    failed_motor: str = ""
    reversed_motor: bool = False
    rudder_fault: str = ""
    recovery: State = State.IDLE
