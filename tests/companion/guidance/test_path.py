"""A path of nodes: where a boat is along it, and what it says there."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.core.geo import Point
from companion.guidance.path import Node, Path

RIGHT_RAD = 0.5 * math.pi
# 10 m north, then 10 m east; the course turns over the last metre before the corner.
PATH = Path(
    [
        Node(0.0, 0.0, 0.0, 2.0),
        Node(9.0, 0.0, 0.0, 2.0),
        Node(10.0, 0.0, RIGHT_RAD, 1.0),
        Node(10.0, 10.0, RIGHT_RAD, 0.0),
    ]
)


@given(st.floats(0.0, 20.0))
def test_a_boat_on_the_path_is_found_where_it_is(along_m: float) -> None:
    found, cross = PATH.locate(PATH.point(along_m), -math.inf, math.inf)
    assert found == pytest.approx(along_m, abs=1e-6)
    assert cross == pytest.approx(0.0, abs=1e-6)


def test_the_path_goes_straight_on_before_and_beyond() -> None:
    assert PATH.locate(Point(-3.0, -1.0), -math.inf, math.inf) == pytest.approx((-3.0, -1.0))
    assert PATH.locate(Point(9.0, 12.0), -math.inf, math.inf) == pytest.approx((22.0, 1.0))


PLACES = st.tuples(st.floats(-20.0, 20.0), st.floats(-20.0, 20.0))


@given(st.lists(PLACES, min_size=2, max_size=12), PLACES)
def test_no_place_of_the_path_is_nearer(corners: list[tuple[float, float]], at: tuple[float, float]) -> None:
    path = Path([Node(north_m, east_m, 0.0, 1.0) for north_m, east_m in corners])
    _, cross = path.locate(Point(*at), 0.0, path.length_m)
    for share in range(101):
        assert abs(cross) <= math.dist(path.point(0.01 * share * path.length_m), at) + 1e-6


def test_only_the_stretch_that_is_asked_for_is_looked_at() -> None:
    near_both = Point(7.0, 2.9)
    assert PATH.locate(near_both, -math.inf, math.inf)[0] == pytest.approx(7.0)
    assert PATH.locate(near_both, 11.0, 20.0) == pytest.approx((12.9, 3.0))
    assert PATH.locate(Point(10.0, 5.0), -math.inf, 9.5)[0] == pytest.approx(9.5)


def test_course_goes_linearly_between_nodes_and_speed_as_at_an_even_acceleration() -> None:
    assert PATH.course_rad(5.0) == 0.0
    assert PATH.course_rad(9.5) == pytest.approx(0.5 * RIGHT_RAD)
    assert PATH.course_rad(99.0) == pytest.approx(RIGHT_RAD)
    assert PATH.speed_m_s(-1.0) == 2.0
    assert PATH.speed_m_s(15.0) == pytest.approx(math.sqrt(0.5))
    assert PATH.speed_m_s(20.0) == 0.0
