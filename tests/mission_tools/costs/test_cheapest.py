"""Routes by time in a river: along the bank against it, never slower than the shortest, or refused."""

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import pytest
import shapely

from companion.core.geo import LatLon, LocalFrame, Point, path_length_m
from mission_tools.costs.cheapest import _STEPS as STEPS
from mission_tools.costs.cheapest import _lattice, _search, cheapest_route
from mission_tools.costs.current import River
from mission_tools.costs.legs import route_cost
from mission_tools.costs.polish import Polish, _with_middles
from mission_tools.costs.travel import BoatSpeed, Floats, InZones, OpenWater, SpeedZone, TravelTime
from mission_tools.errors import NoRoute
from mission_tools.maps.chart import Chart, Feature, build_chart
from mission_tools.planning.planner import PlanSettings, plan

pytestmark = pytest.mark.slow

FRAME = LocalFrame(LatLon(50.0, 10.0))
CLEARANCE_M = 4.0
RIVER = River((Point(30.0, 0.0), Point(30.0, 400.0)), 60.0, 1.0)


@pytest.fixture(autouse=True)
def coarse(monkeypatch: pytest.MonkeyPatch) -> None:
    """A lattice that is searched in a fifth of the time."""
    monkeypatch.setattr("mission_tools.costs.cheapest.LATTICE_CELLS", 10_000)


def channel(*islands: shapely.Polygon) -> Chart:
    features = [Feature(f"island {n}", "island", shape) for n, shape in enumerate(islands, 1)]
    return build_chart("river", FRAME, shapely.box(0.0, 0.0, 400.0, 60.0), features)


def shortest(chart: Chart, start: Point, goal: Point) -> tuple[Point, ...]:
    return plan(chart, start, goal, PlanSettings(clearance_m=CLEARANCE_M)).points


def keeps_clear(chart: Chart, points: Sequence[Point]) -> bool:
    return all(chart.leg_clearance_m(a, b) >= CLEARANCE_M - 1e-6 for a, b in pairwise(points))


def test_against_the_stream_it_goes_along_the_bank_and_with_it_down_the_middle() -> None:
    chart, low, high = channel(), Point(30.0, 10.0), Point(30.0, 390.0)
    travel = TravelTime(BoatSpeed(1.5, 1.6), RIVER)
    up = cheapest_route(chart, (high, low), CLEARANCE_M, travel)
    assert all(p.north_m < 5.0 or p.north_m > 55.0 for p in up.points if 30.0 < p.east_m < 373.0)
    assert up.points[2].north_m == pytest.approx(up.points[3].north_m, abs=1.0)
    assert keeps_clear(chart, up.points)
    assert up.shortest_cost == pytest.approx(380.0 / 0.6)
    assert up.cost < 0.55 * up.shortest_cost
    assert len(up.points) <= 8
    down = cheapest_route(chart, (low, high), CLEARANCE_M, travel)
    assert down.points == (low, high)
    assert down.cost == down.shortest_cost == pytest.approx(380.0 / 1.5)


def test_the_lattice_has_sixteen_directions_18_to_27_degrees_apart() -> None:
    courses = sorted(
        math.degrees(math.atan2(right, up)) % 360.0
        for step in STEPS
        for up, right in (step, (-step[0], -step[1]))
    )
    gaps = [after - before for before, after in pairwise([*courses, courses[0] + 360.0])]
    assert len(gaps) == 16
    assert min(gaps) > 18.4
    assert max(gaps) < 26.6
    assert max(math.hypot(*step) for step in STEPS) == pytest.approx(math.sqrt(5.0))


class Slope:
    """A metre costs the more the farther north it is sailed."""

    unit = "s"
    varies = False

    @property
    def pace(self) -> "Slope":
        return self

    def per_m(self, north_m: Floats, east_m: Floats, course_rad: Floats, time_s: Floats) -> Floats:
        return 1.0 + 0.01 * north_m + 0.001 * east_m + 0.0 * (course_rad + time_s)


