import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.core.units import TAU, clamp, deg_to_e7, e7_to_deg, wrap_pi, wrap_two_pi

angles = st.floats(-1e4, 1e4)


@given(angles)
def test_a_wrapped_angle_lies_in_the_half_open_turn_and_points_the_same_way(angle_rad: float) -> None:
    wrapped = wrap_pi(angle_rad)
    assert -math.pi <= wrapped < math.pi
    assert math.cos(wrapped - angle_rad) == pytest.approx(1.0, abs=1e-9)


@given(angles)
def test_an_angle_wrapped_to_a_whole_turn_is_never_the_turn_itself(angle_rad: float) -> None:
    wrapped = wrap_two_pi(angle_rad)
    assert 0.0 <= wrapped < TAU
    assert math.cos(wrapped - angle_rad) == pytest.approx(1.0, abs=1e-9)


def test_the_smallest_negative_angle_wraps_to_zero() -> None:
    assert wrap_two_pi(-1e-17) == 0.0
    assert wrap_pi(math.pi) == -math.pi


def test_clamping_keeps_what_lies_between_and_lets_nan_through() -> None:
    assert [clamp(value, -1.0, 2.0) for value in (-3.0, 0.5, 7.0)] == [-1.0, 0.5, 2.0]
    assert math.isnan(clamp(math.nan, -1.0, 1.0))


@given(st.integers(-1_800_000_000, 1_800_000_000))
def test_scaled_degrees_survive_the_round_trip(angle_e7: int) -> None:
    assert deg_to_e7(e7_to_deg(angle_e7)) == angle_e7


def test_degrees_are_rounded_to_nearest_not_cut() -> None:
    assert deg_to_e7(50.00000019) == 500_000_002
    assert deg_to_e7(-1.20000019) == -12_000_002
