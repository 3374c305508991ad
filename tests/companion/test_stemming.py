"""Stemming: corners with the bow up into a fast set."""

import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from companion.config import BoatConfig
from companion.geo import Line, Point
from companion.guidance.corner import corner_between
from companion.guidance.course_to_steer import course_to_steer
from companion.guidance.speed_profile import TURN_SHARE
from companion.guidance.stemming import COASTING_SHARE, stemming, stemming_radius_m
from companion.units import wrap_pi

CONFIG = BoatConfig()
SLOW, TOP = CONFIG.guidance.min_speed_m_s, CONFIG.handling.top_speed_m_s
NORTH = Line(Point(0.0, 0.0), Point(50.0, 0.0))
EAST = Line(Point(50.0, 0.0), Point(50.0, 50.0))
angles = st.floats(-math.pi, math.pi)


def test_a_following_set_faster_than_the_corners_speed_is_stemmed() -> None:
    corner = corner_between(NORTH, EAST, 2.0, CONFIG, 1.0, 0.0)
    assert corner is not None
    assert corner.stemming is not None
    assert corner.stemming.carried_m_s == pytest.approx(1.0)
    assert corner.radius_m < 1.5


@pytest.mark.parametrize(("north", "east"), [(0.0, 0.0), (0.3, 0.0), (-1.0, 0.0), (-1.0, -1.0)])
def test_a_weak_or_adverse_set_is_not(north: float, east: float) -> None:
    corner = corner_between(NORTH, EAST, 2.0, CONFIG, north, east)
    assert corner is not None
    assert corner.stemming is None
    assert corner.least_ahead_m_s(-5.0, CONFIG) == SLOW


def test_the_bow_stays_ahead_until_the_way_is_off_and_then_turns_up() -> None:
    corner = corner_between(NORTH, EAST, 2.0, CONFIG, 1.0, 0.0)
    assert corner is not None
    assert corner.stemming is not None
    turns_m = corner.stemming.turn_m
    assert corner.least_ahead_m_s(-turns_m - 0.1, CONFIG) == pytest.approx(COASTING_SHARE * SLOW)
    assert corner.least_ahead_m_s(-turns_m + 0.1, CONFIG) < 0.0
    far, near = (corner.speed_m_s(-turns_m - metres, 2.0, CONFIG) for metres in (20.0, 0.7))
    assert far == 2.0
    assert 1.0 <= near < 1.4
    assert corner.speed_m_s(0.0, 2.0, CONFIG) == corner.stemming.speed_m_s < 0.5


def test_speed_grows_behind_a_stemmed_corner_until_the_bow_is_down_again() -> None:
    corner = corner_between(NORTH, EAST, 2.0, CONFIG, 0.0, 1.0)
    assert corner is not None
    assert corner.stemming is not None
    assert corner.stemming.turn_m == 0.0
    behind = [corner.speed_m_s(corner.length_m + metres, 2.0, CONFIG) for metres in (0.1, 0.5, 1.0)]
    assert behind == sorted(behind)
    assert corner.speed_m_s(corner.length_m + corner.exit_m, 2.0, CONFIG) >= 1.0


@given(angles, st.floats(0.3, 2.3), st.floats(0.5, 1.7), angles)
def test_on_the_arc_the_bow_turns_no_faster_than_its_share(
    course: float, turn: float, set_m_s: float, downstream: float
) -> None:
    north, east, speed = set_m_s * math.cos(downstream), set_m_s * math.sin(downstream), 0.45
    radius = stemming_radius_m(course, turn, speed, north, east, CONFIG)
    assume(math.isfinite(radius))
    fastest, step = 0.0, 1e-4
    for n in range(9):
        here = course + n / 8 * turn
        bows = [course_to_steer(here + off, speed, north, east, -TOP, TOP)[0] for off in (-step, step)]
        fastest = max(fastest, abs(wrap_pi(bows[1] - bows[0])) / (2.0 * step) * speed / radius)
    assert fastest == pytest.approx(TURN_SHARE * CONFIG.handling.turn_rate_rad_s, rel=0.01)


def test_a_speed_like_the_sets_leaves_no_heading_to_stem_with() -> None:
    assert stemming_radius_m(0.0, 1.5, 0.5, 0.5, 0.0, CONFIG) == math.inf
    assert math.isfinite(stemming_radius_m(0.0, 1.5, 0.5, 1.2, 0.0, CONFIG))


@given(st.floats(0.2, 2.3), st.floats(0.9, 1.7), angles)
def test_a_corner_to_port_is_stemmed_like_its_mirror_image(
    turn: float, set_m_s: float, downstream: float
) -> None:
    north, east = set_m_s * math.cos(downstream), set_m_s * math.sin(downstream)
    one = stemming(0.0, turn, 0.45, north, east, CONFIG)
    other = stemming(0.0, -turn, 0.45, north, -east, CONFIG)
    assert one == pytest.approx(other)
