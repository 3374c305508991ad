"""Surveys: what is covered, how long the route is, what it keeps clear of."""

import math
from dataclasses import replace
from itertools import pairwise

import pytest
import shapely
from task_waters import FRAME, basin, real_lake, route_line

from companion.core.geo import Point
from mission_tools.costs.boat import load_boat
from mission_tools.errors import NoRoute, UsageError
from mission_tools.maps import Chart, Feature, build_chart
from mission_tools.planning.planner import PlanSettings
from mission_tools.tasks.survey.settings import SurveySettings, turn_radius_m
from mission_tools.tasks.survey.survey import Survey, survey
from mission_tools.tasks.survey.tracks import fewest_turns_rad, lay_tracks

pytestmark = pytest.mark.slow

SETTINGS = SurveySettings(footprint_m=10.0, overlap=0.1, plan=PlanSettings(clearance_m=4.0))
ISLAND = shapely.box(80.0, 40.0, 100.0, 60.0)


def reachable(
    chart: Chart, settings: SurveySettings, area: shapely.Polygon | None = None
) -> shapely.Geometry:
    """What the footprint can reach, built by other means than the survey's: round joins of 0.1 % error."""
    eroded = chart.navigable.buffer(-settings.plan.clearance_m, quad_segs=32)
    largest = max(shapely.get_parts(eroded), key=lambda part: part.area)
    target = largest.buffer(0.5 * settings.swath_m, quad_segs=32).intersection(chart.navigable)
    return target if area is None else target.intersection(area)


def covered_share(found: Survey, target: shapely.Geometry) -> float:
    """By areas of polygons; the survey's own figure is by samples."""
    line = route_line(found.route.points)
    # A buffer of a long line with many crossings is slow: buffer its legs and join them.
    swath = shapely.union_all(
        [shapely.LineString(pair).buffer(0.5 * found.swath_m, quad_segs=16) for pair in pairwise(line.coords)]
    )
    return float(swath.intersection(target).area / target.area)


@pytest.mark.parametrize(("overlap", "angle_deg"), [(0.0, None), (0.1, 33.0), (0.3, 90.0), (0.1, 0.0)])
def test_everything_within_reach_is_covered(overlap: float, angle_deg: float | None) -> None:
    chart = basin(ISLAND)
    angle_rad = None if angle_deg is None else math.radians(angle_deg)
    settings = replace(SETTINGS, overlap=overlap, angle_rad=angle_rad)
    found = survey(chart, Point(10.0, 10.0), settings)
    assert covered_share(found, reachable(chart, settings)) >= 0.995
    assert found.coverage >= 0.995
    assert found.route.min_clearance_m(chart) >= 4.0
    assert found.route.points[0] == Point(10.0, 10.0)


def test_without_a_shore_pass_tracks_reach_the_clearance_and_cover_less() -> None:
    chart = basin()
    whole, bare = (survey(chart, None, replace(SETTINGS, shore_passes=passes)) for passes in (1, 0))
    assert {leg.kind for leg in bare.route.legs} == {"track", "transit"}
    assert bare.route.length_m < whole.route.length_m
    assert 0.9 < bare.coverage < whole.coverage


def test_the_best_course_is_along_a_long_basin() -> None:
    assert fewest_turns_rad([shapely.box(0.0, 0.0, 200.0, 100.0)]) == pytest.approx(math.pi / 2.0)
    tilted = shapely.affinity.rotate(shapely.box(0.0, 0.0, 200.0, 50.0), 30.0)
    assert fewest_turns_rad([tilted]) == pytest.approx(math.radians(60.0))


def test_tracks_of_a_rectangle_are_as_many_and_as_long_as_by_hand() -> None:
    laid = lay_tracks([shapely.box(0.0, 0.0, 95.0, 40.0)], 0.0, 10.0, 12.0)
    assert len(laid.tracks) == 10
    assert laid.cells == (tuple(range(10)),)
    width_m = 9.5
    short_m = math.sqrt(6.0**2 - (width_m / 2.0) ** 2)  # the footprint reaches that far beyond a track's end
    for number, track in enumerate(laid.tracks):
        assert track.across_m == pytest.approx((number + 0.5) * width_m)
        assert (track.low_m, track.high_m) == pytest.approx((short_m, 40.0 - short_m))


def test_an_island_splits_the_tracks_into_four_cells() -> None:
    water = shapely.box(0.0, 0.0, 100.0, 60.0).difference(shapely.box(40.0, 20.0, 60.0, 40.0))
    laid = lay_tracks([water], 0.0, 10.0, 10.0)
    assert sorted(map(len, laid.cells)) == [2, 2, 4, 4]


