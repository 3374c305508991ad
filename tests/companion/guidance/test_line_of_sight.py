"""Line of sight: the law itself, and the geometry around it."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.config.tuning import Guidance
from companion.guidance.line_of_sight import desired_course_rad, lookahead_m

RESPONSE_S = 0.7
SETTING = Guidance(lookahead_m=4.0)


def test_one_lookahead_off_is_approached_at_45_degrees() -> None:
    assert desired_course_rad(0.0, 4.0, 0.0, 4.0, RESPONSE_S) == pytest.approx(-math.pi / 4)
    assert desired_course_rad(0.0, -4.0, 0.0, 4.0, RESPONSE_S) == pytest.approx(math.pi / 4)


def test_a_closing_boat_is_turned_back_early() -> None:
    still = desired_course_rad(0.0, 2.0, 0.0, 4.0, RESPONSE_S)
    assert desired_course_rad(0.0, 2.0, -1.0, 4.0, RESPONSE_S) == pytest.approx(
        -math.atan((2.0 - RESPONSE_S) / 4.0)
    )
    assert still < desired_course_rad(0.0, 2.0, -1.0, 4.0, RESPONSE_S) < 0.0


@given(st.floats(-math.pi, math.pi), st.floats(-1e4, 1e4), st.floats(0.1, 20.0))
def test_never_steers_further_than_square_to_the_leg(leg: float, cross: float, ahead: float) -> None:
    offset = desired_course_rad(leg, cross, 0.0, ahead, RESPONSE_S) - leg
    assert abs(offset) <= math.pi / 2 + 1e-9
    assert offset * cross <= 0.0


@pytest.mark.parametrize(("speed", "expected"), [(2.0, 4.0), (0.0, 2.0), (1.5, 3.0), (9.0, 6.0)])
def test_lookahead_grows_with_speed_between_its_bounds(speed: float, expected: float) -> None:
    assert lookahead_m(speed, 2.0, SETTING) == pytest.approx(expected)


def test_restraint_looks_up_to_four_times_as_far_ahead() -> None:
    assert lookahead_m(2.0, 2.0, SETTING, 1.0) == pytest.approx(4.0 * SETTING.lookahead_m)
    assert lookahead_m(2.0, 2.0, SETTING, 0.5) == pytest.approx(2.5 * SETTING.lookahead_m)
