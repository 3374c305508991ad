"""A blocked boat, and when decisions are made and dropped: literal times and places."""

import math

import pytest
from avoidance_rig import CONFIG, NORTH, Voyage, boat, is_course, ring

from companion.config.boat_config import with_value
from companion.core.geo import Point
from companion.core.intent import (
    FollowLeg,
    HoldCourse,
    HoldHeading,
    Intent,
    KeepStation,
    Stop,
)
from companion.core.state import NavState
from companion.core.status_text import Severity, StatusText
from companion.geofence.fence import Fence
from companion.obstacles.perception.perception import ObstaclePerception
from companion.obstacles.planning.avoidance import Stage
from companion.obstacles.planning.detour_history import Breadcrumbs
from companion.obstacles.planning.scene import Scene

ROCK = Point(3.0, 0.0)
BEHIND = Point(-3.0, 0.0)
SIDE_TEXT = "Obstacle: passing to starboard"
NO_WAY = StatusText(Severity.NOTICE, "Obstacle: no way around, keeping station")


# Blocked


def test_a_blocked_boat_stops_first_then_waits_and_tries_again_after_half_a_minute() -> None:
    voyage = Voyage(*ring(1.1))
    assert voyage.at(1.0) == HoldHeading(0.0, 0.0), "under way towards it"
    assert voyage.stage() is Stage.BLOCKED
    assert voyage.limit_m_s <= 0.4
    station = KeepStation(Point(0.0, 0.0))
    assert voyage.at(2.0, boat(speed_m_s=0.39)) == station
    assert voyage.at(30.9, boat(speed_m_s=0.1)) == station
    assert voyage.texts == [NO_WAY]
    assert voyage.at(31.1, boat(speed_m_s=0.1)) is NORTH
    assert voyage.stage() is Stage.CLEAR
    assert voyage.texts[1:] == [StatusText(Severity.INFO, "Obstacle: trying again")]
    assert voyage.at(32.0, boat(speed_m_s=0.1)) == station
    assert voyage.texts[2:] == [NO_WAY]


@pytest.mark.parametrize(
    ("rock", "is_open"),
    [
        (BEHIND, True),
        (Point(3.0, 1.05), False),  # 1.1 margins
        (Point(3.0, 1.15), True),
        (Point(12.9, 0.0), False),  # entered at 11.8 m, within three sights of 4 m
        (Point(13.3, 0.0), True),
    ],
)
def test_a_blocked_boat_goes_on_when_three_sights_ahead_are_free(rock: Point, is_open: bool) -> None:
    voyage = Voyage(*ring(1.1))
    voyage.at(1.0, boat(speed_m_s=0.1))
    voyage.chart.rocks = [rock]
    found = voyage.at(2.0, boat(speed_m_s=0.1))
    assert (found is NORTH) is is_open
    assert voyage.said[1:] == (["Obstacle: path is free"] if is_open else [])
    if not is_open:
        assert voyage.limit_m_s == 0.4
        assert found == KeepStation(Point(0.0, 0.0))


def test_a_blocked_boat_that_moves_into_free_water_keeps_its_station() -> None:
    voyage = Voyage(*ring(1.1))
    voyage.at(1.0, boat(speed_m_s=0.1))
    voyage.chart.rocks = [ROCK]
    assert voyage.at(2.0, boat(heading_rad=math.pi)) == KeepStation(Point(0.0, 0.0))
    assert voyage.at(3.0, boat()) == HoldHeading(0.0, 0.0)


def test_a_blocked_boat_waits_where_it_last_had_room() -> None:
    voyage = Voyage(Point(-5.0, 0.0))
    for now_s, north_m in ((1.0, -2.1), (2.0, -1.6)):
        voyage.at(now_s, boat(north_m))
    voyage.chart.rocks = ring(0.9)
    assert voyage.at(5.0, boat(speed_m_s=0.1)) == KeepStation(Point(-2.1, 0.0))
    nowhere = Voyage(*ring(0.9))
    assert nowhere.at(1.0, boat(speed_m_s=0.1)) == KeepStation(Point(0.0, 0.0)), "no better place"


# When decisions are made, and when they are dropped


def test_a_decision_holds_for_nine_hundredths_of_a_second_or_until_another_intent() -> None:
    voyage = Voyage(BEHIND)
    assert voyage.at(1.0) is NORTH
    voyage.chart.rocks = [ROCK]
    assert voyage.at(1.08) is NORTH
    assert is_course(voyage.at(1.091), 25.0, 1.0)
    voyage.chart.rocks = [BEHIND]
    assert is_course(voyage.at(1.1), 25.0, 1.0)
    station = KeepStation(Point(30.0, 0.0))
    assert voyage.at(1.11, intent=station) is station


@pytest.mark.parametrize(
    ("first", "then", "is_kept"),
    [
        (
            FollowLeg(Point(0.0, 0.0), Point(50.0, 0.0), 2.0),
            FollowLeg(Point(-5.0, 0.0), Point(50.0, 0.0), 1.0),
            True,
        ),
        (
            FollowLeg(Point(0.0, 0.0), Point(50.0, 0.0), 2.0),
            FollowLeg(Point(0.0, 0.0), Point(49.0, 0.0), 2.0),
            False,
        ),
        (KeepStation(Point(30.0, 0.0)), KeepStation(Point(30.0, 0.0)), True),
        (KeepStation(Point(30.0, 0.0)), KeepStation(Point(31.0, 0.0)), False),
        (HoldCourse(0.0, 2.0), HoldCourse(0.01, 2.0), True),
        (HoldCourse(0.0, 2.0), HoldHeading(0.0, 2.0), False),
    ],
)
def test_another_goal_begins_another_detour(first: Intent, then: Intent, is_kept: bool) -> None:
    voyage = Voyage(ROCK)
    voyage.at(1.0, intent=first)
    voyage.at(2.0, intent=then)
    assert voyage.said == ([SIDE_TEXT] if is_kept else [SIDE_TEXT, SIDE_TEXT])


