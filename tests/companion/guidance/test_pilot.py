"""The pilot: which demand each intent leads to."""

import itertools
import math
import random

import pytest
from msgspec.structs import replace

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point
from companion.core.intent import (
    FollowCircle,
    FollowLeg,
    HoldHeading,
    HoldTurn,
    Intent,
    KeepStation,
    Stop,
)
from companion.core.state import Demand, NavState
from companion.guidance.path_following import REACH_BRAKINGS, PathFollowing
from companion.guidance.pilot import Pilot, Turning

CONFIG = BoatConfig()
DT = 0.02
NORTHBOUND = NavState(0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 2.0, 0.0, 0.1, 0.02)
LEG = FollowLeg(Point(0.0, 0.0), Point(100.0, 0.0), 2.0)
CORNER = FollowLeg(LEG.start, LEG.end, LEG.speed_m_s, Point(100.0, 50.0))


def _demand(pilot: Pilot, intent: Intent, nav: NavState) -> Demand:
    demand = pilot.update(intent, nav, CONFIG, DT)
    assert isinstance(demand, Demand)
    return demand


@pytest.mark.parametrize("intent", [LEG, KeepStation(Point(0.0, 0.0))])
def test_without_an_estimate_the_boat_stops(intent: FollowLeg | KeepStation) -> None:
    assert Pilot().update(intent, None, CONFIG, DT) == Stop()


def test_beside_the_leg_it_steers_back_and_says_how_far_off_it_is() -> None:
    demand = _demand(Pilot(), LEG, replace(NORTHBOUND, east_m=3.0))
    assert demand.heading_rad == pytest.approx(-math.atan(3.0 / CONFIG.guidance.lookahead_m))
    assert demand.cross_track_m == pytest.approx(3.0)
    assert _demand(Pilot(), LEG, replace(NORTHBOUND, east_m=-3.0)).heading_rad == -demand.heading_rad
    # Carried further off, it looks 1.2 s ahead: the heading loop's time and that of the smoothing
    carried = _demand(Pilot(), LEG, replace(NORTHBOUND, east_m=3.0, east_m_s=0.5))
    lookahead_m = CONFIG.guidance.lookahead_m * math.hypot(2.0, 0.5) / 2.0
    assert carried.heading_rad == pytest.approx(-math.atan((3.0 + 1.2 * 0.5) / lookahead_m))


def test_noise_of_the_fixes_is_smoothed_out_of_the_heading() -> None:
    """White noise of 2 cm across the leg, five times a second; unsmoothed, the heading moves by 7 mrad."""
    pilot, rng, headings = Pilot(), random.Random(7), []
    for fix in range(500):
        nav = replace(NORTHBOUND, north_m=50.0, east_m=rng.gauss(0.0, 0.02), time_s=0.2 * fix)
        headings.append(_demand(pilot, LEG, nav).heading_rad)
    moved = [abs(later - heading) for heading, later in itertools.pairwise(headings[50:])]
    assert sum(moved) / len(moved) < 0.0045


def test_a_step_aside_is_corrected_within_two_seconds() -> None:
    pilot = Pilot()
    _demand(pilot, LEG, replace(NORTHBOUND, north_m=50.0))
    aside = replace(NORTHBOUND, north_m=50.0, east_m=1.0)
    for tick in range(1, 20):
        demand = _demand(pilot, LEG, replace(aside, time_s=0.1 * tick))
    assert demand.heading_rad == pytest.approx(-math.atan(1.0 / CONFIG.guidance.lookahead_m), rel=0.06)


