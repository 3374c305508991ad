"""The arithmetic of a survey, by small cases worked out by hand."""

import math

import numpy as np
import pytest
import shapely

from companion.core.geo import Point
from mission_tools.errors import UsageError
from mission_tools.tasks.room import polygons
from mission_tools.tasks.survey.coverage import sample_points
from mission_tools.tasks.survey.postman import stations_along
from mission_tools.tasks.survey.settings import SurveySettings
from mission_tools.tasks.survey.survey import _check_water as check_water
from mission_tools.tasks.survey.tracks import Track, Tracks, lines_across
from mission_tools.tasks.survey.turns import _can_round as can_round
from mission_tools.tasks.survey.visits import _blocks as blocks
from mission_tools.tasks.survey.visits import _inner_m as inner_m
from mission_tools.tasks.survey.visits import _ways_through as ways_through


def test_samples_lie_on_equilateral_triangles() -> None:
    points = sample_points(shapely.box(0.0, 0.0, 100.0, 50.0), 2000)
    assert len(points) == pytest.approx(2000, rel=0.03)
    gaps_m = np.hypot(*(points[:, None] - points[None]).transpose(2, 0, 1))
    np.fill_diagonal(gaps_m, np.inf)
    side_m = math.sqrt(5000.0 / 2000 / (math.sqrt(3.0) / 2.0))
    assert gaps_m.min() == pytest.approx(side_m)
    inner = (points[:, 0] > 5.0) & (points[:, 0] < 95.0) & (points[:, 1] > 5.0) & (points[:, 1] < 45.0)
    assert {int(number) for number in np.sum(gaps_m[inner] < 1.001 * side_m, axis=1)} == {6}


@pytest.mark.parametrize(
    ("points", "radius_m"),
    [
        ([(0, 0), (0, 10), (12, 10)], 10.0),  # the shorter leg, whole
        ([(0, 0), (0, 12), (10, 12)], 10.0),
        ([(0, 0), (0, 10), (10, 10), (10, 20)], 5.0),  # half of the leg between two corners
        ([(0, 0), (0, 4), (10, 4), (10, 20)], 4.0),  # the first leg, whole
        ([(0, 0), (0, 20), (10, 20), (10, 24)], 4.0),  # the last leg, whole
    ],
)
def test_the_largest_arc_of_right_angles_is_as_long_as_its_leg_allows(
    points: list[tuple[float, float]], radius_m: float
) -> None:
    places = [Point(*point) for point in points]
    assert can_round(places, radius_m)
    assert not can_round(places, 1.001 * radius_m)


def test_blocks_are_as_equal_as_they_can_be_and_hold_every_track_once() -> None:
    assert blocks((0, 1, 2), 4) == [(0, 1, 2)]
    assert blocks(tuple(range(9)), 4) == [(0, 1, 2, 3), (4, 5, 6, 7, 8)]
    assert [len(one) for one in blocks(tuple(range(12)), 4)] == [4, 4, 4]


def test_a_cell_is_sailed_track_after_track_up_or_down_from_either_end() -> None:
    assert ways_through((0, 1), 2, 1) == [(0, 2, 3, 1), (2, 0, 1, 3), (1, 3, 2, 0), (3, 1, 0, 2)]


def test_where_a_turn_into_the_next_track_but_one_is_easier_halves_are_sailed_by_turns() -> None:
    ways = ways_through((0, 1, 2, 3), 4, 2)
    assert len(ways) == 8
    assert (0, 4, 6, 2, 1, 5, 7, 3) in ways  # tracks 0, 2, 1, 3
    assert (0, 4, 5, 1, 2, 6, 7, 3) in ways


def test_turns_inside_a_cell_are_summed_over_its_tracks() -> None:
    """A boat that turns on the spot sails from one track's end straight to the next one's."""
    tracks = Tracks(
        0.0, (Track(0.0, 0.0, 50.0), Track(10.0, 0.0, 53.0), Track(14.0, 0.0, 50.0)), ((0, 1, 2),), 10.0
    )
    up, down, up_again = (0, 3), (4, 1), (2, 5)
    assert inner_m((*up, *down, *up_again), tracks, 0.0) == pytest.approx(math.hypot(10.0, 3.0) + 4.0)


def test_stations_of_a_ring_are_its_corners_and_points_between() -> None:
    ring = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 3.0], [0.0, 0.0]])
    stations = stations_along(ring, 5.0)
    assert stations[:4].tolist() == [[0.0, 0.0], [5.0, 0.0], [10.0, 0.0], [10.0, 3.0]]
    closed = np.vstack((stations, ring[0]))
    assert np.hypot(*np.diff(closed, axis=0).T).max() <= 5.0
    assert len(stations) == 2 + 1 + 3


def test_lines_across_are_spread_evenly_and_one_at_least() -> None:
    water = [shapely.box(0.0, 0.0, 40.0, 100.0)]  # north up: a course of 0 runs along it
    found = lines_across(water, 0.0, 10.0)
    assert sorted(track.across_m for track in found.tracks) == pytest.approx([5.0, 15.0, 25.0, 35.0])
    assert {(track.low_m, track.high_m) for track in found.tracks} == {(0.0, 100.0)}
    assert len(lines_across(water, 0.0, 500.0).tracks) == 1


def test_polygons_are_found_in_collections_and_lines_are_left_out() -> None:
    box, line = shapely.box(0.0, 0.0, 1.0, 1.0), shapely.LineString([(0.0, 0.0), (1.0, 1.0)])
    nested = shapely.GeometryCollection(
        [shapely.MultiPolygon([box]), line, shapely.GeometryCollection([box])]
    )
    assert len(polygons(shapely.GeometryCollection([shapely.GeometryCollection([box, line]), box]))) == 2
    assert polygons(shapely.MultiPolygon([box])) == [box]
    assert polygons(line) == []
    assert all(part.area == 1.0 for part in polygons(nested))


@pytest.mark.parametrize(("spacing_m", "fits"), [(49.0, True), (51.0, False)])
def test_tracks_are_no_farther_apart_than_the_area_is_across_wherever_it_lies(
    spacing_m: float, fits: bool
) -> None:
    water, settings = [shapely.box(1000.0, 2000.0, 1030.0, 2040.0)], SurveySettings(spacing_m=spacing_m)
    if fits:
        check_water(water, settings)
    else:
        with pytest.raises(UsageError, match="the area is 50 m across"):
            check_water(water, settings)


def test_samples_fill_a_narrow_target_as_densely_as_a_wide_one() -> None:
    strip = shapely.box(0.0, 0.0, 1.0, 400.0)
    assert len(sample_points(strip, 4000)) == pytest.approx(4000, rel=0.06)


@pytest.mark.parametrize(
    ("given", "choices"),
    [
        ({}, (6, 3, 0)),
        ({"angle_rad": 0.0}, (1,)),
        ({"angle_rad": 0.0, "shore_passes": 3}, (3,)),
        ({"shore_passes": 0}, (0,)),
        ({"lead_m": 5.0}, (1,)),
        ({"pattern": "spiral"}, (0,)),
    ],
)
def test_shores_are_passed_once_where_straight_tracks_are_asked_for_and_never_in_a_search(
    given: dict[str, float], choices: tuple[int, ...]
) -> None:
    assert SurveySettings(spacing_m=5.0, **given).pass_choices == choices  # type: ignore[arg-type]


def test_fewer_than_no_passes_are_refused() -> None:
    with pytest.raises(UsageError, match="shore passes are -1"):
        SurveySettings(spacing_m=5.0, shore_passes=-1)
