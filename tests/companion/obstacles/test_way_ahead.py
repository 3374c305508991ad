"""The path of each intent, and places along it."""

import math

import pytest
from avoidance_rig import CONFIG, boat

from companion.core import intent as intents
from companion.core.geo import Point, distance_m
from companion.core.intent import FollowLeg, KeepStation
from companion.obstacles.planning.way_ahead import is_same_goal, places_on, requested_m_s, way_ahead

REACH_M = 10.0
LEG = FollowLeg(Point(0.0, 0.0), Point(50.0, 0.0), 1.2)
STATION = KeepStation(Point(6.0, 8.0))


@pytest.mark.parametrize(
    ("intent", "ahead"),
    [
        (intents.HoldCourse(0.5, 1.0), 0.5),
        (intents.HoldHeading(0.5, 1.0), 0.5),
        (intents.HoldHeading(0.5, -1.0), 0.5 + math.pi),
        (intents.HoldTurn(0.3, 1.0), 2.0),
        (intents.HoldTurn(0.3, -1.0), 2.0 + math.pi),
    ],
)
def test_a_course_a_heading_and_a_turn_lead_straight_on_or_straight_back(
    intent: intents.Intent, ahead: float
) -> None:
    here, end = way_ahead(intent, boat(3.0, -4.0, heading_rad=2.0), CONFIG, REACH_M)
    assert here == Point(3.0, -4.0)
    assert end == pytest.approx(Point(3.0, -4.0).moved(ahead, REACH_M))


@pytest.mark.parametrize("cross_m", [-1.0, 1.0])
def test_a_boat_beside_its_leg_comes_back_to_it_as_line_of_sight_leads(cross_m: float) -> None:
    way = way_ahead(LEG, boat(20.0, cross_m), CONFIG, REACH_M)
    assert (way[0], way[-1]) == (Point(20.0, cross_m), LEG.end)
    ahead_m = 0.5 * CONFIG.guidance.lookahead_m  # at half the cruise speed
    half, whole = way[1:3]
    assert whole == pytest.approx((20.0 + ahead_m, cross_m / math.e))
    slope = (half.east_m - cross_m) / (0.5 * ahead_m)
    assert slope == pytest.approx(-cross_m / ahead_m, rel=0.25)  # where line of sight points


def test_near_the_end_of_a_leg_the_way_goes_on_to_the_next_one() -> None:
    leg = FollowLeg(Point(0.0, 0.0), Point(50.0, 0.0), 1.0, next_end=Point(50.0, 30.0))
    assert way_ahead(leg, boat(49.5, 1.0), CONFIG, REACH_M)[1:] == [leg.end, leg.next_end]
    point = FollowLeg(Point(9.0, 0.0), Point(9.0, 0.0), 1.0)
    assert way_ahead(point, boat(), CONFIG, REACH_M)[1:] == [point.end]


@pytest.mark.parametrize(("is_clockwise", "side"), [(True, 1.0), (False, -1.0)])
@pytest.mark.parametrize(("radius_m", "turned"), [(20.0, 0.5), (1.0, math.tau)])
def test_a_circle_is_followed_for_the_reach_or_once_around(
    is_clockwise: bool, side: float, radius_m: float, turned: float
) -> None:
    centre = Point(5.0, -7.0)
    circle = intents.FollowCircle(centre, radius_m, is_clockwise, 1.0)
    here = centre.moved(1.0, radius_m + 2.0)
    way = way_ahead(circle, boat(here.north_m, here.east_m), CONFIG, REACH_M)[1:]
    bearings = [math.atan2(at.east_m - centre.east_m, at.north_m - centre.north_m) - 1.0 for at in way]
    assert [distance_m(at, centre) for at in way] == pytest.approx([radius_m] * len(way))
    steps = [
        side * (later - before) % math.tau
        for before, later in zip([0.0, *bearings[:-1]], bearings, strict=True)
    ]
    assert max(steps) < 0.5
    assert turned <= sum(steps) < turned + 0.5


def test_the_speed_is_that_of_the_intent_and_to_a_station_one_that_stops_there() -> None:
    assert requested_m_s(LEG, boat(), CONFIG) == 1.2
    assert requested_m_s(intents.HoldHeading(0.0, -0.4), boat(), CONFIG) == 0.4
    far, near, there = (requested_m_s(KeepStation(Point(at, 0.0)), boat(), CONFIG) for at in (90.0, 2.0, 0.0))
    assert far == CONFIG.speed.cruise_m_s
    assert CONFIG.guidance.min_speed_m_s == there < near < far
    assert requested_m_s(intents.Drive(1.0, 0.0), boat(), CONFIG) == CONFIG.speed.cruise_m_s


def test_places_lie_a_step_apart_around_corners_and_stay_at_the_end() -> None:
    way = [Point(0.0, 0.0), Point(2.5, 0.0), Point(2.5, 1.0), Point(2.5, 2.0)]
    found = [(1.0, 0.0), (2.0, 0.0), (2.5, 0.5), (2.5, 1.5), (2.5, 2.0), (2.5, 2.0), (2.5, 2.0)]
    assert places_on(way, 1.0, 7) == found
    assert places_on(way, 1.0, 2) == found[:2]
    assert places_on(way[:1], 1.0, 2) == [way[0]] * 2


def test_a_detour_goes_on_while_the_goal_is_the_same() -> None:
    again = FollowLeg(Point(9.0, 9.0), LEG.end, 0.5)
    assert is_same_goal(LEG, again)
    assert not is_same_goal(LEG, FollowLeg(LEG.start, Point(50.0, 1.0), 1.2))
    assert is_same_goal(STATION, KeepStation(Point(6.5, 8.0)))
    assert not is_same_goal(STATION, KeepStation(Point(7.5, 8.0)))
    assert is_same_goal(intents.HoldCourse(0.0, 1.0), intents.HoldCourse(1.0, 1.0))
    assert not is_same_goal(LEG, STATION)
    assert not is_same_goal(LEG, None)


def test_a_place_just_at_a_corner_leads_on_to_the_next_stretch() -> None:
    way = [Point(0.0, 0.0), Point(1.0, 0.0), Point(1.0, 2.0)]
    assert places_on(way, 0.5, 4) == [Point(0.5, 0.0), Point(1.0, 0.0), Point(1.0, 0.5), Point(1.0, 1.0)]
