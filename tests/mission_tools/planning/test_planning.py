"""From chart to route: clearance to the true shores, typed failures that name the culprit, real lakes."""

import math
from itertools import pairwise
from pathlib import Path

import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import affinity

from companion.core.geo import LatLon, LocalFrame, Point, distance_m, path_length_m
from mission_tools.errors import GoalBlocked, MapError, NoRoute, NoRouteError, StartBlocked, UsageError
from mission_tools.maps import Chart, Feature, RouteDefaults, build_chart, load_geojson
from mission_tools.planning.grid_planner import plan_on_grid
from mission_tools.planning.plan_settings import HEURISTICS
from mission_tools.planning.planner import Plan, PlanSettings, plan

pytestmark = pytest.mark.slow

POND = Path(__file__).parents[3] / "examples" / "maps" / "mill_pond.geojson"
FRAME = LocalFrame(LatLon(50.0, -1.2))
JETTY, MILL = Point(-150.0, -194.0), Point(232.0, 222.0)
TOLERANCE_M = 0.01


@pytest.fixture(scope="module")
def pond() -> Chart:
    return load_geojson(POND, FRAME.origin)


def basin(*features: Feature) -> Chart:
    """100 m square, the origin in its middle."""
    return build_chart("Basin", FRAME, shapely.box(-50, -50, 50, 50), features)


def assert_keeps_clear(chart: Chart, found: Plan, clearance_m: float) -> None:
    line = shapely.LineString([(p.east_m, p.north_m) for p in found.points])
    assert chart.navigable.contains(line)
    assert line.distance(chart.navigable.boundary) >= clearance_m - TOLERANCE_M
    assert found.min_clearance_m >= clearance_m - TOLERANCE_M


@pytest.mark.parametrize("heuristic", HEURISTICS)
def test_the_mill_pond_route_goes_round_what_lies_between(pond: Chart, heuristic: str) -> None:
    found = plan(pond, JETTY, MILL, PlanSettings.from_route(RouteDefaults(heuristic=heuristic)))
    assert (found.points[0], found.points[-1]) == (JETTY, MILL)
    assert_keeps_clear(pond, found, 4.0)
    assert 500.0 < found.length_m < 800.0
    assert found.straight_m <= found.length_m <= path_length_m(found.found)
    near = {
        feature.name
        for feature in pond.features
        if feature.kind in ("island", "raft")
        and feature.shape.distance(shapely.LineString([(p.east_m, p.north_m) for p in found.points])) < 8.0
    }
    assert len(near) >= 3
    assert len(found.points) <= 12
    assert min(distance_m(a, b) for a, b in pairwise(found.points)) > 4.0


def test_without_smoothing_the_route_is_the_grids_own_with_the_straight_points_left_out(pond: Chart) -> None:
    found = plan_on_grid(pond, (JETTY, MILL), PlanSettings(smooth=False))
    assert found.length_m == pytest.approx(path_length_m(found.found), rel=1e-9)
    assert set(found.points) <= set(found.found)
    assert len(found.points) < 0.5 * len(found.found)
    assert_keeps_clear(pond, found, 4.0)
    assert found.cell_m == 1.0
    taut = plan_on_grid(pond, (JETTY, MILL), PlanSettings())
    assert taut.length_m < 0.99 * found.length_m
    assert taut.expanded == found.expanded > 100


def test_an_obstacle_in_open_water_is_rounded_at_the_clearance() -> None:
    rock = Feature("Rock", "obstacle", shapely.Point(50.0, 0.0).buffer(10.0))
    sea = build_chart("Sea", FRAME, None, [rock])
    found = plan(sea, Point(0.0, 0.0), Point(0.0, 100.0), PlanSettings(clearance_m=5.0))
    assert 5.0 - TOLERANCE_M <= found.min_clearance_m < 6.0
    # tangent, arc of 15 m radius, tangent
    tangent_m, angle = math.sqrt(50.0**2 - 15.0**2), math.pi - 2.0 * math.acos(15.0 / 50.0)
    assert found.length_m == pytest.approx(2.0 * tangent_m + 15.0 * angle, rel=0.01)
    on_grid = plan_on_grid(sea, (Point(0.0, 0.0), Point(0.0, 100.0)), PlanSettings(5.0, cell_m=1.0))
    assert on_grid.min_clearance_m >= 5.0 - TOLERANCE_M
    assert on_grid.length_m == pytest.approx(found.length_m, rel=0.03)


