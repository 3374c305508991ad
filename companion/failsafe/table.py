"""Every failsafe in one table: condition, delay, guard, action, escalation, and what ends it.

A row fires once when its condition has held for `after` seconds without a break. While it lasts, the steps of
`then` follow, each so long after the one before, unless the operator has chosen a mode since. The row is over
after `clear_s` seconds without the condition; the boat stays in its mode until the operator chooses another.
Strings name fields of `config/tuning.py`.
"""

from collections.abc import Callable
from enum import IntFlag
from typing import NamedTuple

from companion.core.modes import Mode
from companion.failsafe import conditions
from companion.failsafe.actions import Action
from companion.failsafe.inputs import (
    ALL_MODES,
    AUTONOMOUS_MODES,
    POSITION_MODES,
    FailsafeInputs,
    heading_in_doubt,
    held_at_shore,
    never,
    on_way_home,
    on_way_home_or_inside,
)

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
    SHALLOW = 1 << 23
    GYRO_BAD = 1 << 24


class Step(NamedTuple):
    """The next action, so long after the one before."""

    after: float | str
    action: Action | str


class Guard(NamedTuple):
    """When a row does not act.

    modes: in which something is done; it is told in all. disarmed: a disarmed boat is watched too. spares: a
    boat that does already what it would be told to do; HOLD, disarming and recoveries spare none.
    waits: while this holds, the row does not fire. is_independent: it rests on nothing that may be behind an
    autopilot, whose absence suspends the other rows.
    """

    modes: frozenset[Mode] = ALL_MODES
    disarmed: bool = False
    spares: Callable[[FailsafeInputs], bool] = on_way_home
    waits: Callable[[FailsafeInputs], bool] = never
    is_independent: bool = False


class Row(NamedTuple):
    """One failsafe.

    over: what is told at its end. relapse_s: a condition that comes back so soon goes on with the next step.
    is_slow: its retreats are at reduced speed.
    """

    condition: Condition
    watch: Callable[[FailsafeInputs], str]
    action: str
    over: str
    after: float | str = 0.0
    guard: Guard = Guard()
    then: tuple[Step, ...] = ()
    clear_s: float = 1.0
    relapse_s: float = 0.0
    is_slow: bool = False


_LONG = Step("long_timeout_s", "long_action")
# Each step gives the one before time to work, and its detector time to judge again
_CLEAR_AGAIN = Step(18.0, Action.CLEAR_PROPELLERS)  # a clearing (8.3 s), and the stall detector's 10 s
_CHECK = Step(15.0, Action.CHECK_MOTORS)  # a motor check (6 s), and 8 s for the motor watch
_GO_HOME = Step(15.0, Action.RTL)  # the same after the last clearing
_GIVE_UP = Step(90.0, Action.LOITER_OR_HOLD)  # five clearings' time without leaving the place

_ALWAYS = Guard(spares=never)
_DISARMED_TOO = Guard(disarmed=True)
_BY_POSITION = Guard(POSITION_MODES, spares=never)
_AUTONOMOUS = Guard(AUTONOMOUS_MODES, spares=never)
_INDEPENDENT = Guard(is_independent=True)

