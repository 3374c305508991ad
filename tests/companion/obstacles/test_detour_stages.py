"""The stages of a detour, one transition at a time: literal times and places."""

import math

import pytest
from avoidance_rig import CONFIG, NORTH, Lines, Voyage, boat, is_course

from companion.config.boat_config import with_value
from companion.core.geo import Point
from companion.core.intent import (
    HoldCourse,
    HoldHeading,
    KeepStation,
)
from companion.core.state import NavState
from companion.core.status_text import Severity, StatusText
from companion.obstacles.planning.avoidance import Stage

ROCK = Point(3.0, 0.0)
BEHIND = Point(-3.0, 0.0)
SIDE_TEXT = "Obstacle: passing to starboard"
NO_WAY = StatusText(Severity.NOTICE, "Obstacle: no way around, keeping station")


# On a detour


@pytest.mark.parametrize(
    ("nav", "rock", "is_over"),
    [
        (boat(), BEHIND, True),
        (boat(), Point(5.0, 0.0), False),  # free for 5.0 − 1.1 = 3.9 m of the 4 m in sight
        (boat(), Point(5.2, 0.0), True),
        (boat(), Point(3.0, 1.05), False),  # 1.1 margins have to be free
        (boat(), Point(3.0, 1.15), True),
        (boat(-4.0), Point(1.3, 0.0), False),  # 4.2 m from there leads 0.2 m beyond the start: not a margin
        (boat(-2.0), Point(3.3, 0.0), True),
    ],
)
def test_a_detour_ends_with_free_water_that_leads_nearer_to_the_goal(
    nav: NavState, rock: Point, is_over: bool
) -> None:
    voyage = Voyage(ROCK)
    voyage.at(1.0)
    voyage.chart.rocks = [rock]
    found = voyage.at(2.0, nav)
    assert (found is NORTH) is is_over
    assert voyage.stage() is (Stage.CLEAR if is_over else Stage.ROUND)
    assert voyage.said == [SIDE_TEXT]


def test_the_turn_back_after_a_detour_is_made_after_a_stop() -> None:
    voyage = Voyage(ROCK)
    voyage.at(1.0)
    voyage.chart.rocks = [BEHIND]
    assert voyage.at(2.0, boat(heading_rad=1.2)) == HoldHeading(1.2, 0.0)
    assert voyage.stage() is Stage.ROUND
    assert voyage.at(3.0, boat(heading_rad=1.2, speed_m_s=0.1)) is NORTH
    assert voyage.stage() is Stage.CLEAR


@pytest.mark.parametrize(("east_m", "is_blocked"), [(2.9, False), (3.1, True)])
def test_the_length_of_a_detour_is_limited(east_m: float, is_blocked: bool) -> None:
    voyage = Voyage(ROCK, config=with_value(CONFIG, "avoidance.detour_m", 3.0))
    voyage.at(1.0)
    voyage.chart.rocks = [Point(3.0, east_m)]
    voyage.at(2.0, boat(0.0, east_m, speed_m_s=0.1))
    assert (voyage.stage() is Stage.BLOCKED) is is_blocked


@pytest.mark.parametrize(("more_m", "is_blocked"), [(0.9, False), (1.1, True)])
def test_the_lengths_of_detours_add_up(more_m: float, is_blocked: bool) -> None:
    voyage = Voyage(ROCK, config=with_value(CONFIG, "avoidance.detour_m", 3.0))
    voyage.at(1.0)
    voyage.chart.rocks = [BEHIND]
    assert voyage.at(2.0, boat(0.0, 2.0)) is NORTH  # 2 m so far
    voyage.chart.rocks = [Point(3.0, 2.0)]
    assert voyage.at(3.0, boat(0.0, 2.0)) is not NORTH
    assert voyage.stage() is Stage.ROUND
    assert voyage.said == [SIDE_TEXT], "it is the same side"
    voyage.chart.rocks = [Point(3.0, 2.0 + more_m)]
    voyage.at(4.0, boat(0.0, 2.0 + more_m, speed_m_s=0.1))
    assert (voyage.stage() is Stage.BLOCKED) is is_blocked


@pytest.mark.parametrize(("back_m", "is_blocked"), [(2.1, False), (1.9, True)])
def test_a_detour_that_returns_to_its_start_is_given_up(back_m: float, is_blocked: bool) -> None:
    voyage = Voyage(ROCK)
    voyage.at(1.0)
    for now_s, east_m in ((2.0, 3.1), (3.0, back_m)):
        voyage.chart.rocks = [Point(3.0, east_m)]
        voyage.at(now_s, boat(0.0, east_m, speed_m_s=0.1))
    assert (voyage.stage() is Stage.BLOCKED) is is_blocked


@pytest.mark.parametrize(
    ("moved_m", "is_solid", "is_wary"), [(0.9, True, False), (1.1, True, True), (1.1, False, False)]
)
def test_a_detour_of_more_than_a_margin_means_an_unmapped_obstacle(
    moved_m: float, is_solid: bool, is_wary: bool
) -> None:
    voyage = Voyage(ROCK)
    voyage.at(1.0)
    rock = [Point(3.0, moved_m)]
    voyage.chart.rocks, voyage.chart.seen_once = (rock, []) if is_solid else ([], rock)
    voyage.at(2.0, boat(0.0, moved_m))
    assert voyage.stage() is Stage.ROUND
    assert voyage.is_wary(moved_m) is is_wary


