"""The parts of a survey by themselves: order, lower bound, metric, shore pass, coverage."""

from itertools import permutations, product

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from task_waters import basin

from companion.core.geo import Point
from mission_tools.tasks.room import simplified, water_clear_of_shores
from mission_tools.tasks.survey.coverage import coverage, least_transits_m, sample_points, way_lengths_m
from mission_tools.tasks.survey.sequence import Mode, best_sequence
from mission_tools.tasks.survey.shore_pass import passes_along, water_within_pass


def random_ends(seed: int, tracks: int) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """Low ends, then high ends."""
    return np.random.default_rng(seed).random((2 * tracks, 2)) * 100.0


def shortest_transits_m(ends: np.ndarray[tuple[int, int], np.dtype[np.float64]], start: int | None) -> float:
    """By trying every order and every direction. start: a node, None: free."""
    tracks = len(ends) // 2 if start is None else (len(ends) - 1) // 2
    best = np.inf
    for order in permutations(range(tracks)):
        for downs in product((False, True), repeat=tracks):
            here, length = start, 0.0
            for track, down in zip(order, downs, strict=True):
                first, last = (track + tracks, track) if down else (track, track + tracks)
                length += 0.0 if here is None else float(np.hypot(*(ends[here] - ends[first])))
                here = last
            best = min(best, length)
    return best


@given(st.integers(0, 10_000), st.integers(1, 4), st.booleans())
def test_no_order_has_shorter_transits_than_the_lower_bound(seed: int, tracks: int, has_start: bool) -> None:
    ends = random_ends(seed, tracks)
    start = np.array([50.0, 50.0])
    nodes = np.vstack((ends, start)) if has_start else ends
    bound = least_transits_m(ends, [], start if has_start else None, 10.0)
    assert 0.0 <= bound <= shortest_transits_m(nodes, len(nodes) - 1 if has_start else None) + 1e-9


def test_the_bound_counts_the_way_to_a_ring_and_back() -> None:
    """One track, and a round island 30 m beside it that must be entered and left."""
    ends = np.array([[0.0, 0.0], [0.0, 10.0]])
    ring = shapely.box(30.0, 0.0, 40.0, 10.0).exterior
    assert least_transits_m(ends, [ring], None, 1000.0) == pytest.approx(30.0)
    assert least_transits_m(ends, [ring], np.array([0.0, 0.0]), 1000.0) == pytest.approx(30.0)
    assert least_transits_m(ends, [ring], None, 0.0) <= 30.0


@given(st.integers(0, 10_000), st.integers(1, 4))
def test_few_items_come_near_the_best_order(seed: int, count: int) -> None:
    ends = random_ends(seed, count)
    places = np.vstack((ends, [[0.0, 0.0]], [[0.0, 0.0]]))
    lengths = np.hypot(*(places[:, None] - places[None]).transpose(2, 0, 1))
    lengths[-1] = lengths[:, -1] = 0.0  # the end is free
    items = [[Mode(n, n + count, 0.0), Mode(n + count, n, 0.0)] for n in range(count)]
    order = best_sequence(items, lengths, 2 * count, 2 * count + 1)
    assert sorted(item for item, _ in order) == list(range(count))
    here, found = 2 * count, 0.0
    for item, mode in order:
        found += lengths[here, items[item][mode].entry]
        here = items[item][mode].exit
    best = shortest_transits_m(np.vstack((ends, [[0.0, 0.0]])), 2 * count)
    assert best - 1e-9 <= found <= 1.5 * best + 1e-9


def test_the_metric_goes_round_a_wall_and_is_never_too_short() -> None:
    wall = shapely.box(98.0, 0.0, 102.0, 80.0)
    water = water_clear_of_shores(basin(wall), 4.0)[0]
    places = np.array([[50.0, 20.0], [150.0, 20.0], [60.0, 20.0]])
    found = way_lengths_m(water, places, np.arange(3), 1.0)
    round_it = 2.0 * np.hypot(44.0, 64.0) + 12.0
    assert found[0, 1] == pytest.approx(round_it, rel=0.08)
    assert found[0, 1] > round_it - 3.0
    assert found[0, 2] == pytest.approx(10.0, abs=0.01)


