"""The parts of a survey by themselves: order, metric, passes along the shore, what joins them, coverage."""

from collections.abc import Callable, Sequence
from itertools import combinations, pairwise, permutations, product
from typing import cast

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from task_waters import basin

from companion.core.geo import Point
from mission_tools.maps.chart import Chart
from mission_tools.planning.planner import PlanSettings
from mission_tools.tasks.room import polygons, simplified, water_clear_of_shores
from mission_tools.tasks.survey.coverage import coverage, sample_points, way_lengths_m
from mission_tools.tasks.survey.postman import Pass, Visit, linked, with_chains, with_spikes
from mission_tools.tasks.survey.sequence import Mode, best_sequence
from mission_tools.tasks.survey.settings import SurveySettings
from mission_tools.tasks.survey.shore_pass import RING_ERROR, largest, passes_along

Array = np.ndarray[tuple[int, ...], np.dtype[np.float64]]


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


def passes_of(chart: Chart, settings: SurveySettings) -> tuple[list[Array], list[shapely.Polygon]]:
    water = water_clear_of_shores(chart, settings.plan.required_m)
    target = shapely.MultiPolygon(water).buffer(0.5 * settings.swath_m).intersection(chart.navigable)
    return passes_along(chart, water, target, settings)


@pytest.mark.parametrize("overlap", [0.1, 0.4, 0.6])
def test_passes_run_half_a_spacing_off_the_shore_and_then_a_spacing_apart(overlap: float) -> None:
    chart = basin()
    settings = SurveySettings(
        footprint_m=20.0, overlap=overlap, shore_passes=3, plan=PlanSettings(clearance_m=1.0)
    )
    rings, _ = passes_of(chart, settings)
    first, second, third = (shapely.LineString(ring) for ring in rings)
    error_m = 2.0 * RING_ERROR * 20.0
    spacing_m = settings.track_spacing_m
    assert chart.shores.distance(first) == pytest.approx(0.5 * spacing_m, abs=error_m)
    assert first.distance(second) == pytest.approx(spacing_m, abs=error_m)
    assert second.distance(third) == pytest.approx(spacing_m, abs=error_m)


def test_passes_end_where_no_water_is_left_and_the_tracks_get_the_rest() -> None:
    settings = SurveySettings(footprint_m=20.0, shore_passes=99, plan=PlanSettings(clearance_m=1.0))
    rings, left = passes_of(basin(), settings)
    assert 2 <= len(rings) <= 4
    swaths = shapely.MultiLineString(rings).buffer(10.0, quad_segs=32)
    rest = shapely.union_all(left)
    assert swaths.union(rest.buffer(0.05)).area >= 0.996 * 200.0 * 100.0
    assert swaths.intersection(rest).area < 1.0


def two_passes() -> tuple[Pass, Pass]:
    """Squares of 100 and 60 m, one in the other."""
    return tuple(Pass(shapely.get_coordinates(shapely.box(at, at, 100 - at, 100 - at))) for at in (0, 20))  # type: ignore[return-value]


def test_a_pass_without_anything_on_the_way_is_sailed_but_for_its_gap() -> None:
    outer, _ = two_passes()
    (visit,) = outer.visits(np.array([50.0, 0.0]), 8.0)
    assert visit.kind == "shore"
    assert shapely.LineString(visit.points).length == pytest.approx(392.0)
    assert sorted(visit.points[[0, -1], 0].tolist()) == pytest.approx([46.0, 54.0])


def test_a_linked_pass_is_sailed_on_the_way_along_the_other_side_by_side() -> None:
    outer, inner = two_passes()
    water = shapely.box(0.0, 0.0, 100.0, 100.0)
    assert linked([outer, inner], [0.0, np.inf], 8.0, water, 20.0) == [outer]
    visits = list(outer.visits(np.array([50.0, 0.0]), 8.0))
    lengths_m = sum(shapely.LineString(visit.points).length for visit in visits)
    links_m = sum(float(np.hypot(*(b.points[0] - a.points[-1]))) for a, b in pairwise(visits))
    assert lengths_m == pytest.approx(400.0 + 240.0 - 3 * 8.0, abs=8.0)
    assert links_m <= 45.0  # 49 m the other way round


def test_passes_with_land_between_them_are_linked_only_where_all_else_is_far_longer() -> None:
    one, other = (Pass(shapely.get_coordinates(shapely.box(at, 0, at + 10, 10))) for at in (0, 20))
    water = shapely.box(0, 0, 10, 10).union(shapely.box(20, 0, 30, 10))
    assert linked([one, other], [0.0, 77.0], 1.0, water, 20.0) == [one, other]
    assert linked([one, other], [0.0, 79.0], 1.0, water, 20.0) == [one]


def test_passes_are_linked_over_ten_footprints_and_no_farther() -> None:
    one, other = (Pass(shapely.get_coordinates(shapely.box(at, 0, at + 10, 10))) for at in (0, 110))
    water = shapely.box(0, 0, 120, 10)
    assert linked([one, other], [0.0, 999.0], 0.0, water, 10.1) == [one]
    one.ways.clear()
    assert linked([one, other], [0.0, 999.0], 0.0, water, 9.9) == [one, other]


