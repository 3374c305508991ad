"""A scenario for each row of the failsafe table, with the numbers of the failsafes page as literals.

`check` runs a scenario against a table and a configuration.
"""

import math
from collections.abc import Callable, Sequence
from itertools import accumulate
from typing import NamedTuple

import pytest
from boat_rig import nav_at
from msgspec.structs import replace

from companion.config.boat_config import BoatConfig, with_value
from companion.core.modes import Mode
from companion.core.state import EstimateFault
from companion.core.status_text import Severity
from companion.failsafe.actions import RECOVERIES, Action, Disarm, LimitSpeed, Notify, Recover, Retreat
from companion.failsafe.escalation import Change
from companion.failsafe.inputs import FailsafeInputs
from companion.failsafe.monitor import PERIOD_S, Alarm, Failsafes
from companion.failsafe.motors.hypotheses import HYPOTHESES, Fault
from companion.failsafe.response import respond
from companion.failsafe.table import ROWS, Condition, Row
from companion.geofence.fence import Fence
from companion.guidance.stall_detector import StallVerdict
from companion.rc.manual_input import ManualInput
from companion.sensors.readings import BatteryReading, HeadingReading, HullReading

INF = math.inf
ALL = set(Mode)
BY_POSITION = ALL - {Mode.MANUAL, Mode.HOLD}
AUTONOMOUS = ALL - {Mode.MANUAL, Mode.ACRO, Mode.STEERING, Mode.SIMPLE}
WAYS_HOME = {Mode.RTL, Mode.SMART_RTL}
CONFIG = BoatConfig()

Inputs = Callable[[FailsafeInputs], FailsafeInputs]