def test_only_tracks_whose_water_meets_between_them_share_a_cell() -> None:
    corner = shapely.union(shapely.box(0.0, 0.0, 8.0, 30.0), shapely.box(0.0, 0.0, 20.0, 4.0))
    laid = lay_tracks([corner, shapely.box(11.0, 20.0, 20.0, 30.0)], 0.0, 10.0, 10.0)
    assert sorted(map(len, laid.cells)) == [1, 2]


def test_a_track_without_room_goes_through_the_nearest_place_that_has_it() -> None:
    water, room = shapely.box(0.0, 0.0, 10.0, 2.0), shapely.box(6.0, -5.0, 20.0, 20.0)
    (track,) = lay_tracks([water], 0.0, 10.0, 10.0, room).tracks
    assert (track.across_m, track.low_m, track.high_m) == pytest.approx((6.0, 0.0, 2.0))
    room = shapely.box(6.0, 2.5, 20.0, 20.0)
    (track,) = lay_tracks([water], 0.0, 10.0, 10.0, room).tracks
    assert (track.across_m, track.low_m, track.high_m) == pytest.approx((6.0, 2.5, 2.5))


def test_no_way_on_leads_back_along_a_pass() -> None:
    legs = survey(basin(ISLAND), Point(10.0, 10.0), SETTINGS).route.legs
    assert any(leg.kind == "shore" and len(leg.points) > 2 for leg in legs)
    for leg, onward in pairwise(legs):
        if leg.kind == "shore":
            assert onward.points[0] == leg.points[-1]
            assert onward.points[-1] not in leg.points


def test_an_area_half_on_land_is_surveyed_where_there_is_water() -> None:
    chart = basin(ISLAND)
    area = shapely.box(60.0, 30.0, 120.0, 130.0)
    found = survey(chart, Point(10.0, 10.0), SETTINGS, area)
    assert covered_share(found, reachable(chart, SETTINGS, area)) >= 0.995
    assert found.route.min_clearance_m(chart) >= 4.0
    with pytest.raises(NoRoute, match="4 m from every shore"):
        survey(chart, None, SETTINGS, shapely.box(82.0, 42.0, 98.0, 58.0))


def test_a_margin_widens_the_distance_from_the_shore() -> None:
    plan = PlanSettings(clearance_m=4.0, margin_m=3.0)
    found = survey(basin(ISLAND), None, replace(SETTINGS, plan=plan))
    assert found.coverage >= 0.995
    assert found.route.min_clearance_m(basin(ISLAND)) >= 7.0


def test_cross_lines_run_across_the_tracks() -> None:
    found = survey(basin(), None, replace(SETTINGS, cross_spacing_m=50.0))
    crosses = [leg for leg in found.route.legs if leg.kind == "cross"]
    assert len(crosses) == 4  # 192 m of water in lines some 50 m apart
    for leg in crosses:
        assert leg.points[0].east_m == pytest.approx(leg.points[1].east_m)
        assert leg.length_m == pytest.approx(92.0, abs=0.5)


def test_the_way_back_ends_at_the_start() -> None:
    start = Point(10.0, 10.0)
    found = survey(basin(ISLAND), start, replace(SETTINGS, is_return=True))
    assert found.route.points[-1] == start
    assert found.route.length_m < 1.2 * found.plain_m


@pytest.mark.parametrize(
    ("given", "spacing_m", "swath_m"),
    [
        ({"spacing_m": 8.0}, 8.0, 8.0),
        ({"footprint_m": 10.0}, 10.0, 10.0),
        ({"footprint_m": 10.0, "overlap": 0.2}, 8.0, 10.0),
        ({"spacing_m": 8.0, "overlap": 0.2}, 8.0, 10.0),
        ({"spacing_m": 8.0, "footprint_m": 10.0}, 8.0, 10.0),
    ],
)
def test_two_of_spacing_footprint_and_overlap_give_the_third(
    given: dict[str, float], spacing_m: float, swath_m: float
) -> None:
    settings = SurveySettings(**given)  # type: ignore[arg-type]
    assert (settings.track_spacing_m, settings.swath_m) == pytest.approx((spacing_m, swath_m))


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({}, "needs the spacing"),
        ({"spacing_m": 12.0, "footprint_m": 10.0}, "leave gaps"),
        ({"spacing_m": 8.0, "footprint_m": 10.0, "overlap": 0.2}, "leave one out"),
        ({"spacing_m": -1.0}, "spacing is -1 m"),
        ({"footprint_m": 5.0, "overlap": 1.0}, "overlap is 1"),
        ({"spacing_m": 5.0, "angle_rad": math.nan}, "angle is nan"),
    ],
)
def test_settings_that_make_no_sense_are_refused(given: dict[str, float], said: str) -> None:
    with pytest.raises(UsageError, match=said):
        SurveySettings(**given)  # type: ignore[arg-type]


