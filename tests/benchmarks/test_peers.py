"""The comparison planners: valid paths or honest failures, and the same path for the same seed."""

from importlib.util import find_spec

import pytest
import shapely

from benchmarks.peers import PEERS, ants, roadmap
from benchmarks.peers.interface import Deadline, Failed, Path, Planned, Sea, plan
from companion.core.geo import LatLon, LocalFrame, Point
from mission_tools.maps.chart import Chart, Feature, build_chart

BUDGET_S = 600.0
START, GOAL = Point(-30.0, 0.0), Point(30.0, 0.0)
ROCK = shapely.box(-25.0, -10.0, 20.0, 10.0)
WALL = shapely.box(-60.0, -2.0, 60.0, 2.0)
NEEDS_OMPL = pytest.mark.skipif(find_spec("ompl") is None, reason="OMPL is in the extra `bench`")
NAMES = [pytest.param(name, marks=NEEDS_OMPL if name == "RRT*" else ()) for name in PEERS]


def basin(obstacle: shapely.Polygon) -> Chart:
    """100 m square."""
    water, frame = shapely.box(-50.0, -50.0, 50.0, 50.0), LocalFrame(LatLon(50.0, 0.0))
    return build_chart("basin", frame, water, [Feature("Rock", "obstacle", obstacle)])


@pytest.fixture(autouse=True)
def few_iterations(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ants, "ITERATIONS", 12)
    monkeypatch.setattr(roadmap, "SAMPLES", 300)


@pytest.mark.parametrize("name", NAMES)
def test_a_path_round_a_rock_is_valid_longer_than_the_exact_one_and_the_same_for_its_seed(name: str) -> None:
    sea = Sea(basin(ROCK), 3.0)
    found, again = (plan(PEERS[name], sea, START, GOAL, 5, BUDGET_S) for _ in range(2))
    assert isinstance(found, Planned), found
    assert (found.points[0], found.points[-1]) == (START, GOAL)
    line = shapely.LineString([(point.east_m, point.north_m) for point in found.points])
    assert sea.chart.shores.distance(line) >= 3.0 - 1e-6
    exact_m = sea.water.routes(3.0).route(START, GOAL).length_m
    assert exact_m - 1e-6 <= found.length_m <= 1.6 * exact_m
    assert found.length_m == pytest.approx(line.length)
    assert isinstance(again, Planned)
    assert again.points == found.points


@pytest.mark.parametrize("name", NAMES)
def test_without_a_way_or_in_no_time_every_planner_says_so(name: str) -> None:
    assert isinstance(plan(PEERS[name], Sea(basin(WALL), 3.0), START, GOAL, 5, BUDGET_S), Failed)
    late = plan(PEERS[name], Sea(basin(ROCK), 3.0), START, GOAL, 5, -1.0)
    assert isinstance(late, Failed)
    assert late.reason == "out of time"


@pytest.mark.parametrize(
    ("end", "reason"),
    [(GOAL, "the path does not keep the clearance"), (START, "the path does not join start and goal")],
)
def test_a_path_over_a_rock_or_to_another_place_is_a_failure(end: Point, reason: str) -> None:
    def straight_on(
        sea: Sea, start: Point, goal: Point, seed: int, deadline: Deadline, effort: float
    ) -> Path:
        return (start, end)

    found = plan(straight_on, Sea(basin(ROCK), 3.0), START, GOAL, 0, BUDGET_S)
    assert isinstance(found, Failed)
    assert found.reason == reason
