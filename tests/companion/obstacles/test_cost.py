"""Each term of the cost alone."""

import math

import pytest
from avoidance_rig import CONFIG, Lines, boat, mover
from msgspec.structs import replace

from companion.core.geo import Point
from companion.core.state import NavState
from companion.obstacles.perception.track import Track
from companion.obstacles.planning.clearance import ClearanceField
from companion.obstacles.planning.cost import CostModel
from companion.obstacles.planning.motion import CRASH_STOP, STEP_S, Rollout, roll
from companion.obstacles.planning.movers import predict_movers

NOW_S = 0.9
AHEAD = Point(5.0, 0.0)


def model(
    *solid: Point,
    nav: NavState | None = None,
    suspects: tuple[Point, ...] = (),
    movers: tuple[Track, ...] = (),
    target: Point = AHEAD,
    bounds: Lines | None = None,
) -> CostModel:
    nav = nav or boat()
    field = ClearanceField(nav.point, 0.2, 9.0)
    if bounds is not None:
        field.fence(bounds, 1.0)
    field.fill(list(solid), [*solid, *suspects], 0.35)
    found = predict_movers(list(movers), nav, field, 1.0, NOW_S)
    return CostModel(nav, field, found, 1.0, 1.0, target, CONFIG)


def to(deg: float, speed_m_s: float = 1.0) -> Rollout:
    return roll(1.0, 0.0, math.radians(deg), speed_m_s, CONFIG)


def test_progress_costs_nothing_straight_to_the_target_and_a_unit_at_rest() -> None:
    costs = model()
    assert costs.plain(to(0.0), None) < 0.15
    assert 0.5 < costs.plain(to(0.0, 0.0), None) < 1.0
    assert costs.plain(to(0.0), None) < costs.plain(to(0.0, 0.6), None) < costs.plain(to(0.0, 0.4), None)


def test_a_wider_turn_costs_more() -> None:
    costs = model()
    found = [costs.plain(to(deg), None) for deg in (0.0, 15.0, 30.0, 60.0, 90.0)]
    assert found == sorted(found)


def test_the_bow_towards_the_target_counts_where_the_place_is_the_same() -> None:
    costs, still = model(target=Point(0.0, 5.0)), to(0.0, 0.0)
    assert costs.plain(still._replace(bow_rad=math.pi / 2), None) < costs.plain(still, None) - 0.1


def test_port_costs_a_little_more_and_much_more_with_a_mover() -> None:
    alone, met = model(), model(movers=(mover(30.0, 0.0),))
    assert 0.03 < alone.plain(to(-30.0), None) - alone.plain(to(30.0), None) < 0.1
    assert 0.2 < met.plain(to(-30.0), None) - met.plain(to(30.0), None) < 0.4


def test_astern_and_a_crash_stop_cost_extra() -> None:
    costs, still = model(), to(0.0, 0.0)
    base = costs.plain(still, None)
    assert costs.plain(still._replace(speed_m_s=-0.4), None) - base == pytest.approx(0.5)
    assert costs.plain(still._replace(speed_m_s=CRASH_STOP), None) - base == pytest.approx(1.0)


def test_leaving_the_last_heading_costs() -> None:
    costs = model()
    kept, left = costs.plain(to(30.0), math.radians(30.0)), costs.plain(to(30.0), math.radians(-60.0))
    assert kept == costs.plain(to(30.0), None)
    assert left - kept == pytest.approx(1.0)


@pytest.mark.parametrize(("aside_m", "least", "most"), [(3.0, 0.0, 0.0), (0.9, 0.01, 0.3), (0.7, 0.05, 0.8)])
def test_clearance_costs_within_the_margin_only(aside_m: float, least: float, most: float) -> None:
    danger = model(Point(2.5, aside_m)).danger(to(0.0))
    assert least <= danger.risk <= most
    assert danger.hit_s == math.inf


def test_nearer_costs_more() -> None:
    found = [model(Point(2.5, aside)).danger(to(0.0)).risk for aside in (0.1, 0.5, 0.7, 0.9, 1.5)]
    assert found == sorted(found, reverse=True)
    assert found[0] > 3.0


def test_a_touch_of_something_certain_has_a_time_and_one_of_a_suspect_has_none() -> None:
    rock = Point(3.1, 0.1)
    certain = model(rock).danger(to(0.0))
    suspect = model(suspects=(rock,)).danger(to(0.0))
    assert certain.hit_s == pytest.approx(2.75, abs=0.3)
    assert suspect.hit_s == math.inf
    assert suspect.risk == pytest.approx(certain.risk)


