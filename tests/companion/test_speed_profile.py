"""The speed profile against the formulas it stands for."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.config import BoatConfig
from companion.guidance.speed_profile import (
    REACTION_S,
    TURN_SHARE,
    braking_speed_m_s,
    corner_speed_m_s,
    leg_speed_m_s,
    steered_speed_m_s,
)

CONFIG = BoatConfig()
SETTING = CONFIG.guidance  # radius 2 m, accel 0.4, corner 0.5 m/s², slowest 0.4 m/s, pivot 1.05 rad
radii = st.floats(0.0, 100.0)


def test_a_wide_arc_is_sailed_at_the_centripetal_limit_and_a_narrow_one_at_the_turn_rates() -> None:
    assert corner_speed_m_s(20.0, CONFIG) == pytest.approx(math.sqrt(0.5 * 20.0))
    assert corner_speed_m_s(1.0, CONFIG) == pytest.approx(TURN_SHARE * CONFIG.handling.turn_rate_rad_s)


def test_no_arc_is_too_narrow_for_steerage_way() -> None:
    assert corner_speed_m_s(0.0, CONFIG) == SETTING.min_speed_m_s


@given(radii, radii)
def test_a_narrower_arc_is_never_sailed_faster(one: float, other: float) -> None:
    narrow, wide = sorted((one, other))
    assert corner_speed_m_s(narrow, CONFIG) <= corner_speed_m_s(wide, CONFIG)


@given(st.floats(0.0, 200.0), st.floats(0.0, 2.0))
def test_braking_covers_the_reaction_and_the_slowing(distance_m: float, end_speed: float) -> None:
    speed = braking_speed_m_s(distance_m, end_speed, SETTING)
    if speed > end_speed:
        needed_m = speed * REACTION_S + (speed**2 - end_speed**2) / (2.0 * SETTING.accel_m_s2)
        assert needed_m == pytest.approx(distance_m, abs=1e-6)
    else:
        assert speed == end_speed
        assert distance_m <= end_speed * REACTION_S + 1e-6


def test_a_hull_that_reacts_sooner_may_go_faster() -> None:
    late, soon = (braking_speed_m_s(3.0, 0.0, SETTING, reaction_s) for reaction_s in (2.0, 0.5))
    assert soon > late


def test_an_end_that_is_far_or_needs_no_slowing_leaves_the_legs_speed() -> None:
    assert leg_speed_m_s(2.0, 100.0, 0.0, CONFIG) == 2.0
    assert leg_speed_m_s(2.0, 0.0, 2.5, CONFIG) == 2.0


def test_the_speed_at_the_end_is_reached_there() -> None:
    assert leg_speed_m_s(2.0, 0.0, 0.7, CONFIG) == pytest.approx(0.7)
    assert leg_speed_m_s(2.0, 1.0, 0.7, CONFIG) > 0.7


def test_steerage_way_is_kept_to_the_end_and_beyond() -> None:
    assert leg_speed_m_s(2.0, 0.0, 0.0, CONFIG) == SETTING.min_speed_m_s
    assert leg_speed_m_s(2.0, -5.0, 0.0, CONFIG) == SETTING.min_speed_m_s
    assert leg_speed_m_s(0.2, 0.0, 0.0, CONFIG) == 0.2


@given(st.floats(0.05, 5.0), st.floats(-10.0, 200.0), st.floats(0.0, 3.0))
def test_no_leg_is_sailed_faster_than_it_says(speed: float, distance_m: float, end_speed: float) -> None:
    allowed = leg_speed_m_s(speed, distance_m, end_speed, CONFIG)
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