def test_a_legs_cost_is_that_of_its_middle_where_a_metre_costs_evenly_more() -> None:
    here, there = Point(10.0, 20.0), Point(110.0, -55.0)
    assert route_cost(Slope(), (here, there, there)) == pytest.approx(125.0 * (1.0 + 0.6 - 0.0175))
    assert route_cost(Slope(), (there, here), 1000.0) == pytest.approx(125.0 * (1.0 + 0.6 - 0.0175))


def test_the_lattices_way_is_hardly_longer_than_the_straight_one_whatever_its_course() -> None:
    chart, middle = build_chart("pond", FRAME, shapely.box(-60.0, -60.0, 60.0, 60.0), ()), Point(1.0, 2.0)
    travel = TravelTime(BoatSpeed(1.0, 2.0))
    for course in np.arange(0.0, 2.0 * math.pi, math.pi / 12.0):
        goal = Point(40.0 * math.cos(course), 40.0 * math.sin(course))
        found = _search(_lattice(chart, (middle, goal), 2.0), travel, middle, goal, lambda a, b: True)
        assert found is not None
        assert path_length_m(found[0]) < 1.04 * math.dist(middle, goal) + 1.0
        assert max(math.dist(a, b) for a, b in pairwise(found[0])) < 2.5


def test_a_long_leg_gets_a_corner_in_its_middle_to_try() -> None:
    short, long = Point(0.0, 3.0), Point(8.0, 3.0)
    assert _with_middles((Point(0.0, 0.0), short, long), 4.0) == (
        Point(0.0, 0.0),
        short,
        Point(4.0, 3.0),
        long,
    )


def test_it_is_never_slower_than_the_shortest_route() -> None:
    rng = np.random.default_rng(8)
    for _ in range(2):
        islands = [
            shapely.Point(rng.uniform(60, 340), rng.uniform(10, 50)).buffer(rng.uniform(3.0, 9.0), 4)
            for _ in range(3)
        ]
        chart = channel(*islands)
        ends = [Point(rng.uniform(6, 54), 20.0), Point(rng.uniform(6, 54), 380.0)]
        start, goal = ends if rng.random() < 0.5 else ends[::-1]
        travel = TravelTime(BoatSpeed(1.2, 1.5), RIVER)
        direct = shortest(chart, start, goal)
        found = cheapest_route(chart, direct, CLEARANCE_M, travel)
        assert (found.points[0], found.points[-1]) == (start, goal)
        assert keeps_clear(chart, found.points)
        # Both measured again, by finer steps than the planner's
        assert route_cost(travel, found.points, 0.1) <= route_cost(travel, direct, 0.1) * (1.0 + 1e-3)


def test_a_current_that_is_too_strong_everywhere_is_refused_with_the_place() -> None:
    chart, start, goal = channel(), Point(30.0, 390.0), Point(30.0, 10.0)
    with pytest.raises(NoRoute, match=r"too strong .* first at 50\.\d+,10\.\d+, 0 m along"):
        cheapest_route(chart, (start, goal), CLEARANCE_M, TravelTime(BoatSpeed(0.2, 0.3), RIVER))


def test_what_cannot_be_stemmed_in_the_middle_is_stemmed_at_the_bank() -> None:
    chart, start, goal = channel(), Point(6.0, 390.0), Point(6.0, 10.0)
    through_middle = (start, Point(30.0, 200.0), goal)
    found = cheapest_route(chart, through_middle, CLEARANCE_M, TravelTime(BoatSpeed(0.8, 0.9), RIVER))
    assert found.shortest_cost == math.inf
    assert math.isfinite(found.cost)


def test_a_slow_zone_is_gone_round_where_that_saves_time() -> None:
    chart, start, goal = channel(), Point(30.0, 20.0), Point(30.0, 380.0)
    zone = SpeedZone(shapely.box(150.0, 20.0, 250.0, 60.0), 0.3)
    travel = InZones(TravelTime(BoatSpeed(1.5, 2.0)), (zone,))
    found = cheapest_route(chart, (start, goal), CLEARANCE_M, travel)
    assert found.cost < 0.55 * found.shortest_cost
    assert all(not zone.area.buffer(-2.0).contains(shapely.Point(p.east_m, p.north_m)) for p in found.points)


