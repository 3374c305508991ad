"""Each term of the cost alone."""

import math
from itertools import pairwise

import pytest
from avoidance_rig import CONFIG, Lines, boat, mover
from msgspec.structs import replace

from companion.core.geo import Point
from companion.core.state import NavState
from companion.obstacles.perception.track import Track
from companion.obstacles.planning.clearance import ClearanceField
from companion.obstacles.planning.cost import CostModel
from companion.obstacles.planning.cost_to_go import CostToGo
from companion.obstacles.planning.motion import CRASH_STOP, FULL_ASTERN, CourseFan, Rollout, roll
from companion.obstacles.planning.movers import predict

NOW_S = 0.9
GOAL = Point(50.0, 0.0)


def model(
    *solid: Point,
    nav: NavState | None = None,
    suspects: tuple[Point, ...] = (),
    movers: tuple[Track, ...] = (),
    goal: Point = GOAL,
    bounds: Lines | None = None,
) -> CostModel:
    nav = nav or boat()
    field = ClearanceField(nav.point, 0.2, 9.0)
    if bounds is not None:
        field.fence(bounds, 1.0)
    field.fill(list(solid), [*solid, *suspects], 0.35)
    course = math.atan2(goal.east_m, goal.north_m)
    found = predict(list(movers), 0, nav, (math.cos(course), math.sin(course)), field, 1.0, 0.6, NOW_S)
    to_go = CostToGo(field, nav.point, goal, 1.0, 0.6)
    return CostModel(nav, field, to_go, found, 1.0, 5.0, course, CONFIG)


def to(deg: float, speed_m_s: float = 1.0) -> Rollout:
    return roll(1.0, 0.0, math.radians(deg), speed_m_s, CONFIG)


def test_progress_is_the_share_of_the_way_that_is_left() -> None:
    costs = model()
    ahead, slow, still = (costs.plain(to(0.0, speed), None) for speed in (1.0, 0.4, 0.0))
    assert still - ahead == pytest.approx((to(0.0).ahead_m[-1] - to(0.0, 0.0).ahead_m[-1]) / 5.0, abs=0.05)
    assert ahead < slow < still


@pytest.mark.parametrize("goal", [Point(0.0, 50.0), Point(50.0, 0.0), Point(0.0, -50.0)])
def test_a_current_towards_the_goal_leaves_less_way(goal: Point) -> None:
    north, east = goal.north_m / 100.0, goal.east_m / 100.0
    left = []
    for sign in (-1.0, 0.0, 1.0):
        nav = replace(boat(), current_north_m_s=sign * north, current_east_m_s=sign * east)
        left.append(model(nav=nav, goal=goal).plain(to(0.0), None))
    assert left[0] > left[1] + 0.2 > left[2] + 0.4


def test_port_costs_a_little_more_and_much_more_with_a_mover() -> None:
    alone, met = model(), model(movers=(mover(30.0, 0.0),))
    assert 0.03 < alone.plain(to(-30.0), None) - alone.plain(to(30.0), None) < 0.1
    assert 0.9 < met.plain(to(-30.0), None) - met.plain(to(30.0), None) < 1.2


def test_astern_and_a_crash_stop_cost_extra() -> None:
    costs, still = model(), to(0.0, 0.0)._replace(bow_rad=math.pi)
    base = costs.plain(still, None) - 1.0 / 5.0
    assert costs.plain(still._replace(speed_m_s=-0.4), None) - base == pytest.approx(0.5, abs=0.05)
    assert costs.plain(still._replace(speed_m_s=CRASH_STOP), None) - base == pytest.approx(0.1, abs=0.05)


def test_leaving_the_last_heading_or_speed_costs() -> None:
    costs = model()
    kept, left = (
        costs.plain(to(30.0), (math.radians(30.0), 1.0)),
        costs.plain(to(30.0), (math.radians(-60.0), 1.0)),
    )
    slower = costs.plain(to(30.0), (math.radians(30.0), 0.5))
    assert kept == costs.plain(to(30.0), None)
    reverses = costs.plain(to(30.0), (math.radians(30.0), -0.4))
    stops = costs.plain(to(30.0), (math.radians(30.0), CRASH_STOP))
    assert left - kept == pytest.approx(0.4)
    assert slower - kept == pytest.approx(0.15)
    assert reverses - kept == pytest.approx(0.42)
    assert stops - kept == pytest.approx(0.3)


@pytest.mark.parametrize(("aside_m", "least", "most"), [(3.0, 0.0, 0.0), (0.9, 0.01, 0.3), (0.7, 0.05, 0.8)])
def test_clearance_costs_within_the_margin_only(aside_m: float, least: float, most: float) -> None:
    assert least <= model(Point(2.5, aside_m)).risk(to(0.0)) <= most