NEARER = Point(2.1, 0.0)  # asin(1.2 / 2.1) = 34.8°


def test_a_detour_changes_side_once_and_then_there_is_no_way() -> None:
    voyage = Voyage(NEARER)
    assert is_course(voyage.at(1.0), 35.0, 1.0)
    voyage.bounds = Lines(-50.0, 0.3)
    assert is_course(voyage.at(2.0), -35.0, 1.0)
    assert voyage.texts[1:] == [StatusText(Severity.INFO, "Obstacle: changing side to port")]
    voyage.bounds = Lines(-0.3, 50.0)
    assert voyage.at(3.0, boat(speed_m_s=0.1)) == KeepStation(Point(0.0, 0.0))
    assert voyage.stage() is Stage.BLOCKED
    assert voyage.texts[2:] == [NO_WAY]


def test_with_both_sides_shut_the_boat_does_not_change_side() -> None:
    voyage = Voyage(NEARER)
    voyage.at(1.0)
    voyage.bounds = Lines(-0.3, 0.3)
    assert voyage.at(2.0, boat(speed_m_s=0.1)) == KeepStation(Point(0.0, 0.0))
    assert voyage.texts[1:] == [NO_WAY]


# Close ahead

ASTERN = HoldHeading(0.0, -0.4)


def test_close_before_an_obstacle_the_boat_backs_until_a_margin_is_free() -> None:
    voyage = Voyage(Point(0.61, 0.0))
    voyage.at(1.0, boat(speed_m_s=0.1))
    assert voyage.stage() is Stage.ROUND
    voyage.chart.rocks = [Point(0.59, 0.0)]
    assert voyage.at(2.0, boat(speed_m_s=0.1)) == ASTERN
    assert voyage.stage() is Stage.BACK
    voyage.chart.rocks = [Point(0.99, 0.0)]
    assert voyage.at(3.0, boat(speed_m_s=0.1)) == ASTERN
    voyage.chart.rocks = [Point(1.01, 0.0)]
    assert isinstance(voyage.at(4.0, boat(speed_m_s=0.1)), HoldCourse)
    assert voyage.stage() is Stage.ROUND


@pytest.mark.parametrize(("now_s", "is_backing"), [(4.9, True), (5.1, False)])
def test_the_boat_backs_for_four_seconds_at_most(now_s: float, is_backing: bool) -> None:
    voyage = Voyage(Point(0.5, 0.0))
    assert voyage.at(1.0, boat(speed_m_s=0.1)) == ASTERN
    found = voyage.at(now_s, boat(speed_m_s=0.1))
    if is_backing:
        assert found == ASTERN
    else:
        assert is_course(found, 180.0, 0.4)
        assert voyage.stage() is Stage.ROUND
        assert voyage.at(now_s + 0.1, boat(speed_m_s=0.1)) == ASTERN, "it begins anew"


def test_a_boat_with_an_obstacle_astern_too_does_not_back() -> None:
    voyage = Voyage(Point(0.5, 0.0), Point(-0.55, 0.0))
    assert is_course(voyage.at(1.0, boat(speed_m_s=0.1)), 180.0, 0.4)
    assert voyage.stage() is Stage.ROUND


def test_an_obstacle_close_abeam_is_left_straight_away() -> None:
    voyage = Voyage(ROCK)
    voyage.at(1.0)
    voyage.chart.rocks = [ROCK, Point(0.0, 0.5)]
    assert is_course(voyage.at(2.0), -90.0, 0.4)


def test_a_boat_with_some_room_astern_backs() -> None:
    assert Voyage(Point(0.5, 0.0), Point(-1.5, 0.0)).at(1.0, boat(speed_m_s=0.1)) == ASTERN


WIDE = with_value(CONFIG, "avoidance.margin_m", 2.0)
NARROW = with_value(CONFIG, "avoidance.margin_m", 0.5)


@pytest.mark.parametrize(("north_m", "is_backing"), [(1.15, True), (1.25, False)])
def test_close_ahead_is_six_tenths_of_the_margin(north_m: float, is_backing: bool) -> None:
    voyage = Voyage(Point(north_m, 0.0), config=WIDE)
    assert (voyage.at(1.0, boat(speed_m_s=0.1)) == ASTERN) is is_backing


@pytest.mark.parametrize(("back_m", "is_blocked"), [(1.05, False), (0.95, True)])
def test_a_detour_has_returned_within_two_margins(back_m: float, is_blocked: bool) -> None:
    voyage = Voyage(ROCK, config=NARROW)
    voyage.at(1.0)
    for now_s, east_m in ((2.0, 1.6), (3.0, back_m)):
        voyage.chart.rocks = [Point(3.0, east_m)]
        voyage.at(now_s, boat(0.0, east_m, speed_m_s=0.1))
    assert (voyage.stage() is Stage.BLOCKED) is is_blocked


def test_a_detour_is_no_faster_than_its_margin_allows() -> None:
    found = Voyage(ROCK, config=NARROW).at(1.0)
    assert isinstance(found, HoldCourse)
    assert found.speed_m_s == pytest.approx(math.sqrt(0.5))  # 0.5 m/s² over half a metre
