"""The velocity triangle: what is steered, with the set, is the course that was asked for."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.config.boat_config import BoatConfig
from companion.core.state import NavState
from companion.core.units import wrap_pi
from companion.guidance.course_to_steer import course_to_steer, steerable_speed_m_s

CONFIG = BoatConfig()  # top speed 3 m/s, least speed 0.4 m/s
courses = st.floats(-math.pi, math.pi)


def nav_in(current_north_m_s: float, current_east_m_s: float, water_m_s: float = 0.0) -> NavState:
    """Bow to the north, with a speed through the water."""
    return NavState(
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, water_m_s + current_north_m_s, 0.0, 0.1, 0.1,
        current_north_m_s, current_east_m_s,
    )  # fmt: skip


def made_good(
    heading_rad: float, water_m_s: float, current_north: float, current_east: float
) -> tuple[float, float]:
    north = water_m_s * math.cos(heading_rad) + current_north
    east = water_m_s * math.sin(heading_rad) + current_east
    return math.atan2(east, north), math.hypot(north, east)


@given(courses, st.floats(-0.7, 0.7), st.floats(-0.7, 0.7))
def test_course_and_speed_are_made_good_within_the_boats_means(
    course: float, current_north: float, current_east: float
) -> None:
    heading, water = course_to_steer(course, 1.7, nav_in(current_north, current_east), CONFIG)
    way, speed = made_good(heading, water, current_north, current_east)
    assert wrap_pi(way - course) == pytest.approx(0.0, abs=1e-9)
    assert speed == pytest.approx(1.7)


@given(courses, st.floats(-2.0, 2.0), st.floats(-2.0, 2.0), st.floats(0.0, 5.0))
def test_the_course_goes_before_the_speed(
    course: float, current_north: float, current_east: float, speed: float
) -> None:
    heading, water = course_to_steer(course, speed, nav_in(current_north, current_east), CONFIG)
    assert water <= 3.0 + 1e-9
    assert math.cos(heading - course) > 0.0  # the bow never turns away from where the boat is to go
    across = current_east * math.cos(course) - current_north * math.sin(course)
    if abs(across) < 2.5:
        offset = water * math.sin(heading - course) + across
        assert offset == pytest.approx(0.0, abs=1e-9)


def test_a_set_from_astern_faster_than_asked_still_leaves_steerage_way() -> None:
    assert course_to_steer(0.0, 1.0, nav_in(1.5, 0.0), CONFIG) == pytest.approx((0.0, 0.4))


def test_a_set_too_strong_to_cross_is_held_against_as_far_as_makes_sense() -> None:
    heading, water = course_to_steer(0.0, 2.0, nav_in(0.0, 5.0), CONFIG)
    assert heading == pytest.approx(-1.0)
    assert water == pytest.approx(3.0)


def test_the_bow_is_pointed_for_a_speed_within_reach_of_the_one_the_boat_has() -> None:
    """1 m/s across: with 2.236 m/s through the water 2 m/s are left along the course, with less nothing."""
    assert steerable_speed_m_s(0.0, 2.0, 0.3, nav_in(0.0, 1.0, math.sqrt(5.0))) == pytest.approx(2.0)
    assert steerable_speed_m_s(0.0, 2.0, 0.3, nav_in(0.0, 1.0, 0.5)) == pytest.approx(0.3)
    assert steerable_speed_m_s(0.0, 0.5, 0.3, nav_in(0.0, 1.0, math.sqrt(5.0))) == pytest.approx(1.7)
    assert steerable_speed_m_s(0.0, 2.0, 0.3, nav_in(0.5, 0.0, 1.0)) == pytest.approx(
        1.8
    )  # the current helps
