"""Thrust allocation: effort to thrust, thrust to the command of each motor."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.config.actuators import Thrusters
from companion.control.allocation import (
    FAINT,
    from_pwm,
    motor_pwm,
    pair_thrust,
    to_pwm,
)
from companion.core.state import HEALTHY_MOTORS, MotorCommand, MotorState, MotorStates

FAILED, REVERSED = MotorState.FAILED, MotorState.REVERSED
SHARES = st.floats(-1.0, 1.0)
BANDS = st.floats(0.0, 0.6)
GAINS = st.floats(0.2, 1.0)
ASYMMETRIES = st.floats(1.0, 10.0)
STATES = st.builds(MotorStates, st.sampled_from(MotorState), st.sampled_from(MotorState))


@pytest.mark.parametrize(
    ("surge", "yaw", "left", "right"),
    [
        (0.0, 0.0, 0.0, 0.0),
        (0.5, 0.0, 0.5, 0.5),
        (0.5, 0.2, 0.7, 0.3),
        (0.0, -0.4, -0.4, 0.4),
        (1.0, 0.3, 1.0, 0.4),  # surge is reduced, the difference stays 2 × 0.3
        (-1.0, 0.3, -0.4, -1.0),
        (0.8, 1.0, 1.0, -1.0),
        (2.0, -3.0, -1.0, 1.0),
    ],
)
def test_healthy_motors_are_mixed_as_in_a_table(surge: float, yaw: float, left: float, right: float) -> None:
    thrust = pair_thrust(surge, yaw)
    assert (thrust.left, thrust.right) == pytest.approx((left, right))


@given(SHARES, SHARES)
def test_yaw_is_kept_and_nothing_saturates(surge: float, yaw: float) -> None:
    thrust = pair_thrust(surge, yaw)
    assert thrust.left - thrust.right == pytest.approx(2.0 * yaw, abs=1e-12)
    assert max(abs(thrust.left), abs(thrust.right)) <= 1.0 + 1e-12
    mean = 0.5 * (thrust.left + thrust.right)
    assert abs(mean) <= abs(surge) + 1e-12
    assert mean * surge >= 0.0 or abs(mean) < 1e-12


@given(st.floats(-0.5, 0.5), st.floats(-0.5, 0.5), STATES)
def test_unsaturated_thrust_is_the_pseudo_inverse_of_the_motors_that_work(
    surge: float, yaw: float, motors: MotorStates
) -> None:
    works = [motors.left is not FAILED, motors.right is not FAILED]
    effect = 0.5 * np.array([[1.0, 1.0], [1.0, -1.0]]) * works
    thrust = pair_thrust(surge, yaw, motors)
    assert [thrust.left, thrust.right] == pytest.approx(
        np.linalg.pinv(effect) @ np.array([surge, yaw]), abs=1e-12
    )


@pytest.mark.parametrize(("surge", "yaw"), [(math.nan, 0.0), (0.0, math.nan)])
def test_nan_reaches_the_gate(surge: float, yaw: float) -> None:
    thrust = pair_thrust(surge, yaw)
    assert math.isnan(thrust.left)
    assert math.isnan(thrust.right)


def test_each_side_has_its_own_dead_band_ahead_and_astern() -> None:
    setting = Thrusters(left_ahead=0.1, left_astern=0.2, right_ahead=0.3, right_astern=0.4, asymmetry=1.25)
    assert motor_pwm(MotorCommand(0.4, 0.4), HEALTHY_MOTORS, setting) == pytest.approx((0.46, 0.58))
    assert motor_pwm(MotorCommand(-0.4, -0.4), HEALTHY_MOTORS, setting) == pytest.approx((-0.6, -0.7))


def test_a_reversed_motor_gets_the_opposite_command_and_the_other_motor_its_own() -> None:
    command = MotorCommand(0.5, -0.3)
    assert motor_pwm(command, MotorStates(left=REVERSED), Thrusters()) == (-0.5, -0.3)
    assert motor_pwm(command, MotorStates(right=REVERSED), Thrusters()) == (0.5, 0.3)


def test_a_reversed_motor_has_the_dead_band_of_its_command_and_the_asymmetry_of_its_thrust() -> None:
    setting = Thrusters(left_ahead=0.1, left_astern=0.2, right_ahead=0.3, right_astern=0.4, asymmetry=1.25)
    both = MotorStates(REVERSED, REVERSED)
    # Ahead: the bands of negative commands, 0.2 + 0.8 × 0.4 and 0.4 + 0.6 × 0.4, the share as it is
    assert motor_pwm(MotorCommand(0.4, 0.4), both, setting) == pytest.approx((-0.52, -0.64))
    # Astern: the bands of positive commands, 0.1 + 0.9 × 0.5 and 0.3 + 0.7 × 0.5, the share enlarged
    assert motor_pwm(MotorCommand(-0.4, -0.4), both, setting) == pytest.approx((0.55, 0.65))


@given(SHARES, BANDS, BANDS, GAINS, ASYMMETRIES)
def test_a_command_has_the_sign_of_its_thrust_and_is_never_beyond_full(
    share: float, ahead: float, astern: float, gain: float, asymmetry: float
) -> None:
    pwm = to_pwm(share, ahead, astern, gain, asymmetry)
    assert pwm * share >= 0.0
    assert abs(pwm) <= 1.0 + 1e-12


@given(SHARES, SHARES, BANDS, BANDS, GAINS, ASYMMETRIES)
def test_more_thrust_never_takes_less_command(
    one: float, other: float, ahead: float, astern: float, gain: float, asymmetry: float
) -> None:
    less, more = sorted((one, other))
    lower, upper = (to_pwm(share, ahead, astern, gain, asymmetry) for share in (less, more))
    assert lower <= upper + 1e-12


@given(st.floats(FAINT, 1.0), BANDS, GAINS)
def test_the_share_is_recovered_from_the_command(share: float, band: float, gain: float) -> None:
    assert from_pwm(to_pwm(share, band, 0.0, gain, 1.0), band, gain) == pytest.approx(share, abs=1e-9)


def test_a_faint_share_gets_a_proportional_part_of_the_dead_band() -> None:
    # A quarter of FAINT: a quarter of the band of 0.4 is 0.1, and 0.9 of the share on top
    assert to_pwm(0.0025, 0.4, 0.0, 1.0, 1.0) == pytest.approx(0.1 + 0.9 * 0.0025)
    assert to_pwm(-0.0025, 0.0, 0.4, 1.0, 1.0) == pytest.approx(-0.1 - 0.9 * 0.0025)
    assert to_pwm(0.01, 0.4, 0.0, 1.0, 1.0) == pytest.approx(0.406)