def test_a_boat_that_was_carried_off_its_fillet_sails_the_next_leg_without() -> None:
    pilot = Pilot()
    onward = FollowLeg(LEG.end, Point(100.0, 50.0), 2.0)
    middle = replace(
        NORTHBOUND, north_m=99.34, east_m=0.66, heading_rad=math.pi / 4, north_m_s=0.9, east_m_s=0.9
    )
    _demand(pilot, CORNER, middle)
    on_it, near, off = (  # to port of the fillet, by up to one and a half radii and by more
        _demand(
            pilot, onward, replace(middle, north_m=99.34 + 0.7071 * off_m, east_m=0.66 - 0.7071 * off_m)
        ).yaw_rate_rad_s
        for off_m in (0.0, 2.8, 3.2)
    )
    assert on_it > 0.3
    assert near > 0.2
    assert off == 0.0


def test_a_fillet_once_begun_is_kept_in_any_current() -> None:
    following = PathFollowing()
    before = replace(NORTHBOUND, north_m=90.0)
    turning = replace(NORTHBOUND, north_m=98.6, east_m=0.2, heading_rad=0.4, current_north_m_s=0.5)
    following.update(CORNER, before, CONFIG)
    kept = following.update(CORNER, turning, CONFIG).tangent_rad
    assert kept == following.update(CORNER, replace(turning, current_north_m_s=0.0), CONFIG).tangent_rad
    slower = FollowLeg(CORNER.start, CORNER.end, 1.0, CORNER.next_end)
    assert kept == following.update(slower, turning, CONFIG).tangent_rad
    onward = FollowLeg(LEG.end, Point(100.0, 50.0), 2.0)
    assert kept == following.update(onward, turning, CONFIG).tangent_rad
    assert kept != PathFollowing().update(CORNER, turning, CONFIG).tangent_rad


def test_a_boat_at_rest_is_pointed_for_the_speed_that_it_has_and_not_for_the_one_it_will_have() -> None:
    """At 2 m/s over ground 27° would hold a leg through 1 m/s abeam; at rest that lets the boat drift."""
    adrift = replace(NORTHBOUND, north_m_s=0.0, surge_m_s=0.0, current_east_m_s=1.0, east_m_s=0.0)
    drifting = _demand(Pilot(), LEG, adrift)
    under_way = _demand(
        Pilot(), LEG, replace(NORTHBOUND, surge_m_s=2.0, current_east_m_s=1.0, heading_rad=-0.46)
    )
    assert under_way.heading_rad == pytest.approx(-math.atan(0.5), abs=0.12)
    assert drifting.heading_rad == pytest.approx(-0.5)  # on its way to 68°
    nearly = _demand(Pilot(), LEG, replace(adrift, heading_rad=-1.0))
    assert nearly.heading_rad == pytest.approx(-math.atan2(1.0, CONFIG.guidance.min_speed_m_s), abs=0.01)


def test_a_boat_that_turns_into_a_current_makes_way_meanwhile() -> None:
    adrift = replace(NORTHBOUND, north_m_s=0.0, surge_m_s=0.0, current_east_m_s=1.0, east_m_s=0.0)
    still = replace(adrift, current_east_m_s=0.0, heading_rad=1.3)
    assert _demand(Pilot(), LEG, adrift).speed_m_s == pytest.approx(1.0)
    assert _demand(Pilot(), LEG, still).speed_m_s == 0.0
    away = replace(adrift, heading_rad=1.5)
    assert _demand(Pilot(), LEG, away).speed_m_s == pytest.approx(math.sin(1.5))  # the current's part alone


def test_the_bow_is_never_pointed_so_far_aside_that_no_way_is_made() -> None:
    swept = replace(NORTHBOUND, east_m=30.0, current_east_m_s=1.5, surge_m_s=1.0, heading_rad=-1.0)
    assert _demand(Pilot(), LEG, swept).heading_rad == pytest.approx(-1.2)


