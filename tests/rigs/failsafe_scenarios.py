"""A scenario for each row of the failsafe table, with the numbers of the failsafes page as literals."""

import math
from collections.abc import Callable
from typing import NamedTuple

from boat_rig import nav_at
from msgspec.structs import replace

from companion.core.modes import Mode
from companion.core.readings import BatteryReading, DepthReading, HeadingReading, HullReading
from companion.core.state import EstimateFault
from companion.failsafe.actions import Action, State
from companion.failsafe.inputs import FailsafeInputs
from companion.failsafe.motors.hypotheses import HYPOTHESES, Fault
from companion.failsafe.table import Condition
from companion.guidance.stall_detector import StallVerdict

INF = math.inf
ALL = set(Mode)
BY_POSITION = ALL - {Mode.MANUAL, Mode.HOLD}
AUTONOMOUS = ALL - {Mode.MANUAL, Mode.ACRO, Mode.STEERING, Mode.SIMPLE}
WAYS_HOME = {Mode.RTL, Mode.SMART_RTL}

Inputs = Callable[[FailsafeInputs], FailsafeInputs]


class Scenario(NamedTuple):
    """wrong: inputs just beyond the row's threshold; right: just within. then: seconds after the step before,
    and the action. modes: those in which it acts. spared: those in which a retreat is left out. waiting: what
    keeps the row from firing, just beyond its threshold; ready: just within.
    """

    wrong: Inputs
    right: Inputs
    text: str
    over: str
    action: Action
    after_s: float
    clear_s: float
    then: tuple[tuple[float, Action], ...] = ()
    modes: set[Mode] = ALL
    spared: set[Mode] = WAYS_HOME
    is_watched_disarmed: bool = False
    relapse_s: float = 0.0
    is_slow: bool = False
    waiting: tuple[Inputs, ...] = ()
    ready: tuple[Inputs, ...] = ()


def both(first: Inputs, then: Inputs) -> Inputs:
    return lambda inputs: then(first(inputs))


def with_board(**readings: object) -> Inputs:
    return lambda inputs: replace(inputs, board=replace(inputs.board, **readings))


def with_roll(degrees: float) -> Inputs:
    return lambda one: with_board(heading=HeadingReading(one.now_s, 0.0, 0.0, math.radians(degrees), 0.0))(
        one
    )


def with_hull(*, is_wet: bool = False, celsius: float = 20.0) -> Inputs:
    return lambda one: with_board(hull=HullReading(one.now_s, is_wet, celsius))(one)


def with_depth(depth_m: float | None, transducer_m: float = 0.0, *, was_deep: bool = True) -> Inputs:
    return lambda one: with_board(
        depth=DepthReading(one.now_s, depth_m, transducer_m=transducer_m), was_deep=was_deep
    )(one)


def with_volts(volt: float) -> Inputs:
    return lambda one: replace(one, battery=BatteryReading(one.now_s, volt, 2.0))


def with_nav(**more: object) -> Inputs:
    return lambda one: replace(one, nav=replace(nav_at(), **more))


def with_verdict(fault: Fault) -> Inputs:
    verdict = next(one for one in HYPOTHESES if one.is_left and one.fault is fault)
    return lambda one: replace(one, verdict=verdict)


def given(**more: object) -> Inputs:
    return lambda one: replace(one, **more)


LONG = (120.0, Action.RTL)
CLEAR_AGAIN = (18.0, Action.CLEAR_PROPELLERS)
HOME = (15.0, Action.RTL)
GIVE_UP = (90.0, Action.LOITER_OR_HOLD)
LOITER, RTL, NONE = Action.LOITER_OR_HOLD, Action.RTL, Action.NONE