def test_the_turn_radius_is_the_largest_of_what_rudder_rate_and_acceleration_allow() -> None:
    boat = replace(load_boat("lake"), turn_rate_rad_s=0.65, corner_accel_m_s2=0.8)
    assert turn_radius_m(boat, 2.0) == 0.0  # two motors turn it on the spot
    steered = replace(boat, least_radius_m=1.0)
    assert turn_radius_m(steered, 2.0) == pytest.approx(5.0)
    assert turn_radius_m(steered, 0.66) == pytest.approx(0.66 / 0.65)
    assert turn_radius_m(steered, 0.4) == pytest.approx(1.0)


def test_an_area_of_open_water_is_surveyed_and_open_water_without_one_refused() -> None:
    rock = Feature("Rock", "island", shapely.Point(200.0, 180.0).buffer(15.0))
    sea = build_chart("Sea", FRAME, None, [rock])
    area = shapely.box(100.0, 100.0, 300.0, 250.0)
    found = survey(sea, Point(0.0, 0.0), SETTINGS, area)
    assert covered_share(found, area.difference(rock.shape.buffer(1.0))) >= 0.995
    assert found.route.min_clearance_m(sea) >= 4.0
    with pytest.raises(UsageError, match="name an area"):
        survey(sea, None, SETTINGS)


def test_water_out_of_reach_is_told() -> None:
    """A wall with a gap of 6 m, which a clearance of 4 m does not pass, cuts off the east."""
    walls = [shapely.box(148.0, 0.0, 152.0, 47.0), shapely.box(148.0, 53.0, 152.0, 100.0)]
    found = survey(basin(*walls), Point(10.0, 10.0), SETTINGS)
    (note,) = found.route.notes
    assert note == "25% of the water is out of reach with 4 m kept from every shore"
    assert survey(basin(), Point(10.0, 10.0), SETTINGS).route.notes == ()


@pytest.mark.parametrize(("turn_radius_m", "most"), [(0.0, 1.05), (5.0, 1.10)])
def test_a_real_lake_with_islands_is_covered_by_little_more_than_plain_lines(
    turn_radius_m: float, most: float
) -> None:
    chart = real_lake("pond_two_islands_nh")
    settings = replace(SETTINGS, footprint_m=12.0, turn_radius_m=turn_radius_m)
    found = survey(chart, None, settings)
    assert covered_share(found, reachable(chart, settings)) >= 0.995
    assert found.coverage == pytest.approx(covered_share(found, reachable(chart, settings)), abs=0.002)
    assert found.route.length_m <= most * found.plain_m
    legs = shapely.linestrings([(a[::-1], b[::-1]) for a, b in pairwise(found.route.points)])
    assert not shapely.dwithin(chart.shores, legs, 4.0 * (1.0 - 1e-6)).any()
    assert found.route.min_clearance_m(chart) >= 4.0 * (1.0 - 1e-6)


def test_a_raft_is_sailed_round_and_not_passed_along() -> None:
    """A pass round 4 m of raft would be 30 m long; tracks that it cut would end twice more each."""
    raft = shapely.box(60.0, 48.0, 64.0, 52.0)
    settings = replace(SETTINGS, footprint_m=16.0, shore_passes=1, angle_rad=0.0)
    bare, found = (survey(chart, None, settings) for chart in (basin(), basin(raft)))
    assert found.tracks == bare.tracks
    assert found.route.length_m - bare.route.length_m < 12.0
    assert covered_share(found, reachable(basin(raft), settings)) >= 0.995
    assert found.route.min_clearance_m(basin(raft)) >= 4.0 * (1.0 - 1e-6)