# Where the delays come from. CAPSIZED outlasts the roll in a wave of 2 s, LEAK what such a wave splashes, and
# FENCE_BREACHED and POSITION_LOST two fixes at 5 Hz. TOO_HOT and OUT_OF_RANGE see ten and five readings,
# SHALLOW two soundings at 1 Hz: a fish or a bubble does not last for two,
# OVERRUN three time constants of the averaged load. What a recovery acts on ends only once the recovery (6 to
# 8 s) is over and has been judged.
ROWS: tuple[Row, ...] = (
    Row(Condition.CAPSIZED, conditions.capsized, "capsize_action", "upright again",
        after=2.0, guard=_ALWAYS, clear_s=5.0),
    Row(Condition.HEADING_LOST, conditions.heading_lost, "heading_action", "heading known again",
        guard=_BY_POSITION),
    Row(Condition.POSITION_LOST, conditions.position_lost, "position_action", "position known again",
        after=0.5, guard=_BY_POSITION._replace(waits=heading_in_doubt),
        then=(Step("dead_reckoning_s", Action.HOLD),), clear_s=2.0),
    Row(Condition.LEAK, conditions.leak, "leak_action", "hull dry again", after=2.0,
        guard=_INDEPENDENT, clear_s=10.0),
    Row(Condition.TOO_HOT, conditions.too_hot, "temperature_action", "cool again", after=10.0,
        guard=_INDEPENDENT, clear_s=30.0),
    Row(Condition.BATTERY_CRITICAL, conditions.battery_critical, "battery_critical_action", "",
        after="battery_low_s", guard=_DISARMED_TOO, clear_s=_NEVER),
    Row(Condition.BATTERY_LOW, conditions.battery_low, "battery_action", "",
        after="battery_low_s", guard=_DISARMED_TOO, clear_s=_NEVER),
    Row(Condition.OUT_OF_RANGE, conditions.out_of_range, "range_action", "", after=5.0, clear_s=_NEVER),
    Row(Condition.STEERING_LOST, conditions.steering_lost, "steering_action", "steering works again",
        guard=_AUTONOMOUS, then=(_CHECK, Step(15.0, Action.LOITER_OR_HOLD)), clear_s=10.0, relapse_s=60.0),
    Row(Condition.MOTOR_FAILING, conditions.motor_failing, "motor_action", "motors work again",
        guard=_AUTONOMOUS, then=(_CLEAR_AGAIN, _GO_HOME, _GIVE_UP), clear_s=15.0, relapse_s=60.0,
        is_slow=True),
    Row(Condition.AGROUND, conditions.aground, "aground_action", "afloat again",
        guard=_AUTONOMOUS, clear_s=2.0),
    Row(Condition.SHALLOW, conditions.shallow, "depth_action", "deep enough again",
        after=1.5, guard=Guard(AUTONOMOUS_MODES), clear_s=5.0),
    Row(Condition.STUCK, conditions.stuck, "stuck_action", "free again",
        guard=_AUTONOMOUS, then=(_CLEAR_AGAIN, _GO_HOME, _GIVE_UP), clear_s=15.0, relapse_s=60.0,
        is_slow=True),
    Row(Condition.NO_HEADWAY, conditions.no_headway, "headway_action", "making way again",
        guard=_AUTONOMOUS, then=(Step(60.0, Action.LOITER_OR_HOLD),), clear_s=10.0, relapse_s=60.0),
    Row(Condition.OPERATOR_LOST, conditions.operator_lost, "action", "operator heard again",
        guard=_DISARMED_TOO._replace(is_independent=True), then=(_LONG,)),
    Row(Condition.PLANNER_LOST, conditions.planner_lost, "planner_action", "planner heard again",
        guard=_INDEPENDENT, then=(_LONG,)),
    Row(Condition.HELM_LOST, conditions.helm_lost, "action", "stick input again",
        after="rc_timeout_s", guard=_INDEPENDENT, then=(_LONG,)),
    Row(Condition.RC_LOST, conditions.rc_lost, "action", "transmitter heard again",
        after="rc_timeout_s", guard=_INDEPENDENT, then=(_LONG,)),
    Row(Condition.GNSS_BAD, conditions.gnss_bad, "gnss_action", "GPS good again",
        guard=Guard(POSITION_MODES), clear_s=3.0),
    Row(Condition.COMPASS_BAD, conditions.compass_bad, "compass_action", "compass good again",
        guard=Guard(POSITION_MODES), clear_s=3.0),
    Row(Condition.GYRO_BAD, conditions.gyro_bad, "compass_action", "gyro good again",
        guard=Guard(POSITION_MODES), clear_s=3.0),
    Row(Condition.SONAR_LOST, conditions.sonar_lost, "sonar_action", "ranger pings again",
        guard=Guard(AUTONOMOUS_MODES), clear_s=3.0),
    Row(Condition.OVERRUN, conditions.overrun, "overrun_action", "computer load normal again",
        after=3.0, guard=_INDEPENDENT, clear_s=10.0),
    Row(Condition.STORAGE_FAILED, conditions.storage_failed, "storage_action", "storage works again",
        guard=_DISARMED_TOO._replace(is_independent=True), clear_s=10.0),
    Row(Condition.FENCE_BREACHED, conditions.fence_breached, "fence_action", "inside the fence again",
        after=0.5, guard=Guard(spares=on_way_home_or_inside, waits=held_at_shore), clear_s=2.0),
)  # fmt: skip
"""The gravest first: of two that fire at once, the later one sees the mode that the first has chosen."""