def test_a_sooner_touch_costs_more() -> None:
    assert model(Point(2.0, 0.0)).danger(to(0.0)).risk > model(Point(4.0, 0.0)).danger(to(0.0)).risk + 0.5


def test_the_bow_and_the_current_move_the_rollout() -> None:
    east = boat(heading_rad=math.pi / 2)
    assert model(Point(0.1, 3.1), nav=east, target=Point(0.0, 5.0)).danger(to(0.0)).hit_s < 4.0
    assert model(Point(3.1, 0.1), nav=east, target=Point(0.0, 5.0)).danger(to(0.0)).hit_s == math.inf
    carried = replace(boat(), current_east_m_s=0.5)
    assert model(Point(2.1, 1.1), nav=carried).danger(to(0.0)).hit_s < 3.0
    assert model(Point(2.1, 1.1)).danger(to(0.0)).hit_s == math.inf


def test_leaving_something_too_near_is_no_touch() -> None:
    costs = model(Point(-0.1, 0.1))
    assert costs.danger(to(0.0)).hit_s == math.inf
    assert costs.danger(roll(0.0, 0.0, 0.0, -0.4, CONFIG)).risk > costs.danger(to(0.0)).risk


def test_the_fence_is_a_touch_unless_the_boat_is_beyond_it() -> None:
    assert model(bounds=Lines(-9.0, 2.0)).danger(to(90.0)).hit_s < 5.0
    assert model(bounds=Lines(-9.0, 9.0)).danger(to(90.0)).hit_s == math.inf
    assert model(bounds=Lines(-9.0, -1.0)).danger(to(-90.0)).hit_s == math.inf


def test_the_boat_can_stop_before_what_is_far_enough() -> None:
    costs = model()
    assert costs.can_stop(math.inf, 3.0)
    assert costs.can_stop(2.4, 1.0)
    assert not costs.can_stop(2.0, 1.0)
    assert costs.can_stop(1.5, 0.4)


def test_a_path_is_rated_like_a_rollout() -> None:
    costs = model(Point(3.1, 0.1))
    places = [0.25 * (step + 1) for step in range(20)]
    assert costs.danger_on(places, [0.0] * 20).hit_s == pytest.approx(2.75, abs=0.3)
    assert costs.danger_on([0.0] * 20, places).hit_s == math.inf


def test_an_expensive_rollout_is_abandoned_before_its_movers() -> None:
    costs = model(Point(1.0, 0.0), movers=(mover(2.0, 0.0),))
    assert costs.danger(to(0.0), 0.1).risk < costs.danger(to(0.0)).risk


def test_a_mover_is_met_where_it_will_be() -> None:
    crosses = mover(3.0, -3.0, 0.0, 1.0)
    gone = mover(3.0, -3.0, 0.0, -1.0)
    assert model(movers=(crosses,)).danger(to(0.0)).risk > 2.0
    assert model(movers=(gone,)).danger(to(0.0)).risk < 0.3


def test_passing_ahead_of_a_mover_costs_more_than_astern_of_it() -> None:
    costs = model(movers=(mover(3.0, -1.8, 0.0, 0.4),))
    astern = model(movers=(mover(3.0, 1.8, 0.0, 0.4),))
    assert costs.danger(to(0.0)).risk > astern.danger(to(0.0)).risk + 0.3


def test_a_head_on_touch_costs_more_at_speed() -> None:
    costs = model(movers=(mover(3.0, 0.0, -0.3, 0.0),))
    assert costs.danger(to(0.0)).risk > costs.danger(to(0.0, 0.4)).risk


def test_a_new_echo_may_come_or_cross() -> None:
    new = Track(1, NOW_S, Point(3.0, 1.2), 0.4)
    assert model(movers=(new,)).danger(to(0.0)).risk > 0.2
    assert model(movers=(new,)).danger(to(-60.0)).risk < model(movers=(new,)).danger(to(0.0)).risk


def test_an_echo_known_to_lie_still_is_left_to_the_grid() -> None:
    still = mover(3.0, 1.2)
    still.is_mover = still.is_likely_mover = False
    assert model(movers=(still,)).movers == []


def test_steps_are_a_quarter_of_a_second() -> None:
    assert STEP_S == 0.25
