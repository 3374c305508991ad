"""String pulling on obstacles simple enough to know the answer."""

import math
from itertools import pairwise

import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from companion.core.geo import Point, distance_m, path_length_m
from mission_tools.planning.smooth import IsClear, merge_short_legs, pull_taut

BLOCK = shapely.box(-10.0, -10.0, 10.0, 10.0)


def clear_of_block(a: Point, b: Point) -> bool:
    return not BLOCK.crosses(shapely.LineString([(a.east_m, a.north_m), (b.east_m, b.north_m)]))


def always(a: Point, b: Point) -> bool:
    return True


def never(a: Point, b: Point) -> bool:
    return False


def test_nothing_is_skipped_that_is_not_clear() -> None:
    path = (Point(0.0, 0.0), Point(1.0, 0.0), Point(1.0, 1.0))
    assert pull_taut(path, never, 5.0) == path


def test_the_string_lies_against_the_corner_it_goes_round() -> None:
    wide = [Point(0.0, -30.0), Point(25.0, -20.0), Point(28.0, 15.0), Point(0.0, 30.0)]
    taut = pull_taut(wide, clear_of_block, 0.5)
    shortest_m = 2.0 * math.hypot(20.0, 10.0) + 20.0
    assert path_length_m(taut) == pytest.approx(shortest_m, rel=5e-3)
    assert all(clear_of_block(a, b) for a, b in pairwise(taut))


@given(st.lists(st.tuples(st.floats(-30, 30), st.floats(-30, 30)), min_size=2, max_size=12))
def test_a_pulled_path_keeps_its_ends_and_is_never_longer(corners: list[tuple[float, float]]) -> None:
    path = [Point(*corner) for corner in corners]
    taut = pull_taut(path, clear_of_block, 2.0)
    assert (taut[0], taut[-1]) == (path[0], path[-1])
    assert path_length_m(taut) <= path_length_m(path) + 1e-9


BEND = (Point(0.0, 0.0), Point(20.0, 0.0), Point(22.0, 2.0), Point(22.0, 30.0))


def test_a_short_leg_becomes_the_corner_its_neighbours_meet_in() -> None:
    merged = merge_short_legs(BEND, always, min_leg_m=5.0, max_length_m=100.0)
    assert len(merged) == 3
    assert distance_m(merged[1], Point(22.0, 0.0)) < 1e-9


@pytest.mark.parametrize(
    ("is_clear", "min_leg_m", "max_length_m"),
    [(never, 5.0, 100.0), (always, 2.0, 100.0), (always, 5.0, path_length_m(BEND) + 0.1)],
    ids=["blocked", "long enough", "too long a way"],
)
def test_a_short_leg_stays_where_merging_would_do_harm(
    is_clear: IsClear, min_leg_m: float, max_length_m: float
) -> None:
    assert merge_short_legs(BEND, is_clear, min_leg_m, max_length_m) == BEND
