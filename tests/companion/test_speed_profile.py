"""The speed profile against the formulas it stands for."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.config import Guidance
from companion.guidance.speed_profile import (
    CIRCLE_SHARE,
    REACTION_S,
    braking_speed_m_s,
    corner_speed_m_s,
    leg_speed_m_s,
    steered_speed_m_s,
    turn_lead_m,
)

SETTING = Guidance()  # radius 2 m, accel 0.4, corner 0.5 m/s², slowest 0.4 m/s, pivot 1.05 rad
turns = st.floats(-math.pi, math.pi)


def test_a_right_angle_is_rounded_on_an_arc_of_the_waypoints_radius() -> None:
    assert corner_speed_m_s(math.pi / 2, SETTING) == pytest.approx(math.sqrt(0.5 * 2.0))


def test_no_corner_needs_no_slowing_and_a_hairpin_the_slowest() -> None:
    assert corner_speed_m_s(0.0, SETTING) == math.inf
    assert corner_speed_m_s(math.pi, SETTING) == SETTING.min_speed_m_s


@given(turns, turns)
def test_a_sharper_corner_is_never_taken_faster(one: float, other: float) -> None:
    slow, fast = sorted((one, other), key=abs, reverse=True)
    assert corner_speed_m_s(slow, SETTING) <= corner_speed_m_s(fast, SETTING)


@given(st.floats(0.0, 200.0), st.floats(0.0, 2.0))
def test_braking_covers_the_reaction_and_the_slowing(distance_m: float, end_speed: float) -> None:
    speed = braking_speed_m_s(distance_m, end_speed, SETTING)
    if speed > end_speed:
        needed_m = speed * REACTION_S + (speed**2 - end_speed**2) / (2.0 * SETTING.accel_m_s2)
        assert needed_m == pytest.approx(distance_m, abs=1e-6)
    else:
        assert speed == end_speed
        assert distance_m <= end_speed * REACTION_S + 1e-6


def test_a_leg_without_an_end_in_sight_is_sailed_at_its_speed() -> None:
    assert leg_speed_m_s(2.0, 100.0, None, SETTING) == 2.0
    assert leg_speed_m_s(2.0, 100.0, math.pi / 2, SETTING) == 2.0


def test_a_straight_junction_is_passed_at_full_speed() -> None:
    assert leg_speed_m_s(2.0, 0.0, 0.0, SETTING) == 2.0


def test_the_corners_speed_is_reached_where_the_corner_begins() -> None:
    at_circle = leg_speed_m_s(2.0, SETTING.waypoint_radius_m, math.pi / 2, SETTING)
    assert at_circle == pytest.approx(corner_speed_m_s(math.pi / 2, SETTING))


def test_steerage_way_is_kept_to_the_end_and_beyond() -> None:
    assert leg_speed_m_s(2.0, 0.0, None, SETTING) == SETTING.min_speed_m_s
    assert leg_speed_m_s(2.0, -5.0, None, SETTING) == SETTING.min_speed_m_s
    assert leg_speed_m_s(0.2, 0.0, None, SETTING) == 0.2


@given(st.floats(0.05, 5.0), st.floats(-10.0, 200.0), st.none() | turns)
def test_no_leg_is_sailed_faster_than_it_says(speed: float, distance_m: float, turn: float | None) -> None:
    allowed = leg_speed_m_s(speed, distance_m, turn, SETTING)
    assert min(speed, SETTING.min_speed_m_s) <= allowed <= speed


def test_the_boat_pivots_beyond_the_pivot_angle_only() -> None:
    pivot = SETTING.pivot_angle_rad
    assert steered_speed_m_s(2.0, 0.5 * pivot, SETTING) == 2.0
    assert steered_speed_m_s(2.0, -0.75 * pivot, SETTING) == pytest.approx(1.0)
    assert steered_speed_m_s(2.0, pivot, SETTING) == SETTING.min_speed_m_s
    assert steered_speed_m_s(2.0, math.nextafter(-pivot, -4.0), SETTING) == 0.0


@given(st.floats(0.0, 3.0), st.floats(0.0, math.pi), st.floats(0.0, math.pi))
def test_a_worse_heading_is_never_sailed_faster(speed: float, one: float, other: float) -> None:
    near, far = sorted((one, other))
    assert steered_speed_m_s(speed, far, SETTING) <= steered_speed_m_s(speed, near, SETTING) <= speed


@given(turns, st.floats(0.0, 5.0))
def test_an_early_turn_still_passes_within_the_waypoints_circle(turn: float, speed: float) -> None:
    lead = turn_lead_m(turn, speed, SETTING)
    assert lead >= 0.0
    assert lead * math.tan(0.25 * abs(turn)) <= CIRCLE_SHARE * SETTING.waypoint_radius_m + 1e-9


def test_the_turn_begins_earlier_at_speed() -> None:
    slow, fast = (turn_lead_m(1.0, speed, SETTING) for speed in (0.5, 2.0))
    assert fast == pytest.approx(slow + 0.75 * 1.5)
    assert turn_lead_m(0.0, 2.0, SETTING) == 0.0
