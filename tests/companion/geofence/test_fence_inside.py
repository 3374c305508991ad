"""The nearest water inside the fence."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from test_fence_areas import COORDINATE, globe, laid, square

from companion.core.geo import Point
from companion.geofence.fence import FenceCircle

WATER = (square(100.0), square(10.0, is_inclusion=False), FenceCircle(globe([(60.0, 40.0)])[0], 8.0, False))


@given(st.builds(Point, COORDINATE, COORDINATE), st.floats(0.0, 5.0))
def test_it_has_the_margin_that_was_asked_for(point: Point, margin_m: float) -> None:
    fence = laid(*WATER)
    found = fence.inside(point, margin_m)
    assert fence.margin_m(found) >= margin_m - 1e-6
    if fence.margin_m(point) >= margin_m:
        assert found == point


def test_it_is_the_nearest_where_one_line_is_in_the_way() -> None:
    fence = laid(*WATER)
    assert fence.inside(Point(110.0, 20.0), 5.0) == pytest.approx((95.0, 20.0), abs=0.1)
    assert fence.inside(Point(8.0, 1.0), 5.0) == pytest.approx((15.0, 1.0), abs=0.1)
    found = fence.inside(Point(120.0, 120.0), 5.0)
    assert math.dist(found, (95.0, 95.0)) < 0.1


def test_without_a_fence_it_is_where_the_boat_is() -> None:
    assert laid().inside(Point(3.0, 4.0), 5.0) == Point(3.0, 4.0)
