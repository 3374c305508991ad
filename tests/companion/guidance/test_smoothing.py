"""Smoothing legs to a path, and the speed profile over it."""

import math
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point, bearing_rad, distance_m
from companion.core.units import wrap_pi
from companion.guidance.smoothing import LEG_SHARE, SmoothPath, smooth
from companion.guidance.speed_profile import GAINING_SHARE

CONFIG = BoatConfig()
ACCEL = CONFIG.guidance.accel_m_s2
STILL = (0.0, 0.0)
STAIRCASE = [Point(0.0, 0.0), Point(50.0, 0.0), Point(50.0, 50.0), Point(100.0, 50.0)]


def smoothed(
    places: list[Point], current_m_s: tuple[float, float] = STILL, radius_m: float = 2.0
) -> SmoothPath:
    return smooth(places, radius_m, 2.0, current_m_s, CONFIG)


@st.composite
def routes(draw: st.DrawFn) -> list[Point]:
    """Legs of 4 to 40 m with turns that have fillets."""
    at, course, places = Point(0.0, 0.0), draw(st.floats(-3.0, 3.0)), [Point(0.0, 0.0)]
    for _ in range(draw(st.integers(2, 6))):
        length = draw(st.floats(4.0, 40.0))
        at = Point(at.north_m + length * math.cos(course), at.east_m + length * math.sin(course))
        places.append(at)
        course += draw(st.floats(-2.2, 2.2))
    return places


sets = st.tuples(st.floats(-0.5, 0.5), st.floats(-0.5, 0.5)) | st.just(STILL)


@given(routes(), sets)
def test_the_path_is_smooth_and_passes_every_waypoint_at_speeds_that_the_hull_can_follow(
    places: list[Point], current_m_s: tuple[float, float]
) -> None:
    made = smoothed(places, current_m_s)
    path = made.path
    for n, (one, other) in enumerate(pairwise(path.nodes)):
        length_m = path.along_m(n + 1) - path.along_m(n)
        assert abs(other.course_rad - one.course_rad) < 0.45
        if length_m > 0.05:
            along = bearing_rad(Point(*one[:2]), Point(*other[:2]))
            assert abs(wrap_pi(along - 0.5 * (one.course_rad + other.course_rad))) < 0.12
        if current_m_s == STILL:
            gained = other.speed_m_s**2 - one.speed_m_s**2
            assert -2.0 * ACCEL * length_m - 1e-6 <= gained <= 2.0 * GAINING_SHARE * ACCEL * length_m + 1e-6
            assert max(one.speed_m_s, other.speed_m_s) <= 2.0 + 1e-9
    assert list(made.marks_m) == sorted(made.marks_m)
    if math.hypot(*current_m_s) < 0.28:
        for place, mark in zip(places, made.marks_m, strict=False):
            assert distance_m(path.point(mark), place) <= 2.0 + 1e-6
    for (before, at, after), fillet in made.fillets.items():
        assert fillet.entry_m <= LEG_SHARE * distance_m(before, at) + 1e-9
        assert fillet.exit_m <= LEG_SHARE * distance_m(at, after) + 1e-9


def test_the_path_ends_at_rest_at_the_last_place() -> None:
    made = smoothed(STAIRCASE)
    assert len(made.marks_m) == 4
    assert made.path.nodes[-1][:2] == pytest.approx((100.0, 50.0))
    assert made.path.speed_m_s(made.path.length_m) == 0.0
    assert made.path.speed_m_s(made.path.length_m - 2.0) == pytest.approx(math.sqrt(2.0 * ACCEL * 2.0))
    assert made.path.speed_m_s(25.0) == 2.0


def test_where_each_place_is_passed_is_known() -> None:
    made = smoothed(STAIRCASE)
    assert made.entries_m[0] == made.marks_m[0] == made.exits_m[0] == 0.0
    entry, mark, leaves = made.entries_m[1], made.marks_m[1], made.exits_m[1]
    assert entry < mark < leaves
    assert made.path.course_rad(entry) == pytest.approx(0.0)
    assert made.path.course_rad(mark) == pytest.approx(0.25 * math.pi, abs=0.05)
    assert made.path.course_rad(leaves) == pytest.approx(0.5 * math.pi)
    assert made.exits_m[-1] == pytest.approx(made.path.length_m)


def test_a_place_on_a_straight_line_is_no_corner() -> None:
    made = smoothed([Point(0.0, 0.0), Point(20.0, 0.0), Point(60.0, 0.0)])
    assert not made.fillets
    assert made.marks_m == pytest.approx((0.0, 20.0, 60.0))
    assert made.path.speed_m_s(20.0) == 2.0


def test_a_kept_fillet_is_sailed_as_it_was_made() -> None:
    still = smoothed(STAIRCASE)
    corner = (STAIRCASE[0], STAIRCASE[1], STAIRCASE[2])
    kept = {corner: still.fillets[corner]}
    made = smooth(STAIRCASE, 2.0, 2.0, (0.5, 0.0), CONFIG, kept)
    assert made.fillets[corner] is kept[corner]
    assert (
        made.fillets[STAIRCASE[1], STAIRCASE[2], STAIRCASE[3]]
        != still.fillets[STAIRCASE[1], STAIRCASE[2], STAIRCASE[3]]
    )
