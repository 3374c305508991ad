"""Every failsafe in one table: what is watched, for how long, what is done, and what comes after that.

A row fires once when its watch has had something to say for `after` seconds without a break. If the trouble
lasts, the steps of `then` follow, each so long after the one before, unless the operator has chosen a mode
since: then it stands. After `clear_s` seconds without trouble the row is over; the boat stays in the mode it
is in, and the operator says what next. Strings name fields of `settings/failsafe.py`.
"""

from collections.abc import Callable
from enum import IntFlag
from typing import NamedTuple

from companion.failsafe import boundary, estimate, hull, power, propulsion, stations
from companion.failsafe.actions import Action
from companion.failsafe.inputs import FailsafeInputs

_NEVER = float("inf")


class Condition(IntFlag):
    """One bit each, as `Failsafes.active` has them."""

    CAPSIZED = 1 << 0
    HEADING_LOST = 1 << 1
    POSITION_LOST = 1 << 2
    LEAK = 1 << 3
    TOO_HOT = 1 << 4
    BATTERY_CRITICAL = 1 << 5
    BATTERY_LOW = 1 << 6
    OUT_OF_RANGE = 1 << 7
    MOTOR_FAILING = 1 << 8
    STUCK = 1 << 9
    NO_HEADWAY = 1 << 10
    OPERATOR_LOST = 1 << 11
    PLANNER_LOST = 1 << 12
    HELM_LOST = 1 << 13
    GNSS_BAD = 1 << 14
    COMPASS_BAD = 1 << 15
    SONAR_LOST = 1 << 16
    OVERRUN = 1 << 17
    STORAGE_FAILED = 1 << 18
    FENCE_BREACHED = 1 << 19
    STEERING_LOST = 1 << 20
    RC_LOST = 1 << 21
    AGROUND = 1 << 22


class Concerns(IntFlag):
    """The modes in which something is done about it; it is told in all."""

    ALL = 0
    STEERED_BY_POSITION = 1  # not MANUAL, which the operator may always choose
    NOT_BY_HAND = 2


class Step(NamedTuple):
    """The next rung: so long after the one before, this."""

    after: float | str
    action: Action | str


class Row(NamedTuple):
    """One failsafe.

    over: what is told when it is over. is_watched_disarmed: else only an armed boat is watched.
    spares_way_home: a boat under way home goes on. limps: it goes home slowly. relapse_s: trouble that comes
    back so soon after it was over goes on with the next step.
    """

    condition: Condition
    watch: Callable[[FailsafeInputs], str]
    action: str
    over: str
    after: float | str = 0.0
    then: tuple[Step, ...] = ()
    clear_s: float = 1.0
    concerns: Concerns = Concerns.ALL
    is_watched_disarmed: bool = False
    spares_way_home: bool = True
    limps: bool = False
    relapse_s: float = 0.0


_LONG = Step("long_timeout_s", "long_action")
_CLEAR_AGAIN = Step(18.0, Action.CLEAR_PROPELLERS)
_TRY = Step(15.0, Action.TRY_MOTORS)
_LIMP_HOME = Step(15.0, Action.RTL)
_GIVE_UP = Step(90.0, Action.LOITER_OR_HOLD)