def test_a_channel_just_wide_enough_is_used_and_one_just_too_narrow_is_not() -> None:
    def wall(gap_m: float) -> Chart:
        return basin(
            Feature("West Mole", "pier", shapely.box(-50, -2, -gap_m / 2, 2)),
            Feature("East Mole", "pier", shapely.box(gap_m / 2, -2, 50, 2)),
        )

    start, goal = Point(-30.0, -20.0), Point(30.0, 20.0)
    found = plan(wall(8.6), start, goal, PlanSettings(clearance_m=4.0))
    assert_keeps_clear(wall(8.6), found, 4.0)
    with pytest.raises(NoRoute, match="keeps 4 m clear") as caught:
        plan(wall(7.9), start, goal, PlanSettings(clearance_m=4.0))
    assert caught.value.exit_code == 1


def test_a_start_at_its_jetty_is_left_for_the_nearest_free_water_and_the_notes_say_so() -> None:
    jetty = Feature("Jetty", "pier", shapely.box(-2, -50, 2, 0))
    start = Point(0.5, 0.0)
    found = plan(basin(jetty), start, Point(30.0, 30.0), PlanSettings(clearance_m=3.0))
    assert found.points[0] == start
    assert found.min_clearance_m >= 3.0 - TOLERANCE_M
    assert distance_m(start, found.points[1]) < 4.5
    assert "0.50 m from Jetty" in found.notes[0]


island = Feature("Alder Island", "island", shapely.box(-10, -10, 10, 10))
beach = Feature("Beach", "swimming", shapely.box(20, 20, 50, 50))


@pytest.mark.parametrize(
    ("place", "said"),
    [
        (Point(0.0, 0.0), "lies on Alder Island: the nearest free water is 1"),
        (Point(30.0, 30.0), "lies in Beach: the nearest free water is"),
        (Point(0.0, 500.0), "lies outside the map: the nearest free water is 4"),
    ],
)
def test_a_blocked_start_or_goal_names_what_is_in_the_way(place: Point, said: str) -> None:
    chart, free = basin(island, beach), Point(-30.0, -30.0)
    with pytest.raises(StartBlocked, match=f"start .* {said}") as at_start:
        plan(chart, place, free)
    with pytest.raises(GoalBlocked, match=f"goal .* {said}") as at_goal:
        plan(chart, free, place)
    assert at_start.value.exit_code == at_goal.value.exit_code == 2
    with pytest.raises(GoalBlocked, match="via point 1 "):
        plan(chart, free, free, via=[place])


def test_a_goal_nearer_to_a_shore_than_the_clearance_is_refused_with_the_distance() -> None:
    with pytest.raises(
        GoalBlocked, match=r"is 2\.0 m from Alder Island, nearer than the clearance of 4 m: the near"
    ):
        plan(basin(island), Point(-30.0, -30.0), Point(0.0, 12.0))


def test_a_clearance_that_leaves_no_water_says_so() -> None:
    with pytest.raises(StartBlocked, match="nowhere on this map is 60 m clear: choose a smaller clearance"):
        plan(basin(), Point(0.0, 0.0), Point(10.0, 10.0), PlanSettings(clearance_m=60.0))


@pytest.mark.parametrize(
    "wrong", [{"clearance_m": -1.0}, {"clearance_m": math.nan}, {"cell_m": 0.0}, {"heuristic": "best"}]
)
def test_settings_that_make_no_sense_are_refused(wrong: dict[str, object]) -> None:
    with pytest.raises(UsageError):
        PlanSettings.from_route(RouteDefaults(), **wrong)