SCENARIOS: dict[Condition, Scenario] = {
    Condition.CAPSIZED: Scenario(
        with_roll(61.0), with_roll(59.0), "Capsized: roll 61, pitch 0", "upright again",
        Action.DISARM, 2.0, 5.0,
    ),
    Condition.HEADING_LOST: Scenario(
        with_nav(heading_age_s=3.1), with_nav(heading_age_s=2.9), "Heading lost", "heading known again",
        LOITER, 0.0, 1.0, modes=BY_POSITION, spared=set(),
    ),
    Condition.POSITION_LOST: Scenario(
        with_nav(position_age_s=3.1), with_nav(position_age_s=2.9), "Position lost", "position known again",
        LOITER, 0.5, 2.0, ((300.0, Action.HOLD),), modes=BY_POSITION, spared=set(),
        waiting=(with_nav(position_age_s=3.1, heading_age_s=1.5),),
        ready=(
            with_nav(position_age_s=3.1, heading_age_s=1.4),
            with_nav(position_age_s=3.1, heading_age_s=3.1),
        ),
    ),
    Condition.LEAK: Scenario(
        with_hull(is_wet=True), with_hull(),
        "Water in the hull", "hull dry again", RTL, 2.0, 10.0,
    ),
    Condition.TOO_HOT: Scenario(
        with_hull(celsius=86.0), with_hull(celsius=84.0), "Too hot: 86 C", "cool again",
        RTL, 10.0, 30.0,
    ),
    Condition.BATTERY_CRITICAL: Scenario(
        with_volts(9.58), with_volts(9.62), "Battery critical: 9.6 V", "", RTL, 10.0, INF,
        is_watched_disarmed=True,
    ),
    Condition.BATTERY_LOW: Scenario(
        with_volts(10.18), with_volts(10.22), "Battery low: 10.2 V", "", RTL, 10.0, INF,
        is_watched_disarmed=True,
    ),
    Condition.OUT_OF_RANGE: Scenario(
        given(range_fault="Point of no return"), given(), "Point of no return", "", RTL, 5.0, INF,
    ),
    Condition.STEERING_LOST: Scenario(
        with_verdict(Fault.REVERSED), with_verdict(Fault.DEAD), "Steering lost: left motor reversed",
        "steering works again", Action.CHECK_MOTORS, 0.0, 10.0,
        ((15.0, Action.CHECK_MOTORS), (15.0, LOITER)), modes=AUTONOMOUS, spared=set(), relapse_s=60.0,
    ),
    Condition.MOTOR_FAILING: Scenario(
        with_verdict(Fault.BLOCKED), with_verdict(Fault.REVERSED),
        "Left motor is blocked", "motors work again",
        Action.CHECK_MOTORS, 0.0, 15.0, (CLEAR_AGAIN, CLEAR_AGAIN, HOME, GIVE_UP),
        modes=AUTONOMOUS, spared=set(), relapse_s=60.0, is_slow=True,
    ),
    Condition.AGROUND: Scenario(
        with_board(stall=StallVerdict.AGROUND), with_board(stall=StallVerdict.STUCK),
        "Aground: held at the shore", "afloat again", Action.UNGROUND, 0.0, 2.0,
        modes=AUTONOMOUS, spared=set(),
    ),
    Condition.SHALLOW: Scenario(
        with_depth(0.79, transducer_m=0.2), with_depth(0.81, transducer_m=0.2),
        "Shallow: 1.0 m", "deep enough again",
        Action.SMART_RTL_OR_RTL, 1.5, 5.0, modes=AUTONOMOUS,
    ),
    Condition.STUCK: Scenario(
        with_board(stall=StallVerdict.STUCK), with_board(stall=StallVerdict.NO_HEADWAY),
        "Stuck: something holds the boat", "free again", Action.CLEAR_PROPELLERS, 0.0, 15.0,
        (CLEAR_AGAIN, HOME, GIVE_UP), modes=AUTONOMOUS, spared=set(), relapse_s=60.0, is_slow=True,
    ),
    Condition.NO_HEADWAY: Scenario(
        with_board(stall=StallVerdict.NO_HEADWAY), with_board(stall=StallVerdict.STUCK),
        "No headway: current as fast as the boat", "making way again", RTL, 0.0, 10.0, ((60.0, LOITER),),
        modes=AUTONOMOUS, spared=set(), relapse_s=60.0,
    ),
    Condition.OPERATOR_LOST: Scenario(
        given(operator_silent_s=5.1), given(operator_silent_s=4.9),
        "Operator lost for 5 s", "operator heard again",
        LOITER, 0.0, 1.0, (LONG,), is_watched_disarmed=True,
    ),
    Condition.PLANNER_LOST: Scenario(
        given(planner_silent_s=5.1), given(planner_silent_s=4.9),
        "Planner lost for 5 s", "planner heard again",
        LOITER, 0.0, 1.0, (LONG,),
    ),
    Condition.HELM_LOST: Scenario(
        given(sticks_dropped=True), given(sticks_dropped=True, radio_heard=True),
        "RC lost: no stick input", "stick input again", LOITER, 1.5, 1.0, (LONG,),
    ),
    Condition.RC_LOST: Scenario(
        given(radio_heard=True, radio_fault="silent"),
        given(radio_heard=True, radio_fault="silent", has_station_sticks=True),
        "RC lost: silent", "transmitter heard again", LOITER, 1.5, 1.0, (LONG,),
    ),
    Condition.GNSS_BAD: Scenario(
        with_nav(faults=int(EstimateFault.GNSS_FROZEN)), with_nav(faults=int(EstimateFault.COMPASS_OFF)),
        "GPS frozen: dead reckoning", "GPS good again", NONE, 0.0, 3.0, modes=BY_POSITION,
    ),
    Condition.COMPASS_BAD: Scenario(
        with_nav(faults=int(EstimateFault.COMPASS_OFF)), with_nav(faults=int(EstimateFault.GNSS_FROZEN)),
        "Compass off: using gyro and course", "compass good again", NONE, 0.0, 3.0, modes=BY_POSITION,
    ),
    Condition.GYRO_BAD: Scenario(
        with_nav(faults=int(EstimateFault.GYRO_LOST)), with_nav(faults=int(EstimateFault.COMPASS_LATE)),
        "Gyro lost: using yaw model", "gyro good again", NONE, 0.0, 3.0, modes=BY_POSITION,
    ),
    Condition.SONAR_LOST: Scenario(
        with_board(has_lost_sonar=True), with_board(), "Sonar lost for 3 s", "ranger pings again",
        NONE, 0.0, 3.0, modes=AUTONOMOUS,
    ),
    Condition.OVERRUN: Scenario(
        with_board(load=1.01), with_board(load=0.99), "Computer overloaded: load 101 %",
        "computer load normal again", LOITER, 3.0, 10.0,
    ),
    Condition.STORAGE_FAILED: Scenario(
        with_board(storage_fault="disk full"), given(), "Storage failed: disk full", "storage works again",
        NONE, 0.0, 10.0, is_watched_disarmed=True,
    ),
    Condition.FENCE_BREACHED: Scenario(
        given(beyond_fence_m=0.1), given(), "Outside the fence by 0.1 m", "inside the fence again",
        RTL, 0.5, 2.0,
        waiting=(with_board(held_s=2.1), given(recovery=State.RESTING), given(recovery=State.STANDING_OFF)),
        ready=(
            with_board(held_s=1.9), given(recovery=State.CHECKING),
            given(recovery=State.PUSHING, beyond_fence_m=2.1),
        ),
    ),
}  # fmt: skip
