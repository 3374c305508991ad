"""What the failsafes look at: one frozen value, made once a cycle by `companion.vehicle.failsafes`; and what
the guards of the table, which say when a failsafe does not act, ask of it.
"""

import math
from typing import Final

from msgspec import Struct

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point
from companion.core.modes import Mode
from companion.core.readings import BatteryReading, DepthReading, EscPair, HeadingReading, HullReading
from companion.core.state import NavState, lacks_heading
from companion.failsafe.actions import UNGROUNDING, State
from companion.failsafe.motors.hypotheses import Hypothesis
from companion.geofence.fence import Fence
from companion.guidance.stall_detector import StallVerdict

_ASTRAY_RAD: Final = (0.0, -0.3, 0.3)  # the direction of the current is known to about this

HELD_S: Final = 2.0  # in place at the shore: from then on the motion says nothing of the motors

ALL_MODES: Final[frozenset[Mode]] = frozenset(Mode)
POSITION_MODES: Final[frozenset[Mode]] = frozenset(mode for mode in Mode if mode.rules.needs_position)
"""Not MANUAL, which the operator may always choose."""
AUTONOMOUS_MODES: Final[frozenset[Mode]] = frozenset(mode for mode in Mode if not mode.rules.is_by_hand)


class BoardReadings(Struct, frozen=True):
    """What the vehicle does not know itself: motors, senses and the computer.

    left, right, rudder: what motors and rudder are given. judges_motors: False where the hull does not move
    as the motors push, at an obstacle, at the shore or in a calibration trial. held_s: for how long the shore
    has held the boat. depth: the latest sounding that found the bottom. was_deep: the water has been deep
    enough since arming. load: share of the tick that the loop takes. has_lost_sonar: it has pinged, and is
    silent or noisy; has_lost_lidar: likewise. storage_fault: why something could not be written, "". escs:
    what left and right speed controller report.
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
    has_lost_lidar: bool = False
    escs: EscPair = (None, None)
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


def on_way_home(inputs: FailsafeInputs) -> bool:
    """The boat sails home already."""
    return inputs.mode.rules.returns_home


def on_way_home_or_inside(inputs: FailsafeInputs) -> bool:
    """The boat sails home, or to a station inside the fence."""
    if inputs.mode is not Mode.LOITER:
        return inputs.mode.rules.returns_home
    return inputs.station is not None and inputs.fence.allows(inputs.station)


def never(_: FailsafeInputs) -> bool:
    """No exception is made."""
    return False


def held_at_shore(inputs: FailsafeInputs) -> bool:
    """The shore holds the boat, or the boat is getting off. Its position lies about the line of the fence."""
    is_ashore = inputs.board.held_s > HELD_S or inputs.recovery in UNGROUNDING
    return is_ashore and inputs.beyond_fence_m <= inputs.config.fence.margin_m


def heading_in_doubt(inputs: FailsafeInputs) -> bool:
    """The heading sensor is silent: soon the heading is lost, or the sensor is back. Meanwhile nothing can be
    steered by dead reckoning.
    """
    nav, config = inputs.nav, inputs.config
    if nav is None or lacks_heading(nav, config.motors.estimate_timeout_s):
        return False
    return nav.heading_age_s >= config.estimation.compass_timeout_s


def may_drift(nav: NavState | None, fence: Fence, seconds: float) -> bool:
    """Whether the current carries the boat over no line of the fence in this time."""
    if nav is None:
        return True
    drift_m = seconds * math.hypot(nav.current_north_m_s, nav.current_east_m_s)
    course = math.atan2(nav.current_east_m_s, nav.current_north_m_s)
    return all(fence.room_m(nav.point, course + off, drift_m) >= drift_m for off in _ASTRAY_RAD)
