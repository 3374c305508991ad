"""Each row of the table does what its scenario says."""

import math
from collections.abc import Sequence
from itertools import accumulate

import pytest
from boat_rig import nav_at
from failsafe_scenarios import (
    SCENARIOS,
    Inputs,
    Scenario,
    both,
    given,
    with_board,
    with_depth,
)

from companion.config.boat_config import BoatConfig, with_value
from companion.core.modes import Mode
from companion.core.status_text import Severity
from companion.failsafe.actions import RECOVERIES, Action, LimitSpeed, Notify, Recover, Retreat, StopMotors
from companion.failsafe.inputs import FailsafeInputs
from companion.failsafe.monitor import PERIOD_S, Alarm, Change, Failsafes
from companion.failsafe.response import respond
from companion.failsafe.table import ROWS, Condition, Row
from companion.geofence.fence import Fence
from companion.rc.manual_input import ManualInput

CONFIG = BoatConfig()
INDEPENDENT = {
    *(
        Condition.LEAK,
        Condition.TOO_HOT,
        Condition.OPERATOR_LOST,
        Condition.PLANNER_LOST,
        Condition.HELM_LOST,
    ),
    *(Condition.RC_LOST, Condition.OVERRUN, Condition.STORAGE_FAILED),
}  # of everything that may be behind an autopilot


class Run:
    """One row, cycle by cycle."""

    def __init__(self, condition: Condition, rows: Sequence[Row], config: BoatConfig) -> None:
        self.config = config
        self.now_s = 0.0
        self.mode, self.armed = Mode.GUIDED, True
        self.seen: list[tuple[float, Alarm]] = []
        self.latest = self._inputs(given())
        rows = [row for row in rows if row.condition is condition]
        self.failsafes = Failsafes(config, ManualInput(), rows)

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
            seen += [(self.now_s - began_s, alarm) for alarm in self.failsafes.update(self.latest)]
            self.now_s = round(self.now_s + PERIOD_S, 6)
        return seen


def check(condition: Condition, rows: Sequence[Row] = ROWS, config: BoatConfig = CONFIG) -> None:
    """Run the scenario against a table."""
    one = SCENARIOS[condition]
    assert [row.condition for row in rows].count(condition) == 1
    run = Run(condition, rows, config)
    run.armed = False
    assert bool(run.live(one.wrong, one.after_s + 1.0)) is one.is_watched_disarmed
    for mode in Mode:
        check_mode(condition, one, mode, rows, config)
    check_waits(condition, one, rows, config)
    check_suspended(condition, one, rows, config)
    check_times(condition, one, rows, config)
    check_relapse(condition, one, rows, config)


def check_waits(condition: Condition, one: Scenario, rows: Sequence[Row], config: BoatConfig) -> None:
    for waiting in one.waiting:
        run = Run(condition, rows, config)
        assert run.live(both(one.wrong, waiting), 60.0) == []
        assert len(run.live(one.wrong, one.after_s + 0.2)) == 1
        assert run.live(both(one.wrong, waiting), 60.0) == [], "a row that fired goes on"
    for ready in one.ready:
        assert len(Run(condition, rows, config).live(both(one.wrong, ready), 1.0)) == 1


def check_suspended(condition: Condition, one: Scenario, rows: Sequence[Row], config: BoatConfig) -> None:
    """While the outputs are away, and after."""
    run = Run(condition, rows, config)
    run.failsafes.suspend(100.0)
    seen = run.live(one.wrong, 100.0)
    assert bool(seen) is (condition in INDEPENDENT)
    if not seen:
        assert len(run.live(one.wrong, one.after_s + 0.2)) == 1


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
    ends = [] if one.clear_s == math.inf else [(one.clear_s, Change.ENDS, one.over)]
    assert [(round(at_s, 1), *alarm[1:3]) for at_s, alarm in ended] == ends


def check_relapse(condition: Condition, one: Scenario, rows: Sequence[Row], config: BoatConfig) -> None:
    """A condition that comes back soon takes the next step; later, or after the last, the first."""
    every_step = [(0.0, one.action), *one.then]
    for gap_s in (one.relapse_s - 0.5, one.relapse_s + 0.5):
        for taken in range(len(one.then) + 1):
            if one.clear_s == math.inf or gap_s < 0.0 or not one.then:
                continue
            run = Run(condition, rows, config)
            run.live(one.wrong, one.after_s + sum(wait_s for wait_s, _ in every_step[: taken + 1]) + 0.2)
            run.live(one.right, one.clear_s + gap_s)
            actions = [alarm.action for _, alarm in run.live(one.wrong, one.after_s + 16.0)]
            goes_on = gap_s < one.relapse_s and taken < len(one.then)
            first, *more = every_step[taken + 1 :] if goes_on else every_step
            assert actions == [first[1], *(action for wait_s, action in more[:1] if wait_s < 16.0)]


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
    seen = run.live(one.wrong, one.after_s + 0.2)
    assert len(seen) == 1
    alarm = seen[0][1]
    is_concerned = mode in one.modes
    assert alarm.action is (action if is_concerned else Action.NONE)
    told, *decisions = respond(alarm, run.latest)
    assert told == Notify(Severity.CRITICAL if is_concerned else Severity.WARNING, f"Failsafe: {one.text}")
    if action is Action.DISARM:
        assert decisions == [StopMotors()]
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


@pytest.mark.parametrize("condition", Condition, ids=lambda one: one.name)
def test_the_row_does_what_its_scenario_says(condition: Condition) -> None:
    check(condition)


@pytest.mark.parametrize(
    "reading", [with_depth(None), with_board(was_deep=True), with_depth(0.5, was_deep=False)]
)
def test_no_bottom_a_silent_sounder_and_the_start_from_a_beach_are_no_shallow_water(reading: Inputs) -> None:
    assert Run(Condition.SHALLOW, ROWS, CONFIG).live(reading, 20.0) == []


def test_every_condition_has_one_row_and_one_scenario() -> None:
    assert sorted(row.condition for row in ROWS) == sorted(Condition) == sorted(SCENARIOS)