@pytest.mark.parametrize("reason", ["stop", "by hand", "off", "lost"])
def test_avoidance_that_does_not_apply_forgets_its_detour(reason: str) -> None:
    voyage = Voyage(ROCK)
    voyage.at(1.0)
    intent: Intent = Stop() if reason == "stop" else NORTH
    if reason == "off":
        voyage.config = with_value(CONFIG, "avoidance.enable", 1)
    if reason == "lost":
        bounds, chart = voyage.bounds, voyage.chart
        found = voyage.avoidance.update(intent, None, CONFIG, chart, bounds, is_by_hand=False, now_s=2.0)
    else:
        found = voyage.at(2.0, intent=intent, is_by_hand=reason == "by hand")
    assert found is intent
    assert voyage.stage() is Stage.CLEAR
    assert voyage.limit_m_s == math.inf
    voyage.config = CONFIG
    voyage.chart.rocks = [BEHIND]
    assert voyage.at(2.01) is NORTH, "nothing is left of the earlier decision"
    voyage.chart.rocks = [ROCK]
    voyage.at(3.0)
    assert voyage.said == [SIDE_TEXT, SIDE_TEXT]


def test_by_hand_the_speed_alone_is_limited_where_it_is_asked_for() -> None:
    voyage = Voyage(ROCK, config=with_value(CONFIG, "avoidance.by_hand", True))
    assert voyage.at(1.0, is_by_hand=True) is NORTH
    assert voyage.limit_m_s == pytest.approx(math.sqrt(0.16 + 0.4 * 2.4) - 0.4)  # half of 3 − 0.6 m
    assert (voyage.stage(), voyage.texts) == (Stage.CLEAR, [])
    assert voyage.at(2.0) is not NORTH


def test_an_obstacle_out_of_sight_matters_on_a_detour_only() -> None:
    voyage = Voyage(ROCK)
    voyage.chart.is_within_sight = False
    voyage.avoidance.safe_speed.reduce_to(0.5)
    assert voyage.at(1.0) is NORTH
    assert voyage.limit_m_s == math.inf
    voyage.chart.is_within_sight = True
    assert voyage.at(2.0) is not NORTH
    voyage.chart.is_within_sight = False
    assert voyage.at(3.0) is not NORTH
    assert voyage.stage() is Stage.ROUND


def test_the_next_attempt_begins_without_the_history_of_the_last() -> None:
    voyage = Voyage(ROCK, config=with_value(CONFIG, "avoidance.detour_m", 3.0))
    voyage.at(1.0)
    voyage.chart.rocks = [Point(3.0, 3.1)]
    beside = boat(0.0, 3.1, speed_m_s=0.1)
    voyage.at(2.0, beside)
    assert voyage.stage() is Stage.BLOCKED
    assert voyage.at(32.1, beside) is NORTH
    voyage.at(33.0, beside)
    voyage.at(34.0, beside)
    assert voyage.stage() is Stage.ROUND, "its length begins at 0"
    assert voyage.said[2:] == ["Obstacle: trying again", SIDE_TEXT]


def test_open_water_removes_the_limits() -> None:
    voyage = Voyage()
    voyage.avoidance.safe_speed.reduce_to(0.5)
    water = ObstaclePerception(CONFIG.avoidance)
    found = voyage.avoidance.update(NORTH, boat(), CONFIG, water, voyage.bounds, is_by_hand=False, now_s=1.0)
    assert found is NORTH
    assert voyage.limit_m_s == math.inf


def scene_with(rock: Point, nav: NavState) -> Scene:
    """With a margin of 2 m."""
    wide = with_value(CONFIG, "avoidance.margin_m", 2.0)
    perception = ObstaclePerception(wide.avoidance)
    perception.reach_m = 4.0
    scene = Scene(NORTH, nav, wide, perception, Fence(), 1.0)
    scene.solid = scene.obstacles = [rock]
    return scene


def test_the_distances_of_a_scene_follow_the_margin() -> None:
    scene = scene_with(ROCK, boat())
    assert scene.room_m(0.0) == pytest.approx(1.8)  # six tenths
    assert scene.clear_path_m(scene.solid) == pytest.approx(1.0)
    assert scene.clear_path_m(scene.solid, 0.5) == pytest.approx(2.0)
    assert scene.water.room_m(0.0) == pytest.approx(0.6)  # 1.2 margins
    assert scene_with(Point(1.1, 0.0), boat()).escape_course_rad() == pytest.approx(math.pi)
    assert scene_with(Point(1.3, 0.0), boat()).escape_course_rad() is None
    assert scene_with(ROCK, boat(speed_m_s=0.11)).room_ahead_m() == pytest.approx(1.8)
    assert scene_with(ROCK, boat(speed_m_s=0.09)).room_ahead_m() == math.inf


def test_two_dozen_places_are_remembered() -> None:
    places = Breadcrumbs()
    for number in range(30):
        places.add(Point(float(number), 0.0), 1.0)
    here, rock = Point(99.0, 0.0), [Point(20.0, 0.0)]
    assert places.last_with_room(here, rock, 13.9) == Point(6.0, 0.0)
    assert places.last_with_room(here, rock, 14.1) == here
