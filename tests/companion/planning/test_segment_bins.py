"""What the bins of shore segments find, against a look at every segment."""

import math
from array import array
from random import Random

import pytest
import shapely

from companion.planning.segments import Segments, point_distance2, segment_distance2

Ends = tuple[float, float, float, float]


def drawn(random: Random, rings: int = 13) -> tuple[Segments, list[Ends]]:
    """Triangles with sides of a metre to the whole width, some sides along an axis."""
    ends: list[Ends] = []
    for number in range(rings):
        x, y, size_m = *place(random, 50.0), random.choice((1.0, 8.0, 60.0))
        corners = [(x + random.uniform(-size_m, size_m), y + random.uniform(-size_m, size_m)) for _ in "ab"]
        if number % 3 == 0:
            corners = [(x + size_m, y), (x, y - size_m)]
        corners.append((x, y))
        ends += [(*corners[at - 1], *corners[at]) for at in range(3)]
    return Segments(*(array("d", values) for values in zip(*ends, strict=True))), ends


def place(random: Random, half_m: float = 90.0) -> tuple[float, float]:
    return random.uniform(-half_m, half_m), random.uniform(-half_m, half_m)


def away_m(at: tuple[float, float], ends: Ends) -> float:
    return float(shapely.LineString([ends[:2], ends[2:]]).distance(shapely.Point(at)))


@pytest.mark.parametrize("seed", range(3))
def test_near_leaves_out_no_segment_within_reach(seed: int) -> None:
    random = Random(seed)
    segments, ends = drawn(random)
    for _ in range(100):
        at, reach_m = place(random), random.uniform(0.0, 30.0)
        found = segments.near(*at, reach_m)
        assert found == sorted(set(found))
        assert {k for k, one in enumerate(ends) if away_m(at, one) <= reach_m} <= set(found)
    assert len(segments.near(0.0, 0.0, 1.0)) < len(ends), "that is what bins are for"


@pytest.mark.parametrize("seed", range(3))
def test_two_points_are_covered_by_one_segment_that_both_are_near_to(seed: int) -> None:
    random = Random(seed)
    segments, ends = drawn(random)
    limits = array("d", [random.choice((2.0, 5.0, 9.0)) for _ in ends])
    covered = 0
    for _ in range(300):
        p, slack = place(random, 50.0), random.uniform(0.0, 3.0)
        q = p[0] + random.uniform(-2.0, 2.0), p[1] + random.uniform(-2.0, 2.0)
        expected = any(
            max(away_m(p, one), away_m(q, one)) < limit - slack
            for one, limit in zip(ends, limits, strict=True)
        )
        assert segments.covers(*p, *q, limits, slack, 9.0) is expected
        covered += expected
    assert 30 < covered < 270


@pytest.mark.parametrize("seed", range(3))
def test_a_leg_is_clear_where_it_keeps_the_limit_of_each_segment(seed: int) -> None:
    random = Random(seed)
    segments, ends = drawn(random, 4)
    limits = array("d", [random.choice((0.5, 2.0, 5.0)) for _ in ends])
    squares = array("d", [limit * limit for limit in limits])
    clear = 0
    for _ in range(300):
        a, b = place(random), place(random)
        leg = shapely.LineString([a, b])
        lines = [shapely.LineString([one[:2], one[2:]]) for one in ends]
        expected = all(leg.distance(line) >= limit for line, limit in zip(lines, limits, strict=True))
        assert segments.is_clear(*a, *b, squares, 5.0) is expected
        assert math.sqrt(segments.distance2(*a, *b)) == pytest.approx(
            min(leg.distance(line) for line in lines), abs=1e-9
        )
        clear += expected
    assert 20 < clear < 280


def test_distances_are_right_far_beyond_the_outermost_bin() -> None:
    segments, ends = drawn(Random(3))
    for at in ((5000.0, 0.0), (0.0, -5000.0), (-3000.0, 4000.0), (60.0, 5000.0)):
        nearest_m = min(away_m(at, one) for one in ends)
        assert math.sqrt(segments.distance2(*at, *at)) == pytest.approx(nearest_m)


@pytest.mark.parametrize(
    ("p", "expected_m"),
    [((5.0, 3.0), 3.0), ((-3.0, 4.0), 5.0), ((13.0, -4.0), 5.0), ((10.0, 2.0), 2.0), ((4.0, 0.0), 0.0)],
    ids=["beside", "before the start", "beyond the end", "at the end", "on it"],
)
def test_the_distance_of_a_point_is_that_of_the_foot_or_of_the_nearer_end(
    p: tuple[float, float], expected_m: float
) -> None:
    assert point_distance2(*p, 0.0, 0.0, 10.0, 0.0) == pytest.approx(expected_m**2)
    assert point_distance2(*p, 10.0, 0.0, 0.0, 0.0) == pytest.approx(expected_m**2)
    assert point_distance2(*p, 2.0, 1.0, 2.0, 1.0) == pytest.approx((p[0] - 2.0) ** 2 + (p[1] - 1.0) ** 2)


def test_segments_that_cross_have_no_distance_and_those_that_nearly_do_have_one() -> None:
    across = (0.0, 0.0, 10.0, 0.0)
    assert segment_distance2(*across, 5.0, -1.0, 5.0, 1.0) == 0.0
    assert segment_distance2(*across, 5.0, 1.0, 5.0, -1.0) == 0.0
    assert segment_distance2(*across, 12.0, -1.0, 12.0, 1.0) == pytest.approx(4.0)
    assert segment_distance2(*across, 5.0, 0.5, 5.0, 3.0) == pytest.approx(0.25)
    assert segment_distance2(5.0, 0.5, 5.0, 3.0, *across) == pytest.approx(0.25)
    assert segment_distance2(*across, 5.0, 3.0, 5.0, 0.5) == pytest.approx(0.25)
