import itertools
import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from companion.core.geo import Line, Point
from companion.vehicle.track import SailedTrack

ACCURACY_M = 1.0


def sailed(track: list[Point], max_points: int = 500, step_m: float = 0.1) -> tuple[SailedTrack, list[Point]]:
    """A trail along a polyline, and the positions that it was shown."""
    trail = SailedTrack()
    trail.restart(track[0])
    shown = []
    for start, end in itertools.pairwise(track):
        length_m = math.dist(start, end)
        for n in range(1, max(round(length_m / step_m), 1) + 1):
            share = n / max(round(length_m / step_m), 1)
            at = Point(start.north_m + share * (end.north_m - start.north_m),
                       start.east_m + share * (end.east_m - start.east_m))  # fmt: skip
            shown.append(at)
            trail.add(at, ACCURACY_M, max_points)
    return trail, shown


def off_m(points: list[Point], at: Point) -> float:
    """How far a point is from a polyline."""
    nearest = min(math.dist(point, at) for point in points)
    for start, end in itertools.pairwise(points):
        along, cross = Line(start, end).along_and_cross_track_m(at)
        if 0.0 <= along <= math.dist(start, end):
            nearest = min(nearest, abs(cross))
    return nearest


def test_going_back_and_forth_over_the_same_water_needs_no_more_points() -> None:
    there_and_back = [Point(0, 0), Point(40, 0)] * 30
    trail, _ = sailed(there_and_back)
    assert len(trail.points) <= 4


def test_a_loop_is_cut_off_where_the_track_crosses_itself() -> None:
    loop = [Point(0, 0), Point(60, 0), Point(60, 30), Point(30, 30), Point(30, -40), Point(0, -40)]
    trail, shown = sailed(loop)
    length_m = sum(math.dist(a, b) for a, b in zip(trail.points, [*trail.points[1:], shown[-1]], strict=True))
    assert length_m == pytest.approx(30 + 40 + 30, abs=3.0)


def test_a_track_that_needs_more_points_than_fit_is_lost_and_says_so() -> None:
    zigzag = [Point(5.0 * n, 5.0 * (n % 2)) for n in range(40)]
    trail, _ = sailed(zigzag, max_points=20)
    assert trail.is_incomplete
    assert len(trail.points) == 20
    trail.restart(Point(0, 0))
    assert not trail.is_incomplete


places = st.builds(Point, st.floats(-50, 50), st.floats(-50, 50))


@given(st.lists(places, min_size=2, max_size=6))
@settings(max_examples=40)
def test_every_point_of_the_way_back_was_sailed_within_the_accuracy(track: list[Point]) -> None:
    trail, shown = sailed(track, step_m=0.5)
    back = [*trail.points, shown[-1]]
    assert trail.points[0] == track[0] or math.dist(trail.points[0], track[0]) < 1e-9
    for start, end in itertools.pairwise(back):
        for n in range(11):
            at = Point(start.north_m + 0.1 * n * (end.north_m - start.north_m),
                       start.east_m + 0.1 * n * (end.east_m - start.east_m))  # fmt: skip
            assert off_m([track[0], *shown], at) <= 2.2 * ACCURACY_M  # a loop's end may add as much again


def test_a_track_is_joined_where_the_unsailed_way_and_the_rest_of_the_track_are_shortest() -> None:
    trail, start = SailedTrack(), Point(0.0, 0.0)
    trail.points = [start, Point(0.0, 100.0), Point(100.0, 100.0)]
    back = trail.back_to(Point(50.0, 5.0), [start], 2.0, lambda *_: True)
    assert back is not None
    (joins, *rest), rest_m = back
    assert (*joins, rest_m) == pytest.approx((0.0, 5.0, 5.0))
    assert rest == [start, start]


def test_where_the_boat_turned_straight_back_is_kept() -> None:
    trail, _ = sailed([Point(0, 0), Point(40, 0), Point(20, 0)])
    assert trail.points[-1].north_m >= 39.0