ROWS: tuple[Row, ...] = (
    Row(
        Condition.CAPSIZED, propulsion.capsized, "capsize_action", "upright again",
        after=2.0, clear_s=5.0, spares_way_home=False,
    ),
    Row(
        Condition.HEADING_LOST, estimate.heading_lost, "heading_action", "heading known again",
        concerns=Concerns.STEERED_BY_POSITION, spares_way_home=False,
    ),
    Row(
        Condition.POSITION_LOST, estimate.position_lost, "position_action", "position known again",
        after=0.5, then=(Step("dead_reckoning_s", Action.HOLD),),
        clear_s=2.0, concerns=Concerns.STEERED_BY_POSITION, spares_way_home=False,
    ),
    Row(
        Condition.LEAK, hull.leak, "leak_action", "hull dry again",
        after=2.0, clear_s=10.0,
    ),
    Row(
        Condition.TOO_HOT, hull.too_hot, "temperature_action", "cool again",
        after=10.0, clear_s=30.0,
    ),
    Row(
        Condition.BATTERY_CRITICAL, power.battery_critical, "battery_critical_action", "",
        after="battery_low_s", clear_s=_NEVER, is_watched_disarmed=True,
    ),
    Row(
        Condition.BATTERY_LOW, power.battery_low, "battery_action", "",
        after="battery_low_s", clear_s=_NEVER, is_watched_disarmed=True,
    ),
    Row(
        Condition.OUT_OF_RANGE, power.out_of_range, "range_action", "",
        after=5.0, clear_s=_NEVER,
    ),
    Row(
        Condition.STEERING_LOST, propulsion.steering_lost, "steering_action", "steering turns the boat again",
        then=(_TRY, Step(15.0, Action.LOITER_OR_HOLD)), clear_s=10.0, relapse_s=60.0,
        concerns=Concerns.NOT_BY_HAND, spares_way_home=False,
    ),
    Row(
        Condition.MOTOR_FAILING, propulsion.motor_failing, "motor_action", "motors pull again",
        then=(_CLEAR_AGAIN, _LIMP_HOME, _GIVE_UP), clear_s=15.0, relapse_s=60.0,
        concerns=Concerns.NOT_BY_HAND, spares_way_home=False, limps=True,
    ),
    Row(
        Condition.AGROUND, propulsion.aground, "aground_action", "afloat again",
        clear_s=2.0, concerns=Concerns.NOT_BY_HAND, spares_way_home=False,
    ),
    Row(
        Condition.STUCK, propulsion.stuck, "stuck_action", "free again",
        then=(_CLEAR_AGAIN, _LIMP_HOME, _GIVE_UP), clear_s=15.0, relapse_s=60.0,
        concerns=Concerns.NOT_BY_HAND, spares_way_home=False, limps=True,
    ),
    Row(
        Condition.NO_HEADWAY, propulsion.no_headway, "headway_action", "making way again",
        then=(Step(60.0, Action.LOITER_OR_HOLD),), clear_s=10.0, relapse_s=60.0,
        concerns=Concerns.NOT_BY_HAND, spares_way_home=False,
    ),
    Row(
        Condition.OPERATOR_LOST, stations.operator_lost, "action", "operator heard again",
        then=(_LONG,), is_watched_disarmed=True,
    ),
    Row(
        Condition.PLANNER_LOST, stations.planner_lost, "planner_action", "planner heard again",
        then=(_LONG,),
    ),
    Row(
        Condition.HELM_LOST, stations.helm_lost, "action", "sticks held again",
        after="rc_timeout_s", then=(_LONG,),
    ),
    Row(
        Condition.RC_LOST, stations.rc_lost, "action", "transmitter heard again",
        after="rc_timeout_s", then=(_LONG,),
    ),
    Row(
        Condition.GNSS_BAD, estimate.gnss_bad, "gnss_action", "GPS good again",
        clear_s=3.0, concerns=Concerns.STEERED_BY_POSITION,
    ),
    Row(
        Condition.COMPASS_BAD, estimate.compass_bad, "compass_action", "compass good again",
        clear_s=3.0, concerns=Concerns.STEERED_BY_POSITION,
    ),
    Row(
        Condition.SONAR_LOST, hull.sonar_lost, "sonar_action", "sonar pings again",
        clear_s=3.0, concerns=Concerns.NOT_BY_HAND,
    ),
    Row(
        Condition.OVERRUN, hull.overrun, "overrun_action", "computer keeps up again",
        after=3.0, clear_s=10.0,
    ),
    Row(
        Condition.STORAGE_FAILED, hull.storage_failed, "storage_action", "written again",
        clear_s=10.0, is_watched_disarmed=True,
    ),
    Row(
        Condition.FENCE_BREACHED, boundary.fence_breached, "fence_action", "inside the fence again",
        after=0.5, clear_s=2.0,
    ),
)  # fmt: skip
"""The gravest first: where two fire at once, the first has its way unless the second asks for more."""
