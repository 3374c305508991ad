"""The PID against closed forms."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.control.pid import Pid

DT = 0.02
FREE = (-1e9, 1e9)
ordinary = st.floats(-50.0, 50.0)
gain = st.floats(0.0, 10.0)


def test_constant_error_makes_a_step_and_a_ramp() -> None:
    pid = Pid()
    for tick in range(1, 101):
        out = pid.update(2.0, 0.5, 3.0, 0.4, 0.0, DT, *FREE)
        assert out.total == pytest.approx(2.0 * 0.4 + 0.5 * 0.4 * tick * DT)
        assert not out.saturated


def test_ramp_error_makes_a_parabola_and_a_constant() -> None:
    pid = Pid()
    for tick in range(1, 201):
        time_s = tick * DT
        out = pid.update(0.0, 0.5, 3.0, 0.1 * time_s, 0.1, DT, *FREE)
        assert out.d == pytest.approx(0.3)
        # The sum of a ramp exceeds its integral by half a step.
        assert out.i == pytest.approx(0.5 * 0.1 * time_s * (time_s + DT) / 2.0)


def test_integral_stops_where_p_and_d_leave_no_authority() -> None:
    pid = Pid()
    for _ in range(1000):
        out = pid.update(1.0, 1.0, 0.0, 0.7, 0.0, DT, -1.0, 1.0)
    assert out.i == pytest.approx(0.3)
    assert out.total == pytest.approx(1.0)


def test_what_was_learned_survives_a_moment_of_saturation() -> None:
    pid = Pid()
    for _ in range(500):
        pid.update(0.0, 1.0, 0.0, 0.05, 0.0, DT, -1.0, 1.0)
    learned = pid.integral
    pid.update(1.0, 1.0, 0.0, 5.0, 0.0, DT, -1.0, 1.0)
    assert pid.integral == learned == pytest.approx(0.5)


def test_a_new_integral_gain_moves_nothing_at_once() -> None:
    pid = Pid()
    for _ in range(100):
        before = pid.update(1.0, 0.2, 0.0, 0.3, 0.0, DT, *FREE).total
    after = pid.update(1.0, 0.4, 0.0, 0.3, 0.0, DT, *FREE).total
    assert after - before == pytest.approx(0.4 * 0.3 * DT)


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_an_error_that_is_no_number_leaves_no_trace(bad: float) -> None:
    pid = Pid()
    pid.update(1.0, 1.0, 0.0, 0.1, 0.0, DT, -1.0, 1.0)
    learned = pid.integral
    out = pid.update(1.0, 1.0, 1.0, bad, math.nan, DT, -1.0, 1.0)
    assert math.isnan(out.total)
    assert pid.integral == pytest.approx(learned)
    assert math.isfinite(pid.update(1.0, 1.0, 0.0, 0.1, 0.0, DT, -1.0, 1.0).total)


@given(
    gain, gain, gain, st.lists(st.tuples(ordinary, ordinary), min_size=1, max_size=50),
    st.floats(-5.0, 0.0), st.floats(0.0, 5.0),
)  # fmt: skip
def test_output_and_integral_stay_within_the_limits(
    kp: float, ki: float, kd: float, errors: list[tuple[float, float]], low: float, high: float
) -> None:
    pid = Pid()
    for error, rate in errors:
        out = pid.update(kp, ki, kd, error, rate, DT, low, high)
        assert low <= out.total <= high
        assert low <= out.i <= high
        wanted = out.p + out.i + out.d
        assert out.saturated == (not low <= wanted <= high)


@given(gain, gain, gain, st.lists(st.tuples(ordinary, ordinary), max_size=30))
def test_the_loop_is_odd(kp: float, ki: float, kd: float, errors: list[tuple[float, float]]) -> None:
    one, other = Pid(), Pid()
    for error, rate in errors:
        ours = one.update(kp, ki, kd, error, rate, DT, -1.0, 1.0).total
        assert other.update(kp, ki, kd, -error, -rate, DT, -1.0, 1.0).total == -ours
