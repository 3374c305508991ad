"""Every state of a recovery, and what every trigger makes of it."""

import math

import pytest
from boat_rig import nav_at
from hypothesis import given
from hypothesis import strategies as st

from companion.config.boat_config import BoatConfig
from companion.core.intent import Drive, Intent, Stop
from companion.core.state import MotorState, MotorStates
from companion.failsafe.actions import UNGROUNDING, State, Trigger
from companion.failsafe.recovery.motor_check import MotorCheck
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


WORDS = {1: MotorState.HEALTHY, 0: MotorState.FAILED, -1: MotorState.REVERSED}


def states(left: int, right: int) -> MotorStates:
    """1 pulls, 0 does not, −1 pulls the wrong way."""
    return MotorStates(WORDS[left], WORDS[right])


def tried(
    check: MotorCheck,
    left: float,
    right: float,
    wind_rad_s2: float = 0.0,
    *,
    damping_s: float = 1.0,
    held_back: float = 0.0,
    is_aground: bool = False,
) -> None:
    """A hull whose motors turn it by so much at full drive, rad/s², while wind turns it too.

    held_back: of the throttle, by whoever else has a say. is_aground: what it touches turns it as it likes.
    """
    check.begin(10.0)
    now_s, rate, a, b = 10.0, 0.1, 0.0, 0.0
    for tick in range(1000):
        intent = check.update(rate, a, b, now_s)
        if intent is None:
            return
        a, b = 0.0, 0.0
        if isinstance(intent, Drive):
            a, b = intent.throttle + intent.steering, intent.throttle - intent.steering
            assert min(abs(a), abs(b)) < 1e-9, "one at a time"
            a, b = a + held_back, b + held_back
        else:
            assert isinstance(intent, Stop)
        rate += 0.02 * (left * a * abs(a) - right * b * abs(b) + wind_rad_s2 - rate / damping_s)
        if is_aground:
            rate = 0.3 * math.sin(1.7 * tick)
        now_s += 0.02
    raise AssertionError("it does not end")


@pytest.mark.parametrize("wind", [-0.05, 0.05])
@pytest.mark.parametrize("left", [1, 0, -1])
@pytest.mark.parametrize("right", [1, -1])
def test_each_motor_is_known_by_the_turn_that_it_makes(left: int, right: int, wind: float) -> None:
    check = MotorCheck()
    tried(check, 1.0 * left, 1.0 * right, wind)
    assert check.motors == states(left, right)
    assert check.motors.has_failed is (left == 0)
    assert bool(check.fault()) is check.motors.has_failed


@given(st.floats(0.2, 3.0), st.floats(-0.1, 0.1), st.sampled_from([1, 0, -1]))
def test_neither_swing_nor_wind_hides_a_dead_motor(damping_s: float, wind: float, left: int) -> None:
    check = MotorCheck()
    tried(check, 1.0 * left, 1.0, wind, damping_s=damping_s)
    assert check.motors == states(left, 1)


def test_a_motor_presumed_dead_is_tried_soon() -> None:
    check = MotorCheck()
    check.assume_failed(is_left=True, now_s=100.0)
    assert check.motors == states(0, 1)
    assert check.fault() == "Left motor gives no thrust"
    assert not check.is_due(124.0, has_room=True)
    assert check.is_due(126.0, has_room=True)
    assert not check.is_due(159.0, has_room=False)
    assert check.is_due(161.0, has_room=False)


def test_one_that_stays_dead_is_tried_ever_more_seldom_and_never_twice_in_a_hurry() -> None:
    check = MotorCheck()
    for wait_s in (25.0, 50.0, 100.0, 120.0, 120.0):
        tried(check, 0.0, 1.0)  # begins at 10 s
        assert not check.is_due(9.0 + wait_s, has_room=True)
        assert check.is_due(11.0 + wait_s, has_room=True)
        assert not check.is_due(69.0, has_room=False)
        assert check.is_due(71.0, has_room=False)
    tried(check, 1.0, 1.0)
    assert not check.motors.has_failed
    tried(check, 0.0, 1.0)
    assert check.is_due(36.0, has_room=True)


@pytest.mark.parametrize(("weaker", "state"), [(0.11, 1), (0.06, 0)])
@pytest.mark.parametrize("is_left", [True, False])
def test_a_motor_with_less_than_a_fifth_of_the_others_thrust_counts_as_failed(
    is_left: bool, weaker: float, state: int
) -> None:
    check = MotorCheck()
    tried(check, *((weaker, 0.4) if is_left else (0.4, weaker)))
    assert check.motors == (states(state, 1) if is_left else states(1, state))


@pytest.mark.parametrize(("gain", "is_unclear"), [(0.04, True), (0.06, False)])
def test_a_hull_that_hardly_turns_gives_no_clear_result(gain: float, is_unclear: bool) -> None:
    check = MotorCheck()
    tried(check, gain, gain)
    assert check.is_unclear is is_unclear


@pytest.mark.parametrize(
    ("right", "text"), [(0.55, "is weak"), (0.65, "works"), (-0.5, "is reversed: compensated")]
)
def test_a_weak_motor_is_called_weak(right: float, text: str) -> None:
    check = MotorCheck()
    tried(check, 1.0, right)
    assert check.found() == f"Left motor works, right {text}"
    tried(check, 1.0, 1.0)
    assert check.found() == "Left motor works, right works" or right < 0.0
