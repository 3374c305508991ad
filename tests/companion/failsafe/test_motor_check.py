"""Checking the motors one by one."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.core.intent import Drive, Stop
from companion.core.state import HEALTHY_MOTORS, MotorState, MotorStates
from companion.failsafe.recovery.motor_check import MotorCheck

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


def test_a_hull_that_is_turned_by_what_it_touches_teaches_nothing() -> None:
    check = MotorCheck()
    tried(check, 1.0, 1.0, is_aground=True)
    assert check.motors == HEALTHY_MOTORS
    assert check.is_unclear


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


def test_a_reversed_motor_that_answers_as_it_is_driven_stays_turned_round() -> None:
    check = MotorCheck()
    tried(check, 1.0, -1.0)
    tried(check, 1.0, 1.0)  # as it is driven now
    assert check.motors == states(1, -1)
    tried(check, 1.0, -1.0)  # the wires are right again
    assert check.motors == HEALTHY_MOTORS


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