def test_open_water_is_preferred_where_it_is_near() -> None:
    island = shapely.box(150.0, 0.0, 200.0, 20.0)
    chart, start, goal = channel(island), Point(30.0, 120.0), Point(30.0, 230.0)
    hugging = (start, Point(24.5, 150.0), Point(24.5, 200.0), goal)

    def room_m(north_m: Floats, east_m: Floats) -> Floats:
        distances: Floats = shapely.distance(chart.shores, shapely.points(east_m, north_m))
        return distances

    travel = OpenWater(TravelTime(BoatSpeed(1.5, 2.0)), room_m, weight=4.0, scale_m=6.0)
    found = cheapest_route(chart, hugging, CLEARANCE_M, travel)
    least = min(chart.leg_clearance_m(a, b) for a, b in pairwise(found.points))
    assert least > 9.0
    assert path_length_m(found.points) < 1.05 * 110.0


def test_what_asks_for_more_clearance_is_given_it_in_a_current_too() -> None:
    beach = Feature("beach", "keep_out", shapely.box(180.0, 0.0, 220.0, 6.0), {"clearance_m": 15.0})
    chart = build_chart("river", FRAME, shapely.box(0.0, 0.0, 400.0, 60.0), [beach])
    low_bank = River((Point(45.0, 0.0), Point(45.0, 400.0)), 60.0, 1.0)  # none at the beach's side
    direct = shortest(chart, Point(10.0, 380.0), Point(10.0, 20.0))
    found = cheapest_route(chart, direct, CLEARANCE_M, TravelTime(BoatSpeed(1.5, 1.6), low_bank))
    line = shapely.LineString([(p.east_m, p.north_m) for p in found.points])
    assert line.distance(beach.shape) >= 15.0 - 1e-6


def test_a_start_at_the_jetty_keeps_its_way_out() -> None:
    chart, jetty = channel(), Point(1.0, 200.0)
    direct = shortest(chart, jetty, Point(30.0, 20.0))
    found = cheapest_route(chart, direct, CLEARANCE_M, TravelTime(BoatSpeed(1.2, 1.5), RIVER))
    assert found.points[:2] == direct[:2]
    assert keeps_clear(chart, found.points[1:])


def test_corners_move_only_where_both_their_legs_are_clear() -> None:
    chart = channel(shapely.box(150.0, 10.0, 250.0, 40.0))
    polish = Polish(chart, CLEARANCE_M, TravelTime(BoatSpeed(1.5, 1.6)), 2.0)
    loose = (Point(20.0, 10.0), Point(55.0, 140.0), Point(55.0, 260.0), Point(20.0, 390.0))
    taut = polish.improved(loose)
    assert polish.is_sailable(taut)
    assert polish.cost(taut) < polish.cost(loose)
    exact_m = path_length_m(shortest(chart, loose[0], loose[-1]))
    assert exact_m <= path_length_m(taut) <= 1.02 * exact_m


def test_the_lattice_keeps_the_clearance_that_a_feature_asks_for_itself() -> None:
    rock = shapely.box(190.0, 25.0, 210.0, 35.0)
    rows = []
    for own_m in (9.0, 1.0):
        feature = Feature("rock", "obstacle", rock, {"clearance_m": own_m})
        chart = build_chart("river", FRAME, shapely.box(0.0, 0.0, 400.0, 60.0), [feature])
        grid = _lattice(chart, (Point(30.0, 10.0), Point(30.0, 390.0)), CLEARANCE_M)
        east_m, north_m = grid.centres()
        row, column = np.nonzero(grid.free)
        off_m = shapely.distance(shapely.points(east_m[column], north_m[row]), rock)
        rows.append(off_m.min())
    assert 9.0 <= rows[0] < 11.0
    assert CLEARANCE_M <= rows[1] < 6.5
