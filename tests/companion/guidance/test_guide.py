"""What is held along a path, a circle and a course, by hand-calculated figures.

Speed 2 m/s, deceleration 0.4 m/s², response of the speed 1 s; course and speed are seen 0.1 s ahead.
"""

import math

import pytest
from msgspec.structs import replace

from companion.config.boat_config import BoatConfig, with_value
from companion.core.geo import Point
from companion.core.intent import FollowCircle, FollowLeg, HoldCourse, HoldHeading, HoldTurn, Intent
from companion.core.state import Demand, NavState
from companion.guidance.path_following import PathFollowing
from companion.guidance.pilot import Pilot, Turning

CONFIG = BoatConfig()
TURNING_S = math.pi / 0.65 + 0.6
NORTHBOUND = NavState(0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 2.0, 0.0, 0.1, 0.02)
LEG = FollowLeg(Point(0.0, 0.0), Point(100.0, 0.0), 2.0)


def demanded(intent: Intent, nav: NavState) -> Demand:
    demand = Pilot().update(intent, nav, CONFIG, 0.02)
    assert isinstance(demand, Demand)
    return demand


def braked_m_s(to_go_m: float) -> float:
    return math.sqrt(0.8 * to_go_m)


# Along a path


@pytest.mark.parametrize("to_go_m", [3.5, 5.0, 6.5])
def test_before_the_end_speed_and_later_speed_are_those_of_even_braking(to_go_m: float) -> None:
    guide = PathFollowing().update(LEG, replace(NORTHBOUND, north_m=100.0 - to_go_m), CONFIG)
    assert guide.speed_m_s == pytest.approx(braked_m_s(to_go_m - 2.0))
    assert guide.later_speed_m_s == pytest.approx(braked_m_s(to_go_m - 2.2))
    assert (guide.tangent_rad, guide.course_rad, guide.later_course_rad) == (0.0, 0.0, 0.0)
    assert guide.stops


@pytest.mark.parametrize(("asked_m_s", "speed_m_s"), [(2.0, 0.4), (0.3, 0.3)])
def test_at_the_end_steerage_way_is_left_unless_less_is_asked_for(asked_m_s: float, speed_m_s: float) -> None:
    guide = PathFollowing().update(leg_at(asked_m_s), replace(NORTHBOUND, north_m=99.5), CONFIG)
    assert (guide.speed_m_s, guide.later_speed_m_s) == (speed_m_s, speed_m_s)


def leg_at(speed_m_s: float) -> FollowLeg:
    return FollowLeg(LEG.start, LEG.end, speed_m_s)


@pytest.mark.parametrize(
    ("next_end", "stops"),
    [(Point(100.0, 50.0), False), (Point(200.0, 0.0), False), (Point(50.0, 0.5), True), (None, True)],
)
def test_a_path_stops_at_its_end_or_for_a_turn_back(next_end: Point | None, stops: bool) -> None:
    leg = FollowLeg(LEG.start, LEG.end, 2.0, next_end)
    assert PathFollowing().update(leg, replace(NORTHBOUND, north_m=50.0), CONFIG).stops is stops


@pytest.mark.parametrize(("axis", "sign"), [("north", 1.0), ("north", -1.0), ("east", 1.0), ("east", -1.0)])
@pytest.mark.parametrize(("change_m_s", "is_new"), [(0.099, False), (0.101, True)])
def test_a_change_of_the_current_in_any_direction_makes_a_new_path(
    axis: str, sign: float, change_m_s: float, is_new: bool
) -> None:
    following, far = PathFollowing(), replace(NORTHBOUND, north_m=40.0)
    following.update(LEG, far, CONFIG)
    first = following._plan
    following.update(LEG, replace(far, **{f"current_{axis}_m_s": sign * change_m_s}), CONFIG)
    assert (following._plan is not first) is is_new


def test_once_a_fillet_is_sailed_out_another_current_makes_a_new_path() -> None:
    corner, last = Point(100.0, 0.0), Point(100.0, 50.0)
    first = FollowLeg(Point(0.0, 0.0), corner, 2.0, last, 0.0, (Point(150.0, 50.0),))
    second = FollowLeg(corner, last, 2.0, Point(150.0, 50.0))
    middle = replace(
        NORTHBOUND, north_m=99.34, east_m=0.66, heading_rad=math.pi / 4, north_m_s=0.9, east_m_s=0.9
    )
    following = PathFollowing()
    following.update(first, replace(NORTHBOUND, north_m=90.0), CONFIG)
    following.update(first, middle, CONFIG)
    following.update(second, middle, CONFIG)
    assert following._plan is not None
    assert following._plan.at == 1, "the fillet is under way"
    beyond = replace(
        middle, north_m=100.0, east_m=25.0, heading_rad=math.pi / 2, north_m_s=0.0, east_m_s=2.0,
        current_east_m_s=0.5,
    )  # fmt: skip
    following.update(second, beyond, CONFIG)
    assert following._plan.at == 0
    assert following._plan.current_east_m_s == 0.5