def test_a_piece_that_is_as_wide_as_the_footprint_has_a_spike_to_its_middle() -> None:
    outer, _ = two_passes()
    water = shapely.box(0.0, 0.0, 100.0, 100.0)
    assert with_spikes([outer], [shapely.Point(50.0, 20.0).buffer(10.2)], water, 20.0) == []
    ((_, tip),) = outer.ways
    assert isinstance(tip, np.ndarray)
    assert tip == pytest.approx([50.0, 20.0], abs=0.05)


def test_a_spike_reaches_just_far_enough_to_cover_its_piece() -> None:
    outer, _ = two_passes()
    piece = shapely.Point(50.0, 14.0).buffer(2.0)
    water = shapely.box(0.0, 0.0, 100.0, 100.0)
    assert with_spikes([outer], [piece], water, 20.0) == []
    ((leave, tip),) = outer.ways
    assert leave == pytest.approx([50.0, 0.0], abs=0.1)
    assert isinstance(tip, np.ndarray)
    assert tip == pytest.approx([50.0, 6.0], abs=0.1)
    wide = shapely.box(30.0, 12.0, 60.0, 20.0)
    assert with_spikes([outer], [wide], water, 20.0) == [wide]


def chains_m(cells: Sequence[Visit], cuts: Sequence[int], way: Callable[[Array, Array], float]) -> float:
    """Of chains between these cuts, each from the line y = 0 and back to the same place there."""
    total_m = 0.0
    for first, last in pairwise((0, *cuts, len(cells))):
        begin, end = cells[first].points[0], cells[last - 1].points[-1]
        places = [np.array([x, 0.0]) for x in np.arange(0.0, 100.5, 0.5)]
        total_m += min(way(begin, place) + way(place, end) for place in places)
        total_m += sum(way(a.points[-1], b.points[0]) for a, b in pairwise(cells[first:last]))
    return total_m


@given(st.integers(0, 10_000), st.integers(2, 6))
def test_a_sequence_is_cut_as_well_as_by_trying_every_cut(seed: int, count: int) -> None:
    """Its chains may be left from the nearest place to either end, which costs a little."""
    random = np.random.default_rng(seed)
    cells = [Visit("track", random.random((2, 2)) * [100.0, 40.0]) for _ in range(count)]

    def way(a: Array, b: Array) -> float:
        return float(np.hypot(*(a - b)))

    outer = Pass(np.array([[0.0, 0.0], [100.0, 0.0], [0.0, 0.0]]))
    ways_m = np.array([[way(a.points[0], b.points[-1]) for b in cells] for a in cells])
    never = np.full_like(ways_m, np.inf)
    assert (
        with_chains([outer], [[one] for one in cells], ways_m, never, shapely.box(0, 0, 100, 40), 0.5) == []
    )
    found_m = 0.0
    for leave, chain in outer.ways:
        assert isinstance(chain, list)
        ends = [leave, *(end for visit in chain for end in (visit.points[0], visit.points[-1])), leave]
        found_m += sum(way(a, b) for a, b in zip(ends[::2], ends[1::2], strict=True))
    cuts = [some for size in range(count) for some in combinations(range(1, count), size)]
    best_m = min(chains_m(cells, some, way) for some in cuts)
    assert best_m - 0.5 <= found_m <= 1.35 * best_m + 1.0
    sailed = [id(visit) for _, chain in outer.ways for visit in cast(list[Visit], chain)]
    assert sorted(sailed) == sorted(map(id, cells))


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


def test_polygons_of_collections_in_collections_are_found() -> None:
    piece, line = shapely.box(0.0, 0.0, 1.0, 1.0), shapely.LineString([(0.0, 0.0), (1.0, 1.0)])
    nested = shapely.GeometryCollection([shapely.GeometryCollection([piece, line]), line])
    assert polygons(nested) == [piece]


def test_coverage_is_the_share_of_the_area() -> None:
    target = shapely.box(0.0, 0.0, 100.0, 40.0)
    path = [Point(10.0, 0.0), Point(10.0, 100.0)]
    assert coverage(path, target, 20.0) == pytest.approx(0.5, abs=0.002)
    points = sample_points(target, 10_000)
    assert len(points) == pytest.approx(10_000, rel=0.02)
    assert points.mean(axis=0) == pytest.approx([50.0, 20.0], abs=0.5)


def test_the_smallest_pieces_are_left_out_up_to_an_area() -> None:
    pieces = [shapely.box(10.0 * n, 0.0, 10.0 * n + n, 1.0) for n in (1, 2, 3)]
    for most_m2, left in ((0.9, 3), (1.0, 2), (2.9, 2), (3.0, 1), (6.0, 0)):
        assert largest(shapely.MultiPolygon(pieces), most_m2) == pieces[3 - left :]


@pytest.mark.parametrize("distance_m", [0.5, 4.0, 30.0])
def test_the_water_clear_of_shores_is_never_nearer_than_asked(distance_m: float) -> None:
    """The chords of a buffer's corners lie 0.5 % nearer than its distance."""
    spike = shapely.Polygon([(95.0, 40.0), (100.0, 62.0), (105.0, 40.0)])
    chart = basin(spike, width_m=200.0, height_m=120.0)
    for piece in water_clear_of_shores(chart, distance_m):
        assert piece.boundary.distance(chart.shores) >= distance_m * (1.0 - 1e-6)
        assert piece.boundary.distance(chart.shores) <= distance_m * 1.02