def test_a_new_station_forgets_the_old_ones_line() -> None:
    pilot = Pilot()
    here = Point(0.0, 0.0)
    still = NavState(0.0, 0.0, 0.0, 0.7, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1, 0.02)
    assert _demand(pilot, KeepStation(here), still).heading_rad == pytest.approx(0.7)
    turned = replace(still, heading_rad=-1.0)
    assert _demand(pilot, KeepStation(here), turned).heading_rad == pytest.approx(0.7)
    nearly_the_same = KeepStation(Point(0.1, 0.0))
    assert _demand(pilot, nearly_the_same, turned).heading_rad == pytest.approx(0.7)
    there = replace(turned, north_m=5.0)
    assert _demand(pilot, KeepStation(Point(5.0, 0.0)), there).heading_rad == pytest.approx(-1.0)
    pilot.update(Stop(), turned, CONFIG, DT)
    assert _demand(pilot, KeepStation(here), turned).heading_rad == pytest.approx(-1.0)


def test_the_path_is_made_as_far_ahead_as_the_boat_may_have_to_brake() -> None:
    """Four braking distances of 5 m: a turn back 18 m beyond the leg counts, one 22 m beyond does not."""
    braking_m = LEG.speed_m_s**2 / (2.0 * CONFIG.guidance.accel_m_s2)
    assert pytest.approx(20.0) == REACH_BRAKINGS * braking_m
    for beyond_m, is_known in ((18.0, True), (22.0, False)):
        turns_back = (Point(100.0 + beyond_m, 0.1), Point(50.0, 0.1))
        leg = FollowLeg(LEG.start, LEG.end, 2.0, turns_back[0], 0.0, turns_back[1:])
        following = PathFollowing()
        following.update(leg, NORTHBOUND, CONFIG)
        assert following._plan is not None
        assert len(following._plan.places) == 3 + is_known


# By figures: 2 m/s, deceleration 0.4 m/s², response of the speed 1 s; course and speed are seen 0.1 s ahead

TURNING_S = math.pi / 0.65 + 0.6


# Along a path


@pytest.mark.parametrize("to_go_m", [3.5, 5.0, 6.5])
def test_before_the_end_speed_and_later_speed_are_those_of_even_braking(to_go_m: float) -> None:
    guide = PathFollowing().update(LEG, replace(NORTHBOUND, north_m=100.0 - to_go_m), CONFIG)
    assert guide.speed_m_s == pytest.approx(math.sqrt(0.8 * (to_go_m - 2.0)))
    assert guide.later_speed_m_s == pytest.approx(math.sqrt(0.8 * (to_go_m - 2.2)))
    assert (guide.tangent_rad, guide.course_rad, guide.later_course_rad) == (0.0, 0.0, 0.0)
    assert guide.stops


@pytest.mark.parametrize(("asked_m_s", "speed_m_s"), [(2.0, 0.4), (0.3, 0.3)])
def test_at_the_end_steerage_way_is_left_unless_less_is_asked_for(asked_m_s: float, speed_m_s: float) -> None:
    guide = PathFollowing().update(
        FollowLeg(LEG.start, LEG.end, asked_m_s), replace(NORTHBOUND, north_m=99.5), CONFIG
    )
    assert (guide.speed_m_s, guide.later_speed_m_s) == (speed_m_s, speed_m_s)


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


@pytest.mark.parametrize(("current_m_s", "to_go_m", "turns"), [
    (1.0, TURNING_S + 0.2, False), (1.0, TURNING_S - 0.1, True), (1.0, TURNING_S + 0.8, False),
    (0.21, 0.21 * TURNING_S - 0.05, True), (0.19, 0.19 * TURNING_S - 0.05, False),
])  # fmt: skip
def test_down_a_current_the_boat_turns_where_the_turn_carries_it_onto_the_end(
    current_m_s: float, to_go_m: float, turns: bool
) -> None:
    nav = replace(NORTHBOUND, north_m=100.0 - to_go_m, current_north_m_s=current_m_s)
    heading = _demand(Pilot(), LEG, nav).heading_rad
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
    demand = _demand(Pilot(), circle, nav)
    assert demand.yaw_rate_rad_s == pytest.approx(side * rate)
    assert (demand.cross_track_m, demand.distance_m) == pytest.approx((0.0, radius_m), abs=1e-9)


# On a course, a heading and a turn


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