@pytest.mark.parametrize(("current_m_s", "to_go_m", "turns"), [
    (1.0, TURNING_S + 0.2, False), (1.0, TURNING_S - 0.1, True), (1.0, TURNING_S + 0.8, False),
    (0.21, 0.21 * TURNING_S - 0.05, True), (0.19, 0.19 * TURNING_S - 0.05, False),
])  # fmt: skip
def test_down_a_current_the_boat_turns_where_the_turn_carries_it_onto_the_end(
    current_m_s: float, to_go_m: float, turns: bool
) -> None:
    nav = replace(NORTHBOUND, north_m=100.0 - to_go_m, current_north_m_s=current_m_s)
    heading = demanded(LEG, nav).heading_rad
    assert abs(heading) == pytest.approx(math.pi if turns else 0.0, abs=1e-6)


@pytest.mark.parametrize("before_m", [3.5, 3.2, 2.9])
def test_in_a_fillet_the_course_leads_by_hull_and_loop_and_its_rate_by_the_motors_more(
    before_m: float,
) -> None:
    leg = FollowLeg(LEG.start, LEG.end, 2.0, Point(100.0, 50.0))
    nav = replace(NORTHBOUND, north_m=100.0 - before_m, north_m_s=1.3, surge_m_s=1.3)
    following = PathFollowing()
    guide = following.update(leg, nav, CONFIG)
    assert following._plan is not None
    path = following._plan.smooth.path
    turned_m = 100.0 - before_m + 0.4 + 0.45 * 1.3  # slip; 0.6 s of hull and loop less 0.15 s of the motors
    assert guide.course_rad == pytest.approx(path.course_rad(turned_m))
    change = path.course_rad(turned_m + 0.25 * 1.3) - path.course_rad(turned_m + 0.15 * 1.3)
    assert guide.later_course_rad - guide.course_rad == pytest.approx(change)
    assert change > 0.0


def test_the_course_of_a_hull_that_answers_faster_than_its_motors_does_not_lag() -> None:
    quick = with_value(CONFIG, "handling.yaw_time_s", 0.1)
    leg = FollowLeg(LEG.start, LEG.end, 2.0, Point(100.0, 50.0))
    nav = replace(NORTHBOUND, north_m=97.5, north_m_s=1.3, surge_m_s=1.3)
    following = PathFollowing()
    guide = following.update(leg, nav, quick)
    assert following._plan is not None
    assert guide.course_rad == pytest.approx(following._plan.smooth.path.course_rad(97.5 + 0.4))


# Round a circle


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(
    ("radius_m", "rate"), [(10.0, 0.1), (2.0, 0.5), (1.0, 0.65), (0.8, 0.65), (0.7, 0.0)]
)
def test_round_a_circle_the_turn_rate_is_speed_over_radius_as_far_as_the_hull_turns(
    side: float, radius_m: float, rate: float
) -> None:
    circle = FollowCircle(Point(0.0, side * radius_m), radius_m, side > 0.0, 1.0)
    nav = replace(NORTHBOUND, north_m_s=1.0, surge_m_s=1.0)
    demand = demanded(circle, nav)
    assert demand.yaw_rate_rad_s == pytest.approx(side * rate)
    assert (demand.cross_track_m, demand.distance_m) == pytest.approx((0.0, radius_m), abs=1e-9)


# On a course, a heading and a turn


@pytest.mark.parametrize("course_deg", [0.0, 90.0, -150.0])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_course_is_held_against_a_current_abeam(course_deg: float, side: float) -> None:
    course, crab = math.radians(course_deg), side * math.atan2(0.5, 1.0)
    nav = replace(
        NORTHBOUND, heading_rad=math.remainder(course - crab, math.tau),
        current_north_m_s=-0.5 * side * math.sin(course), current_east_m_s=0.5 * side * math.cos(course),
    )  # fmt: skip
    demand = demanded(HoldCourse(course, 1.0), nav)
    assert math.remainder(demand.heading_rad - course + crab, math.tau) == pytest.approx(0.0, abs=1e-9)
    assert demand.speed_m_s == pytest.approx(math.cos(crab)), "1 m/s over ground, seen along the bow"
    assert demand.yaw_rate_rad_s == 0.0


@pytest.mark.parametrize(
    ("off_rad", "speed_m_s"), [(0.5, 1.0), (-0.5, 1.0), (0.7875, 0.5), (1.04, 0.4), (1.06, 0.0), (-3.0, 0.0)]
)
def test_a_heading_is_turned_to_with_less_speed_the_farther_it_is_off(
    off_rad: float, speed_m_s: float
) -> None:
    nav = replace(NORTHBOUND, heading_rad=0.2)
    assert demanded(HoldHeading(0.2 + off_rad, 1.0), nav).speed_m_s == pytest.approx(speed_m_s)


def test_a_turn_rate_moves_the_heading_from_tick_to_tick_until_something_else_is_asked_for() -> None:
    pilot, turn = Pilot(), HoldTurn(0.5, 1.0)
    headings = []
    for intent in (turn, turn, HoldHeading(2.0, 1.0), turn):
        demand = pilot.update(intent, NORTHBOUND, CONFIG, 0.1)
        assert isinstance(demand, Demand)
        headings.append(demand.heading_rad)
    assert headings == pytest.approx([0.05, 0.10, 2.0, 0.05])


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_bow_that_does_not_keep_up_with_a_turn_is_led_by_a_radian_at_most(side: float) -> None:
    turning, nav = Turning(), replace(NORTHBOUND, heading_rad=side * 3.0)
    for _ in range(100):
        heading = turning.update(side * 0.5, nav, 0.1)
    assert heading == pytest.approx(side * (4.0 - math.tau)), "and the heading is wrapped"
