"""How avoidance meets an obstacle: obstacles at literal places, hand-calculated courses and speeds."""

import math

import pytest
from avoidance_rig import CONFIG, NORTH, Voyage, boat, is_course

from companion.config.boat_config import with_value
from companion.core.geo import Point
from companion.core.intent import (
    HoldCourse,
    HoldHeading,
    HoldTurn,
    Intent,
    KeepStation,
)
from companion.core.state import NavState
from companion.core.status_text import Severity, StatusText
from companion.obstacles.planning.avoidance import Stage

STOPS = with_value(CONFIG, "avoidance.goes_round", False)
ROCK = Point(3.0, 0.0)
BEHIND = Point(-3.0, 0.0)


# Before a detour


@pytest.mark.parametrize(
    ("rock", "deg", "text"),
    [
        (ROCK, 25.0, "Obstacle: passing to starboard"),
        (Point(3.0, -0.8), 10.0, "Obstacle: passing to starboard"),
        (Point(3.0, 0.8), -10.0, "Obstacle: passing to port"),  # 14.9° − asin(1.2 / 3.1) = −7.8°
    ],
)
def test_the_detour_begins_on_the_side_of_the_smaller_turn(rock: Point, deg: float, text: str) -> None:
    voyage = Voyage(rock)
    assert is_course(voyage.at(1.0), deg, 1.0)
    assert voyage.stage() is Stage.ROUND
    assert voyage.texts == [StatusText(Severity.INFO, text)]


def test_on_a_detour_a_slow_boat_stays_slow() -> None:
    assert is_course(Voyage(ROCK).at(1.0, intent=HoldCourse(0.0, 0.7)), 25.0, 0.7)


@pytest.mark.parametrize(
    ("surge_m_s", "expected"),
    [(1.0, HoldHeading(0.0, 0.0)), (0.1, HoldCourse(math.radians(70.0), 1.0))],  # asin(1.2 / 1.3) = 67.4°
)
def test_a_sharp_detour_begins_with_a_stop(surge_m_s: float, expected: Intent) -> None:
    found = Voyage(Point(1.3, 0.0)).at(1.0, boat(speed_m_s=surge_m_s))
    if isinstance(expected, HoldCourse):
        assert is_course(found, 70.0, 1.0)
    else:
        assert found == expected


@pytest.mark.parametrize(("north_m", "limit_m_s"), [(3.0, math.sqrt(0.16 + 0.8) - 0.4), (1.2, 0.4)])
def test_an_echo_that_was_seen_once_limits_the_speed_only(north_m: float, limit_m_s: float) -> None:
    voyage = Voyage()
    voyage.chart.seen_once = [Point(north_m, 0.0)]
    assert voyage.at(1.0) is NORTH
    assert voyage.limit_m_s == pytest.approx(limit_m_s)
    assert (voyage.stage(), voyage.texts) == (Stage.CLEAR, [])


@pytest.mark.parametrize(
    ("rock", "nav", "expected"),
    [
        (ROCK, boat(), HoldHeading(0.0, 0.0)),
        (BEHIND, boat(), None),
        (ROCK, boat(speed_m_s=0.19), None),
        (Point(0.0, -3.0), boat(heading_rad=0.2), None),
    ],
)
def test_before_a_sharp_turn_away_from_an_obstacle_the_boat_stops(
    rock: Point, nav: NavState, expected: Intent | None
) -> None:
    east = HoldCourse(0.5 * math.pi, 1.0)
    assert Voyage(rock).at(1.0, nav, east) == (expected or east)


def test_a_gentle_turn_away_needs_no_stop() -> None:
    course = HoldCourse(1.0, 1.0)  # below the 1.05 rad of a turn on the spot; passes 3 sin 1 = 2.5 m off
    assert Voyage(ROCK).at(1.0, intent=course) is course


def test_an_unclassified_obstacle_is_approached_slowly_up_to_a_margin_of_room() -> None:
    far, near = Voyage(Point(2.2, 0.0)), Voyage(Point(1.9, 0.0))
    for voyage in (far, near):
        voyage.chart.has_new = True
    assert far.at(1.0) is NORTH
    assert far.limit_m_s == 0.4
    far.chart.rocks = [ROCK]
    far.at(2.0)
    assert far.limit_m_s == 0.4, "an obstacle that is known would allow 0.58 m/s"
    assert far.stage() is Stage.CLEAR
    near.at(1.0)
    assert near.stage() is Stage.ROUND


# Without detours


@pytest.mark.parametrize("intent", [NORTH, HoldTurn(0.1, 1.0)])
def test_a_boat_that_may_not_go_round_slows_down_then_keeps_station(intent: Intent) -> None:
    voyage = Voyage(ROCK, config=CONFIG if isinstance(intent, HoldTurn) else STOPS)
    assert voyage.at(1.0, intent=intent) is intent
    assert voyage.limit_m_s == pytest.approx(math.sqrt(0.16 + 0.8) - 0.4)
    assert voyage.is_wary()
    voyage.chart.rocks = [Point(1.26, 0.0)]
    assert voyage.at(2.0, intent=intent) is intent
    assert voyage.texts == []
    voyage.chart.rocks = [Point(1.24, 0.0)]
    station = KeepStation(Point(0.0, 0.0))
    assert voyage.at(3.0, intent=intent) == station
    assert voyage.stage() is Stage.BLOCKED
    assert voyage.texts == [StatusText(Severity.NOTICE, "Obstacle ahead: keeping station")]
    assert voyage.at(5000.0, boat(-0.1, speed_m_s=0.1), intent) == station, "there is no next attempt"
    voyage.chart.rocks = [BEHIND]
    assert voyage.at(5001.0, intent=intent) is intent
    assert voyage.stage() is Stage.CLEAR
    assert voyage.texts[1:] == [StatusText(Severity.INFO, "Obstacle: path is free")]
