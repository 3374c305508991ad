"""The drift is learned from what moves the boat square to its bow."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.guidance.drift import LEARNING_TIME_S, MAX_CRAB_RAD, TURNING_RAD_S, Drift
from companion.state import NavState
from companion.units import wrap_pi

DT = 0.02


def _nav(
    heading: float, water_speed: float, current: tuple[float, float], rate: float = 0.0, age_s: float = 0.1
) -> NavState:
    """A boat that slides nowhere but with the water."""
    c, s = math.cos(heading), math.sin(heading)
    north, east = water_speed * c + current[0], water_speed * s + current[1]
    surge, sway = north * c + east * s, east * c - north * s
    return NavState(0.0, 0.0, 0.0, heading, rate, north, east, surge, sway, age_s, 0.02)


def _sail(drift: Drift, heading: float, current: tuple[float, float], seconds: float = 30.0) -> None:
    for _ in range(round(seconds / DT)):
        drift.update(_nav(heading, 2.0, current), DT)


def test_one_heading_teaches_the_component_across_it_and_no_other() -> None:
    drift = Drift()
    _sail(drift, 0.0, (0.3, 0.4))
    assert (drift.north_m_s, drift.east_m_s) == pytest.approx((0.0, 0.4), abs=1e-3)


def test_two_headings_teach_the_whole_drift() -> None:
    drift = Drift()
    _sail(drift, 0.0, (0.3, 0.4))
    _sail(drift, math.pi / 2, (0.3, 0.4))
    assert (drift.north_m_s, drift.east_m_s) == pytest.approx((0.3, 0.4), abs=1e-3)


def test_learning_is_a_first_order_lag() -> None:
    drift = Drift()
    _sail(drift, 0.0, (0.0, 1.0), LEARNING_TIME_S)
    assert drift.east_m_s == pytest.approx(1.0 - math.exp(-1.0), abs=0.01)


@pytest.mark.parametrize(
    "nav",
    [
        _nav(0.0, 2.0, (0.0, 1.0), rate=1.01 * TURNING_RAD_S),
        _nav(0.0, 2.0, (0.0, 1.0), rate=-1.01 * TURNING_RAD_S),
        _nav(0.0, 2.0, (0.0, 1.0), age_s=5.0),
        _nav(0.0, 2.0, (0.0, math.nan)),
    ],
)
def test_turns_stale_and_broken_estimates_teach_nothing(nav: NavState) -> None:
    drift = Drift()
    drift.update(nav, DT)
    assert (drift.north_m_s, drift.east_m_s) == (0.0, 0.0)


@given(st.floats(-math.pi, math.pi), st.floats(-0.9, 0.9), st.floats(-0.9, 0.9))
def test_the_heading_it_gives_makes_the_course_it_was_asked_for(
    course: float, north: float, east: float
) -> None:
    drift = Drift()
    drift.north_m_s, drift.east_m_s = north, east
    nav = _nav(drift.heading_for_course_rad(course, 2.0), 2.0, (north, east))
    assert wrap_pi(math.atan2(nav.east_m_s, nav.north_m_s) - course) == pytest.approx(0.0, abs=1e-9)


def test_a_drift_stronger_than_the_boat_is_held_against_as_far_as_makes_sense() -> None:
    drift = Drift()
    drift.east_m_s = 3.0
    assert drift.heading_for_course_rad(0.0, 2.0) == pytest.approx(-MAX_CRAB_RAD)
    drift.east_m_s = -3.0
    assert drift.heading_for_course_rad(0.0, 2.0) == pytest.approx(MAX_CRAB_RAD)


def test_water_speed_is_what_is_left_without_the_drift() -> None:
    drift = Drift()
    drift.north_m_s, drift.east_m_s = 0.3, 0.4
    assert drift.water_speed_m_s(_nav(1.0, 1.7, (0.3, 0.4))) == pytest.approx(1.7)
    drift.reset()
    assert drift.water_speed_m_s(_nav(0.0, 1.7, (0.3, 0.0))) == pytest.approx(2.0)
