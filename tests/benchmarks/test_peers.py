"""The comparison planners: valid paths or honest failures, and the same path for the same seed."""

import math
from importlib.util import find_spec

import pytest
import shapely

from benchmarks.peers import PEERS, ants, planner, roadmap
from benchmarks.peers.ants import Habits, colony
from benchmarks.peers.interface import Deadline, Failed, Path, Planned, Sea, plan
from benchmarks.peers.spline import pruned
from companion.core.geo import LatLon, LocalFrame, Point, path_length_m
from mission_tools.maps.chart import Chart, Feature, build_chart

BUDGET_S = 600.0
START, GOAL = Point(-30.0, 0.0), Point(30.0, 0.0)


def basin(*obstacles: shapely.Polygon) -> Chart:
    """100 m square."""
    features = [Feature(f"Rock {n}", "obstacle", shape) for n, shape in enumerate(obstacles)]
    return build_chart(
        "basin", LocalFrame(LatLon(50.0, 0.0)), shapely.box(-50.0, -50.0, 50.0, 50.0), features
    )


@pytest.fixture(autouse=True)
def few_iterations(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ants, "ITERATIONS", 12)
    monkeypatch.setattr(roadmap, "SAMPLES", 400)


ROCK = shapely.box(-25.0, -10.0, 20.0, 10.0)
WALL = shapely.box(-60.0, -2.0, 60.0, 2.0)


def needs_ompl(name: str) -> None:
    if name == "RRT*" and find_spec("ompl") is None:
        pytest.skip("OMPL is not installed: the extra `bench`")


def least_distance_m(chart: Chart, points: Path) -> float:
    """By shapely, which the planners do not ask."""
    line = shapely.LineString([(point.east_m, point.north_m) for point in points])
    return float(chart.shores.distance(line))


@pytest.mark.parametrize("name", PEERS)
def test_a_path_round_a_rock_is_valid_longer_than_the_exact_one_and_the_same_for_its_seed(
    name: str,
) -> None:
    needs_ompl(name)
    sea = Sea(basin(ROCK), 3.0)
    found = plan(planner(name), sea, START, GOAL, 5, BUDGET_S)
    assert isinstance(found, Planned), found
    assert (found.points[0], found.points[-1]) == (START, GOAL)
    assert least_distance_m(sea.chart, found.points) >= 3.0 - 1e-6
    exact_m = sea.water.routes(3.0).route(START, GOAL).length_m
    assert exact_m - 1e-6 <= found.length_m <= 1.6 * exact_m
    assert found.length_m == pytest.approx(path_length_m(found.points))
    again = plan(planner(name), Sea(basin(ROCK), 3.0), START, GOAL, 5, BUDGET_S)
    assert isinstance(again, Planned)
    assert again.points == found.points


@pytest.mark.parametrize("name", PEERS)
def test_without_a_way_every_planner_says_so(name: str) -> None:
    needs_ompl(name)
    found = plan(planner(name), Sea(basin(WALL), 3.0), START, GOAL, 5, BUDGET_S)
    assert isinstance(found, Failed)
    assert found.reason


@pytest.mark.parametrize("name", PEERS)
def test_a_budget_that_is_over_is_a_failure(name: str) -> None:
    needs_ompl(name)
    found = plan(planner(name), Sea(basin(ROCK), 3.0), START, GOAL, 5, -1.0)
    assert isinstance(found, Failed)
    assert found.reason == "out of time"


def test_a_path_that_does_not_keep_the_clearance_is_a_failure() -> None:
    def straight_on(sea: Sea, start: Point, goal: Point, seed: int, deadline: Deadline) -> Path:
        return (start, goal)

    def elsewhere(sea: Sea, start: Point, goal: Point, seed: int, deadline: Deadline) -> Path:
        return (start, Point(-30.0, 5.0))

    sea = Sea(basin(ROCK), 3.0)
    found = plan(straight_on, sea, START, GOAL, 0, BUDGET_S)
    assert isinstance(found, Failed)
    assert found.reason == "the path does not keep the clearance"
    found = plan(elsewhere, sea, START, GOAL, 0, BUDGET_S)
    assert isinstance(found, Failed)
    assert found.reason == "the path does not join start and goal"


def test_the_belief_roadmap_goes_round_where_the_roadmap_would_go_through_a_shadow(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(roadmap, "SAMPLES", 1200)
    # A canal 60 m long and 10 m wide leaves a metre beside the clearance, but there is no GNSS in it.
    banks = (shapely.box(-60.0, -30.0, -5.0, 30.0), shapely.box(5.0, -30.0, 20.0, 30.0))
    start, goal = Point(-40.0, 0.0), Point(40.0, 0.0)
    sea = Sea(basin(*banks), 4.0)
    through = plan(planner("PRM"), sea, start, goal, 3, BUDGET_S)
    assert isinstance(through, Planned)
    assert max(point.east_m for point in through.points) < 6.0
    around = plan(planner("belief roadmap"), sea, start, goal, 3, BUDGET_S)
    assert isinstance(around, Planned)
    assert max(point.east_m for point in around.points) > 20.0


def test_pruning_keeps_only_what_the_line_of_sight_needs() -> None:
    sea = Sea(basin(ROCK), 3.0)
    corners = (Point(-30.0, 25.0), Point(30.0, 25.0))
    path = (START, Point(-30.0, 12.0), corners[0], Point(0.0, 25.0), Point(20.0, 25.0), corners[1], GOAL)
    assert pruned(sea, path) == (START, *corners, GOAL)


def test_pheromone_that_evaporates_whole_leaves_ants_without_memory() -> None:
    sea = Sea(basin(ROCK), 3.0)
    lengths = []
    for habits in (Habits(lambda _: 0.3), Habits(lambda _: 1.0)):
        path = colony(sea, START, GOAL, 1, Deadline(BUDGET_S), habits)
        lengths.append(path_length_m(path))
    assert lengths[0] < lengths[1]
    assert math.isfinite(lengths[1])