def test_cells_too_small_for_memory_are_refused(pond: Chart) -> None:
    with pytest.raises(UsageError, match="choose larger cells"):
        plan(pond, JETTY, MILL, PlanSettings(cell_m=0.01))


coordinate = st.integers(-45, 45).map(float)
rocks = st.lists(
    st.tuples(coordinate, coordinate, st.floats(0.3, 18.0), st.floats(0.3, 18.0), st.floats(0.0, 90.0)),
    max_size=7,
)


@settings(max_examples=60)
@given(
    boxes=rocks,
    ends=st.tuples(coordinate, coordinate, coordinate, coordinate),
    clearance_m=st.sampled_from([0.0, 0.5, 2.0, 4.0]),
    cell_m=st.sampled_from([None, 0.9, 2.3]),
)
def test_every_route_keeps_its_clearance_to_the_true_polygons_and_its_ends(
    boxes: list[tuple[float, float, float, float, float]],
    ends: tuple[float, float, float, float],
    clearance_m: float,
    cell_m: float | None,
) -> None:
    start, goal = Point(ends[0], ends[1]), Point(ends[2], ends[3])
    features = [
        Feature(f"rock {n}", "obstacle", affinity.rotate(shapely.box(e - w, n_m - h, e + w, n_m + h), turn))
        for n, (e, n_m, w, h, turn) in enumerate(boxes)
    ]
    try:
        chart = basin(*features)
        found = plan(chart, start, goal, PlanSettings(clearance_m=clearance_m, cell_m=cell_m))
    except (NoRouteError, MapError):
        return
    assert (found.points[0], found.points[-1]) == (start, goal)
    assert found.length_m >= found.straight_m - 1e-9
    if not found.notes:
        assert_keeps_clear(chart, found, clearance_m)
        before_m = path_length_m(found.found)
        assert (found.length_m >= before_m - 1e-9) if cell_m is None else (found.length_m <= before_m + 1e-9)


def raft(west: float, south: float, east: float, north: float) -> Feature:
    return Feature("Raft", "raft", shapely.box(west, south, east, north))


def test_a_margin_is_kept_on_top_of_the_clearance_where_there_is_room() -> None:
    chart = basin(raft(-5, -5, 5, 5))
    found = plan(chart, Point(0, -40), Point(0, 40), PlanSettings(4.0, margin_m=0.6))
    assert_keeps_clear(chart, found, 4.6)
    assert (found.notes, found.settings.clearance_m) == ((), 4.0)


@pytest.mark.parametrize(
    ("gap_m", "required_m", "said"),
    [
        (9.0, 4.3, "kept to 4.3 m: no route keeps 4.6 m"),
        (8.4, 4.0, "kept to 4 m: there is no room for a margin"),
    ],
)
def test_where_a_passage_is_narrow_the_margin_gives_way_and_a_note_says_so(
    gap_m: float, required_m: float, said: str
) -> None:
    half = 0.5 * gap_m
    chart = basin(raft(-5, half, 5, 51), raft(-5, -51, 5, -half))
    found = plan(chart, Point(0, -40), Point(0, 40), PlanSettings(4.0, cell_m=0.1, margin_m=0.6))
    assert_keeps_clear(chart, found, required_m)
    assert [note for note in found.notes if said in note]


def test_a_goal_and_a_start_that_have_the_clearance_but_no_margin_are_sailed_to() -> None:
    chart = basin()
    for start, goal in ((Point(0, -45.8), Point(0, 30)), (Point(0, -30), Point(0, 45.8))):
        found = plan(chart, start, goal, PlanSettings(4.0, margin_m=0.6))
        assert_keeps_clear(chart, found, 4.0)
        assert found.notes == ("kept to 4 m: there is no room for a margin beside it",)


@pytest.mark.parametrize("margin_m", [-0.1, math.inf, math.nan])
def test_a_margin_that_is_none_is_refused(margin_m: float) -> None:
    with pytest.raises(UsageError, match="margin is"):
        PlanSettings(margin_m=margin_m)