def test_the_pass_runs_as_far_out_as_the_footprint_covers() -> None:
    chart = basin()
    water = water_clear_of_shores(chart, 2.0)
    target = shapely.MultiPolygon(water).buffer(20.0).intersection(chart.navigable)
    (ring,) = passes_along(chart, water_within_pass(chart, water, target, 40.0), 2.0, 40.0)
    gaps = shapely.distance(chart.shores, shapely.points(ring))
    assert gaps.min() == pytest.approx(40.0 / (2.0 * 2.0**0.5), abs=1.0)


def test_the_pass_goes_into_a_cove_that_would_be_left_out() -> None:
    """A cove 12 m wide and 60 m deep, which a pass 14 m off the shores would not enter."""
    headlands = [shapely.box(0.0, 140.0, 144.0, 200.0), shapely.box(156.0, 140.0, 300.0, 200.0)]
    chart = basin(*headlands, width_m=300.0, height_m=200.0)
    water = water_clear_of_shores(chart, 2.0)
    target = shapely.MultiPolygon(water).buffer(20.0).intersection(chart.navigable)
    within = shapely.union_all(water_within_pass(chart, water, target, 40.0))
    assert within.bounds[3] > 190.0
    assert within.bounds[1] == pytest.approx(14.1, abs=0.5)


def test_a_ring_is_simplified_within_its_error_and_never_nearer_than_the_clearance() -> None:
    island = shapely.Point(50.0, 50.0).buffer(20.0, quad_segs=64)
    ring = shapely.get_coordinates(shapely.Point(50.0, 50.0).buffer(25.0, quad_segs=64).exterior)
    few = simplified(ring, island.exterior, 4.5, 1.0)
    assert 8 <= len(few) <= 40
    assert shapely.LineString(few).distance(island) >= 4.5
    assert shapely.hausdorff_distance(shapely.LineString(few), shapely.LineString(ring)) <= 1.0
    kept = simplified(ring, island.exterior, 4.999, 1.0)
    assert shapely.LineString(kept).distance(island) >= 4.98
    assert len(kept) > len(few)


def test_coverage_is_the_share_of_the_area() -> None:
    target = shapely.box(0.0, 0.0, 100.0, 40.0)
    path = [Point(10.0, 0.0), Point(10.0, 100.0)]
    assert coverage(path, target, 20.0) == pytest.approx(0.5, abs=0.002)
    points = sample_points(target, 10_000)
    assert len(points) == pytest.approx(10_000, rel=0.02)
    assert points.mean(axis=0) == pytest.approx([50.0, 20.0], abs=0.5)


def test_of_two_small_coves_the_pass_leaves_out_one() -> None:
    """Each would leave out 0.15 % of the target; 0.2 % may be left out."""
    walls = [shapely.box(west, 140.0, east, 200.0) for west, east in ((0, 94), (106, 194), (206, 300))]
    chart = basin(*walls, shapely.box(90.0, 152.0, 210.0, 200.0), width_m=300.0, height_m=200.0)
    water = water_clear_of_shores(chart, 2.0)
    target = shapely.MultiPolygon(water).buffer(20.0).intersection(chart.navigable)
    within = shapely.union_all(water_within_pass(chart, water, target, 40.0))
    heads = [shapely.Point(100.0, 148.0), shapely.Point(200.0, 148.0)]
    assert sum(within.intersects(head) for head in heads) == 1


@pytest.mark.parametrize("distance_m", [0.5, 4.0, 30.0])
def test_the_water_clear_of_shores_is_never_nearer_than_asked(distance_m: float) -> None:
    """The chords of a buffer's corners lie 0.5 % nearer than its distance."""
    spike = shapely.Polygon([(95.0, 40.0), (100.0, 62.0), (105.0, 40.0)])
    chart = basin(spike, width_m=200.0, height_m=120.0)
    for piece in water_clear_of_shores(chart, distance_m):
        assert piece.boundary.distance(chart.shores) >= distance_m * (1.0 - 1e-6)
        assert piece.boundary.distance(chart.shores) <= distance_m * 1.02