@pytest.mark.parametrize("corner", [(60.0, 48.0), (57.0, 93.0), (3.0, 50.0), (120.5, 40.0)])
@pytest.mark.parametrize("passes", [0, 1, 6])
def test_no_leg_comes_nearer_to_a_raft_than_the_clearance(corner: tuple[float, float], passes: int) -> None:
    x, y = corner
    chart = basin(shapely.box(x, y, x + 4.0, y + 3.0))
    found = survey(chart, None, replace(SETTINGS, footprint_m=16.0, shore_passes=passes, angle_rad=0.2))
    assert found.route.min_clearance_m(chart) >= 4.0 * (1.0 - 1e-6)
    legs = shapely.linestrings([(a[::-1], b[::-1]) for a, b in pairwise(found.route.points)])
    assert chart.navigable.covers(shapely.union_all(legs))
    assert shapely.length(legs).min() > 0.05  # `mission-check` takes nearer waypoints for one place


@pytest.mark.parametrize("clearance_m", [1.0, 4.0])
def test_tracks_are_led_into_and_out_of_straight_where_there_is_water(clearance_m: float) -> None:
    chart = basin(ISLAND)
    settings = replace(SETTINGS, lead_m=8.0, angle_rad=0.0, plan=PlanSettings(clearance_m=clearance_m))
    found = survey(chart, None, settings)
    kinds = [leg.kind for leg in found.route.legs]
    short = 0
    for number in (number for number, kind in enumerate(kinds) if kind == "track"):
        track = found.route.legs[number]
        if abs(track.points[0].east_m - track.points[-1].east_m) > 1e-6:
            continue  # a spike
        before, after = found.route.legs[number - 1].points[-2:], found.route.legs[number + 1].points[:2]
        for a, b in (before, after):
            is_led = abs(a.east_m - b.east_m) < 1e-6 and abs(a.north_m - b.north_m) > 7.99
            short += not is_led
    (note,) = found.route.notes or ("0 ends of tracks",)
    assert note.split()[0] == str(short)
    assert (short == 0) == (clearance_m < 4.0)
    assert found.route.min_clearance_m(chart) >= clearance_m * (1.0 - 1e-6)


def test_every_further_pass_makes_the_survey_of_a_ragged_shore_shorter() -> None:
    chart = real_lake("lake_squam_nh")
    lengths_m = [
        survey(chart, None, replace(SETTINGS, footprint_m=200.0, shore_passes=passes)).route.length_m
        for passes in (1, 2, 4)
    ]
    assert lengths_m == sorted(lengths_m, reverse=True)


def test_tracks_farther_apart_than_the_area_is_across_are_refused() -> None:
    with pytest.raises(UsageError, match=r"tracks 5000 m apart, but the area is \d+ m across"):
        survey(basin(), None, SurveySettings(spacing_m=5000.0))


def test_gaps_get_lines_of_their_own_and_no_passes_along_shores() -> None:
    """What a sounder missed along one line, a place of a metre, and a wide one; x is east."""
    line, spot, wide = (
        shapely.box(30.0, 20.0, 33.0, 70.0),
        shapely.box(150.0, 80.0, 151.0, 81.0),
        shapely.box(120.0, 20.0, 160.0, 45.0),
    )
    settings = replace(SETTINGS, overlap=0.0, has_gaps=True)
    gaps = shapely.MultiPolygon([line, spot, wide])
    found = survey(basin(), Point(10.0, 10.0), settings, gaps)
    assert {leg.kind for leg in found.route.legs} == {"transit", "track"}
    assert covered_share(found, gaps) >= 0.999
    tracks = [leg for leg in found.route.legs if leg.kind == "track"]
    (along,) = [leg for leg in tracks if leg.points[0].east_m < 100.0]
    assert [point.east_m for point in along.points] == pytest.approx([31.5, 31.5])
    assert along.length_m == pytest.approx(50.0 - 2.0 * math.sqrt(5.0**2 - 1.5**2))
    assert 5 <= len(tracks) <= 7
    assert route_line(found.route.points).distance(spot) < 5.0
    assert found.route.length_m < 420.0


def test_tracks_on_both_sides_of_an_island_are_sailed_without_going_back() -> None:
    """Twelve tracks of 1,960 m in all, eleven gaps, and one way along a side of the island."""
    plan = PlanSettings(clearance_m=0.01)
    settings = SurveySettings(spacing_m=10.0, footprint_m=11.0, shore_passes=0, plan=plan)
    found = survey(basin(ISLAND), None, settings)
    assert found.tracks == 12
    assert found.route.length_m < 1960.0 + 11 * 10.0 + 40.0
    assert found.coverage > 0.999
    chosen = survey(basin(ISLAND), None, replace(settings, shore_passes=None))
    assert chosen.route.length_m <= found.route.length_m