class Scenario(NamedTuple):
    """wrong: inputs just beyond the row's threshold; right: just within. then: seconds after the step before,
    and the action. modes: those in which it acts. spared: those in which a retreat is left out. thresholds:
    the parameters that wrong and right lie close to.
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
    thresholds: tuple[str, ...] = ()


def with_board(**readings: object) -> Inputs:
    return lambda inputs: replace(inputs, board=replace(inputs.board, **readings))


def with_roll(degrees: float) -> Inputs:
    return lambda one: with_board(heading=HeadingReading(one.now_s, 0.0, 0.0, math.radians(degrees), 0.0))(
        one
    )


def with_hull(*, age_s: float = 0.0, is_wet: bool = False, celsius: float = 20.0) -> Inputs:
    return lambda one: with_board(hull=HullReading(one.now_s - age_s, is_wet, celsius))(one)


def with_volts(volt: float) -> Inputs:
    return lambda one: replace(one, battery=BatteryReading(one.now_s, volt, 2.0))


def with_nav(**more: object) -> Inputs:
    return lambda one: replace(one, nav=replace(nav_at(), **more))


def with_verdict(fault: Fault) -> Inputs:
    verdict = next(one for one in HYPOTHESES if one.is_left and one.fault is fault)
    return lambda one: replace(one, verdict=verdict)


def with_sonar(silent_s: float) -> Inputs:
    return lambda one: with_board(sonar_s=one.now_s - silent_s)(one)


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
        Action.DISARM, 2.0, 5.0,        thresholds=("failsafe.capsize_rad",),
    ),
    Condition.HEADING_LOST: Scenario(
        with_nav(heading_age_s=3.1), with_nav(heading_age_s=2.9), "Heading lost", "heading known again",
        LOITER, 0.0, 1.0, modes=BY_POSITION, spared=set(), thresholds=("motors.estimate_timeout_s",),
    ),
    Condition.POSITION_LOST: Scenario(
        with_nav(position_age_s=3.1), with_nav(position_age_s=2.9), "Position lost", "position known again",
        LOITER, 0.5, 2.0, ((300.0, Action.HOLD),), modes=BY_POSITION, spared=set(),
        thresholds=("motors.estimate_timeout_s", "failsafe.dead_reckoning_s"),
    ),
    Condition.LEAK: Scenario(
        with_hull(age_s=4.9, is_wet=True), with_hull(age_s=5.1, is_wet=True),
        "Water in the hull", "hull dry again", RTL, 2.0, 10.0,
    ),
    Condition.TOO_HOT: Scenario(
        with_hull(age_s=4.9, celsius=86.0), with_hull(celsius=84.0), "Too hot: 86 C", "cool again",
        RTL, 10.0, 30.0,
        thresholds=("failsafe.max_temperature_c",),
    ),
    Condition.BATTERY_CRITICAL: Scenario(
        with_volts(9.58), with_volts(9.62), "Battery critical: 9.6 V", "", RTL, 10.0, INF,
        is_watched_disarmed=True, thresholds=("failsafe.battery_critical_v", "failsafe.battery_low_s"),
    ),
    Condition.BATTERY_LOW: Scenario(
        with_volts(10.18), with_volts(10.22), "Battery low: 10.2 V", "", RTL, 10.0, INF,
        is_watched_disarmed=True, thresholds=("failsafe.battery_low_v", "failsafe.battery_low_s"),
    ),
    Condition.OUT_OF_RANGE: Scenario(
        given(shortfall="Point of no return"), given(), "Point of no return", "", RTL, 5.0, INF,
    ),
    Condition.STEERING_LOST: Scenario(
        with_verdict(Fault.REVERSED), with_verdict(Fault.DEAD), "Steering lost: left motor reversed",
        "steering turns the boat again", Action.CHECK_MOTORS, 0.0, 10.0,
        ((15.0, Action.CHECK_MOTORS), (15.0, LOITER)), modes=AUTONOMOUS, spared=set(), relapse_s=60.0,
    ),
    Condition.MOTOR_FAILING: Scenario(
        with_verdict(Fault.BLOCKED), with_verdict(Fault.REVERSED),
        "Left motor is blocked", "motors pull again",
        Action.CHECK_MOTORS, 0.0, 15.0, (CLEAR_AGAIN, CLEAR_AGAIN, HOME, GIVE_UP),
        modes=AUTONOMOUS, spared=set(), relapse_s=60.0, is_slow=True, thresholds=("failsafe.clearing_tries",),
    ),
    Condition.AGROUND: Scenario(
        with_board(stall=StallVerdict.AGROUND), with_board(stall=StallVerdict.STUCK),
        "Aground: held at the shore", "afloat again", Action.UNGROUND, 0.0, 2.0,
        modes=AUTONOMOUS, spared=set(),
    ),
    Condition.STUCK: Scenario(
        with_board(stall=StallVerdict.STUCK), with_board(stall=StallVerdict.NO_HEADWAY),
        "Stuck: something holds the boat", "free again", Action.CLEAR_PROPELLERS, 0.0, 15.0,
        (CLEAR_AGAIN, HOME, GIVE_UP), modes=AUTONOMOUS, spared=set(), relapse_s=60.0, is_slow=True,
        thresholds=("failsafe.clearing_tries",),
    ),
    Condition.NO_HEADWAY: Scenario(
        with_board(stall=StallVerdict.NO_HEADWAY), with_board(stall=StallVerdict.STUCK),
        "No headway: the water is as fast as the boat", "making way again", RTL, 0.0, 10.0, ((60.0, LOITER),),
        modes=AUTONOMOUS, spared=set(), relapse_s=60.0,
    ),
    Condition.OPERATOR_LOST: Scenario(
        given(operator_silent_s=5.1), given(operator_silent_s=4.9),
        "Operator lost for 5 s", "operator heard again",
        LOITER, 0.0, 1.0, (LONG,), is_watched_disarmed=True,
        thresholds=("failsafe.gcs_timeout_s", "failsafe.long_timeout_s"),
    ),
    Condition.PLANNER_LOST: Scenario(
        given(planner_silent_s=5.1), given(planner_silent_s=4.9),
        "Planner lost for 5 s", "planner heard again",
        LOITER, 0.0, 1.0, (LONG,), thresholds=("failsafe.planner_timeout_s", "failsafe.long_timeout_s"),
    ),
    Condition.HELM_LOST: Scenario(
        given(sticks_dropped=True), given(sticks_dropped=True, radio_heard=True),
        "RC lost: nobody holds the sticks", "sticks held again", LOITER, 1.5, 1.0, (LONG,),
        thresholds=("failsafe.rc_timeout_s", "failsafe.long_timeout_s"),
    ),
    Condition.RC_LOST: Scenario(
        given(radio_heard=True, radio_fault="silent"),
        given(radio_heard=True, radio_fault="silent", has_station_sticks=True),
        "RC lost: silent", "transmitter heard again", LOITER, 1.5, 1.0, (LONG,),
        thresholds=("failsafe.rc_timeout_s", "failsafe.long_timeout_s"),
    ),
    Condition.GNSS_BAD: Scenario(
        with_nav(faults=int(EstimateFault.GNSS_FROZEN)), with_nav(faults=int(EstimateFault.COMPASS_OFF)),
        "GPS frozen: dead reckoning", "GPS good again", NONE, 0.0, 3.0, modes=BY_POSITION,
    ),
    Condition.COMPASS_BAD: Scenario(
        with_nav(faults=int(EstimateFault.COMPASS_OFF)), with_nav(faults=int(EstimateFault.GNSS_FROZEN)),
        "Compass off: gyro and course", "compass good again", NONE, 0.0, 3.0, modes=BY_POSITION,
    ),
    Condition.SONAR_LOST: Scenario(
        with_sonar(3.1), with_sonar(2.9), "Sonar lost for 3 s", "sonar pings again", NONE, 0.0, 3.0,
        modes=AUTONOMOUS, thresholds=("failsafe.sonar_timeout_s",),
    ),
    Condition.OVERRUN: Scenario(
        with_board(load=1.01), with_board(load=0.99), "Computer overloaded: 101 % of its time",
        "computer keeps up again", LOITER, 3.0, 10.0,
    ),
    Condition.STORAGE_FAILED: Scenario(
        with_board(storage_fault="disk full"), given(), "Not written: disk full", "written again",
        NONE, 0.0, 10.0, is_watched_disarmed=True,
    ),
    Condition.FENCE_BREACHED: Scenario(
        given(beyond_fence_m=0.1), given(), "Outside the fence by 0.1 m", "inside the fence again",
        RTL, 0.5, 2.0,
    ),
}  # fmt: skip


class Run:
    """One row, cycle by cycle."""

    def __init__(self, condition: Condition, rows: Sequence[Row], config: BoatConfig) -> None:
        self.config = config
        self.now_s = 0.0
        self.mode, self.armed = Mode.GUIDED, True
        self.seen: list[tuple[float, Alarm]] = []
        self.latest = self._inputs(given())
        rows = [row for row in rows if row.condition is condition]
        self._failsafes = Failsafes(config, ManualInput(), rows)

    def _inputs(self, change: Inputs) -> FailsafeInputs:
        return change(
            FailsafeInputs(
                now_s=self.now_s,
                config=self.config,
                mode=self.mode,
                armed=self.armed,
                nav=nav_at(),
                fence=Fence(),
            )
        )

    def live(self, change: Inputs, seconds: float) -> list[tuple[float, Alarm]]:
        """What happens in this time, and how long after its beginning."""
        began_s, seen = self.now_s, []
        for _ in range(round(seconds / PERIOD_S)):
            self.latest = self._inputs(change)
            seen += [(self.now_s - began_s, alarm) for alarm in self._failsafes.update(self.latest)]
            self.now_s = round(self.now_s + PERIOD_S, 6)
        return seen


def check(condition: Condition, rows: Sequence[Row] = ROWS, config: BoatConfig = CONFIG) -> None:
    """Run the scenario against a table."""
    one = SCENARIOS[condition]
    check_times(condition, one, rows, config)
    check_relapse(condition, one, rows, config)
    for mode in Mode:
        check_mode(condition, one, mode, rows, config)
    run = Run(condition, rows, config)
    run.armed = False
    assert bool(run.live(one.wrong, one.after_s + 1.0)) is one.is_watched_disarmed


def check_times(condition: Condition, one: Scenario, rows: Sequence[Row], config: BoatConfig) -> None:
    run = Run(condition, rows, config)
    assert run.live(one.right, one.after_s + 6.0) == [], "nothing fires within the threshold"
    steps = [(one.after_s, Change.FIRES, one.action)]
    steps += [(wait_s, Change.ESCALATES, action) for wait_s, action in one.then]
    seen = run.live(one.wrong, sum(wait_s for wait_s, _, _ in steps) + 200.0)
    assert [alarm[1:] for _, alarm in seen] == [(change, one.text, action) for _, change, action in steps]
    times = accumulate(wait_s for wait_s, _, _ in steps)
    assert [at_s for at_s, _ in seen] == pytest.approx(list(times), abs=0.05)
    ended = run.live(one.right, min(one.clear_s, 100.0) + 1.0)
    ends = [] if one.clear_s == INF else [(one.clear_s, Change.ENDS, one.over)]
    assert [(round(at_s, 1), *alarm[1:3]) for at_s, alarm in ended] == ends


def check_relapse(condition: Condition, one: Scenario, rows: Sequence[Row], config: BoatConfig) -> None:
    for gap_s in (one.relapse_s - 0.5, one.relapse_s + 0.5):
        if one.clear_s < INF and gap_s > 0.0 and one.then:
            run = Run(condition, rows, config)
            run.live(one.wrong, one.after_s + 0.2)
            run.live(one.right, one.clear_s + gap_s)
            actions = [alarm.action for _, alarm in run.live(one.wrong, one.after_s + 35.0)]
            steps = [(0.0, one.action), *one.then][gap_s < one.relapse_s :]
            waits = list(accumulate(wait_s for wait_s, _ in steps[1:]))
            times = zip(steps, [0.0, *waits], strict=True)
            assert actions == [action for (_, action), at_s in times if at_s < 35.0]


def check_mode(
    condition: Condition, one: Scenario, mode: Mode, rows: Sequence[Row], config: BoatConfig
) -> None:
    row = next(row for row in rows if row.condition is condition)
    action = one.action
    if action is Action.NONE:
        action = Action.RTL  # what is only told by default acts like any other where it is set to
        config = with_value(config, f"failsafe.{row.action}", int(action))
    run = Run(condition, rows, config)
    run.mode = mode
    ((_, alarm),) = run.live(one.wrong, one.after_s + 0.2)
    is_concerned = mode in one.modes
    assert alarm.action is (action if is_concerned else Action.NONE)
    told, *decisions = respond(alarm, run.latest)
    assert told == Notify(Severity.CRITICAL if is_concerned else Severity.WARNING, f"Failsafe: {one.text}")
    if action is Action.DISARM:
        assert decisions == [Disarm()]
    elif not is_concerned or mode is Mode.HOLD:
        assert decisions == []
    elif action in RECOVERIES:
        assert [decision.trigger for decision in decisions if isinstance(decision, Recover)] == [
            RECOVERIES[action][0]
        ]
    else:
        assert any(isinstance(decision, Retreat) for decision in decisions) is (mode not in one.spared)
    if one.is_slow and mode is not Mode.HOLD:
        retreat = respond(Alarm(row, Change.ESCALATES, one.text, Action.RTL), run.latest)
        assert any(isinstance(decision, LimitSpeed) for decision in retreat)
