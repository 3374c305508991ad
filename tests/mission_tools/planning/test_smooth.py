"""String pulling and corners on obstacles simple enough to know the answer."""

import math
from itertools import pairwise

import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from companion.core.geo import Point, distance_m, path_length_m
from mission_tools.planning.smooth import IsClear, corner_cut_m, merge_short_legs, pull_taut, widen_corners

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
    assert path_length_m(taut) == pytest.approx(shortest_m, rel=1e-3)
    assert all(clear_of_block(a, b) for a, b in pairwise(taut))


@given(st.lists(st.tuples(st.floats(-30, 30), st.floats(-30, 30)), min_size=2, max_size=12))
def test_a_pulled_path_keeps_its_ends_and_is_never_longer(corners: list[tuple[float, float]]) -> None:
    path = [Point(*corner) for corner in corners]
    taut = pull_taut(path, clear_of_block, 2.0)
    assert (taut[0], taut[-1]) == (path[0], path[-1])
    assert path_length_m(taut) <= path_length_m(path) + 1e-9


BEND = (Point(0.0, 0.0), Point(20.0, 0.0), Point(22.0, 2.0), Point(22.0, 30.0))


def test_a_short_leg_becomes_the_corner_its_neighbours_meet_in() -> None:
    for scale in (1.0, 0.02):
        bend = [Point(scale * at.north_m, scale * at.east_m) for at in BEND]
        merged = merge_short_legs(bend, always, min_leg_m=5.0 * scale, max_length_m=100.0)
        assert len(merged) == 3
        assert distance_m(merged[1], Point(22.0 * scale, 0.0)) < 1e-9


@pytest.mark.parametrize(
    ("is_clear", "min_leg_m", "max_length_m"),
    [(never, 5.0, 100.0), (always, 2.0, 100.0), (always, 5.0, path_length_m(BEND) + 0.1)],
    ids=["blocked", "long enough", "too long a way"],
)
def test_a_short_leg_stays_where_merging_would_do_harm(
    is_clear: IsClear, min_leg_m: float, max_length_m: float
) -> None:
    assert merge_short_legs(BEND, is_clear, min_leg_m, max_length_m) == BEND


CORNER = (Point(0.0, 0.0), Point(100.0, 0.0), Point(100.0, 100.0))


@given(st.floats(0.01, 3.1), st.floats(0.1, 10.0))
def test_the_cut_is_the_gap_between_the_corner_and_the_arc_that_rounds_it(
    turn: float, radius_m: float
) -> None:
    arc_radius_m = radius_m / math.tan(0.5 * turn)
    centre_to_corner_m = math.hypot(arc_radius_m, radius_m)
    assert corner_cut_m(turn, radius_m) == pytest.approx(
        centre_to_corner_m - arc_radius_m, rel=1e-6, abs=1e-9
    )


def test_a_corner_moves_outwards_by_its_cut_and_the_ends_stay() -> None:
    start, moved, end = widen_corners(CORNER, always, 2.0, math.inf)
    assert (start, end) == (CORNER[0], CORNER[2])
    assert distance_m(moved, CORNER[1]) == pytest.approx(2.0 * math.tan(math.pi / 8.0))
    assert moved.north_m > 100.0  # a turn to starboard at the north end: outwards is north-west
    assert moved.east_m < 0.0


def test_a_corner_with_little_room_moves_as_far_as_it_may() -> None:
    def is_south_of_a_quay(a: Point, b: Point) -> bool:
        return max(a.north_m, b.north_m) < 100.3

    _, moved, _ = widen_corners(CORNER, is_south_of_a_quay, 2.0, math.inf)
    assert 100.0 < moved.north_m < 100.3
