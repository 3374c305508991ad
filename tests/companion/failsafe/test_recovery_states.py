"""Every state of a recovery, and what every trigger makes of it."""

import pytest
from boat_rig import nav_at

from companion.config.boat_config import BoatConfig
from companion.core.intent import Drive, Intent, Stop
from companion.failsafe.actions import UNGROUNDING, State, Trigger
from companion.failsafe.recovery.recovery import RecoveryManeuvers
from companion.geofence.fence import Fence

CONFIG = BoatConfig()


def recovery_in(state: State) -> RecoveryManeuvers:
    recovery = RecoveryManeuvers()
    way = {
        State.IDLE: (),
        State.CLEARING: (Trigger.CLEAR,),
        State.CHECKING: (Trigger.CHECK,),
        State.COMPARING: (Trigger.COMPARE,),
        State.RESTING: (Trigger.UNGROUND,),
        State.PUSHING: (Trigger.UNGROUND, Trigger.RESTED),
        State.STANDING_OFF: (Trigger.UNGROUND, Trigger.FREED),
    }
    for trigger in way[state]:
        assert recovery.handle(trigger, 0.0)
    assert recovery.state is state
    return recovery


@pytest.mark.parametrize("state", State)
def test_what_steers_in_each_state(state: State) -> None:
    recovery = recovery_in(state)
    assert recovery.is_active is (state is not State.IDLE)
    assert recovery.is_ungrounding is (state in UNGROUNDING)
    assert recovery.is_checking is (state is State.CHECKING)
    assert recovery.hides_motors is (state not in (State.IDLE, State.COMPARING))
    assert recovery.handle(Trigger.RETREAT, 1.0) is (recovery.state is not state)


def intents(recovery: RecoveryManeuvers, seconds: float) -> list[Intent]:
    """What it drives at each tenth of a second, until it ends."""
    driven: list[Intent] = []
    for tick in range(round(seconds * 10)):
        if not recovery.is_active:
            break
        driven.append(recovery.update(nav_at(), Fence(), CONFIG, 0.0, 0.0, tick * 0.1).intent)
    return driven


@pytest.mark.parametrize("is_left_first", [True, False])
def test_a_comparison_drives_one_motor_alone_and_then_the_other(is_left_first: bool) -> None:
    recovery = recovery_in(State.COMPARING)
    recovery.is_left_first = is_left_first
    driven = intents(recovery, 10.0)
    sides = [intent.steering > 0.0 for intent in driven if isinstance(intent, Drive)]
    assert sides[:24] == 12 * [is_left_first] + 12 * [not is_left_first]
    assert len(driven) == len(sides) == 25
    assert all(
        isinstance(intent, Drive) and intent.throttle == abs(intent.steering) == 0.45 for intent in driven
    )
    assert recovery.state is State.IDLE


def test_clearing_stops_pulses_astern_three_times_and_drifts() -> None:
    driven = intents(recovery_in(State.CLEARING), 60.0)
    astern = [isinstance(intent, Drive) for intent in driven]
    begins = [at for at in range(1, len(astern)) if astern[at] and not astern[at - 1]]
    assert begins == [15, 31, 47]
    assert sum(astern) == 30
    assert all(intent == Drive(-1.0, 0.0) for intent in driven if isinstance(intent, Drive))
    assert len(driven) == 84
    assert driven[-1] == Stop()


@pytest.mark.parametrize("is_left", [True, False])
def test_a_failed_motor_is_checked_once_the_propellers_are_clear(is_left: bool) -> None:
    recovery = recovery_in(State.CLEARING)
    recovery.motor_check.assume_failed(is_left, 0.0)
    recovery.update(nav_at(), Fence(), CONFIG, 0.0, 0.0, 8.4)
    assert recovery.state is State.CHECKING


def test_a_check_ends_with_its_result_and_disarming_forgets_it() -> None:
    recovery = recovery_in(State.CHECKING)
    recovery.motor_check.assume_failed(True, 0.0)
    step = recovery.update(nav_at(), Fence(), CONFIG, 0.0, 0.0, 6.1)
    assert (recovery.state, step.cleared) == (State.IDLE, False)
    assert step.text == recovery.motor_check.found()
    recovery.reset()
    assert not recovery.motor_check.motors.has_failed


def test_without_an_estimate_a_check_breaks_off_and_says_nothing() -> None:
    recovery = recovery_in(State.CHECKING)
    step = recovery.update(None, Fence(), CONFIG, 0.0, 0.0, 1.0)
    assert (recovery.state, step) == (State.IDLE, (Stop(), "", None))


def test_a_check_drives_each_motor_alone_ahead_and_astern_and_lasts_six_seconds() -> None:
    recovery = RecoveryManeuvers()
    recovery.handle(Trigger.CHECK, 5.0)
    driven: list[Intent] = []
    while recovery.is_active:
        driven.append(recovery.update(nav_at(), Fence(), CONFIG, 0.0, 0.0, 5.0 + 0.1 * len(driven)).intent)
    left, right = Drive(0.45, 0.45), Drive(0.45, -0.45)
    back_left, back_right = Drive(-0.45, -0.45), Drive(-0.45, 0.45)
    pulses = [left] * 10 + [back_left] * 10 + [Stop()] * 5 + [right] * 10 + [back_right] * 10
    assert driven == [Stop()] * 15 + pulses + [Stop()]
