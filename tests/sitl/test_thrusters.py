"""The thrusters: dead band, lag, reverse, lever arm."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sitl.thrusters import Thruster, ThrusterParameters, Thrusters, steady_shaft

PAIR = ThrusterParameters(
    max_thrust_n=4.0,
    apart_m=0.3,
    deadband=0.1,
    lag_s=0.2,
    astern_share=0.6,
    resistance_share=0.45,
    full_current_a=3.0,
)
SHARE = st.floats(-1.0, 1.0)


def settled(command: float) -> Thruster:
    thruster = Thruster(PAIR)
    for _ in range(300):
        thruster.step(command, 0.02)
    return thruster


def test_a_command_inside_the_deadband_moves_nothing() -> None:
    for command in (0.0, 0.05, -0.05, 0.1, -0.1):
        assert settled(command).thrust_n == 0.0
    assert settled(0.11).thrust_n > 0.0
    assert settled(-0.11).thrust_n < 0.0


def test_full_drive_gives_the_bollard_thrust_ahead_and_less_astern() -> None:
    assert settled(1.0).thrust_n == pytest.approx(4.0)
    assert settled(-1.0).thrust_n == pytest.approx(-2.4)


@given(command=st.floats(0.1001, 1.0))
def test_the_shaft_speed_solves_the_motor_equation(command: float) -> None:
    shaft = steady_shaft(PAIR, command)
    drive = (command - 0.1) / 0.9
    assert 0.55 * shaft + 0.45 * shaft * shaft == pytest.approx(drive, rel=1e-9)
    assert steady_shaft(PAIR, -command) == -shaft


@given(one=SHARE, other=SHARE)
def test_more_command_never_gives_less_thrust(one: float, other: float) -> None:
    low, high = sorted((one, other))
    assert steady_shaft(PAIR, low) <= steady_shaft(PAIR, high)


@pytest.mark.parametrize("dt_s", [0.005, 0.02, 0.1])
def test_the_lag_is_first_order_whatever_the_step(dt_s: float) -> None:
    thruster = Thruster(PAIR)
    for _ in range(round(0.2 / dt_s)):
        thruster.step(1.0, dt_s)
    assert thruster.shaft == pytest.approx(1.0 - math.exp(-1.0), rel=1e-9)


def test_a_stopped_motor_runs_down_to_exactly_nothing() -> None:
    thruster = settled(1.0)
    for _ in range(400):
        thruster.step(0.0, 0.02)
    assert (thruster.shaft, thruster.thrust_n) == (0.0, 0.0)


def test_the_left_thruster_alone_turns_clockwise() -> None:
    pair = Thrusters(PAIR)
    for _ in range(300):
        force_n, moment_nm = pair.step(1.0, 0.0, 0.02)
    assert force_n == pytest.approx(4.0)
    assert moment_nm == pytest.approx(4.0 * 0.15)


@given(left=SHARE, right=SHARE)
def test_swapping_the_sides_mirrors_the_moment_and_keeps_the_force(left: float, right: float) -> None:
    one, other = Thrusters(PAIR), Thrusters(PAIR)
    for _ in range(20):
        force_n, moment_nm = one.step(left, right, 0.02)
        assert other.step(right, left, 0.02) == (force_n, -moment_nm)
    assert one.current_a(left, right) == pytest.approx(other.current_a(right, left))


def test_current_is_drawn_only_while_driven_and_is_largest_at_full_drive() -> None:
    assert settled(1.0).current_a(1.0) == pytest.approx(3.0)
    assert settled(1.0).current_a(0.0) == 0.0
    assert 0.0 < settled(0.5).current_a(0.5) < 0.5 * 3.0
    assert settled(-1.0).current_a(-1.0) == pytest.approx(3.0)