def test_clearance_costs_more_the_nearer_without_a_jump() -> None:
    near = model()._near
    assert near[:6] == [0.0] * 6
    assert near[6:9] == pytest.approx([(1.0 / clear_m - 1.0) ** 2 for clear_m in (0.8, 0.6, 0.4)])
    assert all(after > before for before, after in pairwise(near[5:10]))


def test_the_bow_and_the_current_move_the_rollout() -> None:
    east = boat(heading_rad=math.pi / 2)
    assert model(Point(0.1, 3.1), nav=east, goal=Point(0.0, 50.0)).risk(to(0.0)) > 5.0
    assert model(Point(3.1, 0.1), nav=east, goal=Point(0.0, 50.0)).risk(to(0.0)) == 0.0
    carried = replace(boat(), current_east_m_s=0.5)
    assert model(Point(2.1, 1.1), nav=carried).risk(to(0.0)) > 5.0
    assert model(Point(2.1, 1.1)).risk(to(0.0)) < 0.1


@pytest.mark.parametrize("heading_deg", [30.0, 115.0, 200.0, -50.0])
def test_a_turn_ahead_leads_to_the_same_place_whichever_way_the_bow_points(heading_deg: float) -> None:
    heading_rad, turned = math.radians(heading_deg), to(60.0)
    bearing_rad = heading_rad + math.atan2(turned.right_m[-1], turned.ahead_m[-1])
    end = Point(0.1, 0.1).moved(bearing_rad, math.hypot(turned.right_m[-1], turned.ahead_m[-1]))
    goal, nav = Point(0.0, 0.0).moved(heading_rad, 50.0), boat(0.1, 0.1, heading_rad=heading_rad)
    costs = model(end, nav=nav, goal=goal)
    assert costs.risk(turned) > 5.0
    assert costs.risk(to(-60.0)) == 0.0


def test_the_fence_is_a_touch_for_rollouts_unless_the_boat_is_beyond_it() -> None:
    assert model(bounds=Lines(-9.0, 2.0)).risk(to(90.0)) > 5.0
    assert model(bounds=Lines(-9.0, 9.0)).risk(to(90.0)) == 0.0
    assert model(bounds=Lines(-9.0, -1.0)).risk(to(-90.0)) == 0.0


def test_an_expensive_rollout_is_abandoned() -> None:
    costs = model(Point(1.0, 0.0), movers=(mover(2.0, 0.0),))
    assert 0.1 < costs.risk(to(0.0), 0.1) < costs.risk(to(0.0))


def test_the_cheapest_rollout_is_chosen() -> None:
    costs, path = model(Point(3.1, 0.1)), ([0.25 * (step + 1) for step in range(20)], [0.0] * 20)
    best = costs.choose(CourseFan(), 1.0, path, None, is_certain=True, is_new=False)
    assert best is not None
    assert abs(best.turn_rad) > 0.1
    assert costs.risk(best) < 1.0
    assert model(Point(3.1, 3.1)).choose(CourseFan(), 1.0, path, None, is_certain=True, is_new=False) is None


def test_a_path_that_leads_nowhere_is_not_kept() -> None:
    costs = model(Point(3.1, 3.1))
    best = costs.choose(CourseFan(), 1.0, None, None, is_certain=True, is_new=False)
    assert best is not None
    assert best.turn_rad == pytest.approx(0.0)


def test_nothing_is_braked_for_a_single_echo() -> None:
    wall = tuple(Point(2.0, -3.0 + 0.2 * step) for step in range(31))
    path = ([0.25 * (step + 1) for step in range(20)], [0.0] * 20)
    nav = boat(speed_m_s=1.5)
    sure = model(*wall, nav=nav).choose(CourseFan(), 1.5, path, None, is_certain=True, is_new=False)
    unsure = model(suspects=wall, nav=nav).choose(
        CourseFan(), 1.5, path, None, is_certain=False, is_new=False
    )
    assert sure is not None
    assert sure.speed_m_s == CRASH_STOP
    assert unsure is None or unsure.speed_m_s >= 0.0
    close = boat(1.4, speed_m_s=0.0)
    back = model(*wall, nav=close).choose(CourseFan(), 1.0, None, None, is_certain=True, is_new=False)
    stay = model(suspects=wall, nav=close).choose(
        CourseFan(), 1.0, None, None, is_certain=False, is_new=False
    )
    assert back is not None
    assert back.speed_m_s < 0.0
    assert stay is not None
    assert stay.speed_m_s >= 0.0


def test_a_boat_at_rest_backs_away_from_what_comes_straight_at_it() -> None:
    nav = replace(boat(), north_m_s=0.0, surge_m_s=0.0)
    costs = model(nav=nav, movers=(mover(2.5, 0.0, -0.8, 0.0),))
    best = costs.choose(CourseFan(), 1.0, None, None, is_certain=True, is_new=False)
    assert best is not None
    assert best.speed_m_s == FULL_ASTERN
    unsure = costs.choose(CourseFan(), 1.0, None, None, is_certain=False, is_new=False)
    assert unsure is not None
    assert unsure.speed_m_s >= 0.0
