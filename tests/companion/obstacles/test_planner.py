"""Decisions of the local planner, from a map that each test draws; whole voyages are in closed_loop."""

import math

import pytest
from avoidance_rig import CONFIG, LEG, NORTH, ROCK, WALL, Lines, Voyage, boat, mover, ring
from msgspec.structs import replace

from companion.config.boat_config import BoatConfig, with_value
from companion.core import intent as intents
from companion.core.geo import Point
from companion.core.intent import FollowLeg, HoldHeading, KeepStation
from companion.obstacles.perception.occupancy import Beam
from companion.obstacles.perception.perception import ObstaclePerception
from companion.obstacles.planning.motion import roll
from companion.obstacles.planning.planner import BY_SIGHT, GIVING_WAY, NO_WAY, PERIOD_S, LocalPlanner, Stage

NORTH_1 = intents.HoldCourse(0.0, 1.0)


def heading_deg(found: intents.Intent) -> float:
    assert isinstance(found, HoldHeading)
    return math.degrees(found.heading_rad)


def test_in_open_water_every_intent_passes_unchanged() -> None:
    planner = LocalPlanner([])
    perception = ObstaclePerception(CONFIG.avoidance)
    voyage = Voyage()
    for intent in (
        LEG,
        intents.Stop(),
        intents.Drive(1.0, 0.0),
        KeepStation(Point(1.0, 1.0)),
        intents.HoldCourse(1.0, 1.0),
    ):
        passed = planner.update(
            intent, boat(), CONFIG, perception, voyage.bounds, is_by_hand=False, now_s=1.0
        )
        assert passed is intent
    assert planner.limit.ahead_m_s == math.inf


CIRCLE = intents.FollowCircle(Point(0.0, 20.0), 20.0, True, 1.0)


@pytest.mark.parametrize("intent", [LEG, NORTH_1, KeepStation(Point(9.0, 0.0)), CIRCLE])
def test_a_rock_ahead_is_passed_to_starboard_whatever_leads_there(intent: intents.Intent) -> None:
    voyage = Voyage(*ROCK)
    found = voyage.after_a_sweep(intent=intent)
    assert 10.0 < heading_deg(found) < 80.0
    assert voyage.stage() is Stage.ROUND
    assert voyage.said == ["Obstacle: passing to starboard"]


def test_what_is_held_through_the_water_is_told_over_ground() -> None:
    nav = replace(boat(), current_north_m_s=-0.3, surge_m_s=0.7)
    found = Voyage(*ROCK).after_a_sweep(nav, LEG)
    assert isinstance(found, HoldHeading)
    assert found.speed_m_s == pytest.approx(1.2 - 0.3, abs=0.05)  # 1.2 m/s is the usual speed by sight


def test_a_rock_to_starboard_is_passed_to_port() -> None:
    voyage = Voyage(*(Point(3.0, 0.7 + 0.2 * step) for step in range(10)))
    assert heading_deg(voyage.after_a_sweep(intent=LEG)) < -5.0
    assert voyage.said == ["Obstacle: passing to port"]


def test_the_fence_closes_a_side() -> None:
    voyage = Voyage(*ROCK)
    voyage.bounds = Lines(-12.0, 2.5)
    assert heading_deg(voyage.after_a_sweep(intent=LEG)) < -5.0


def test_likely_echoes_are_avoided_without_thrust_astern_and_without_a_message() -> None:
    voyage = Voyage()
    voyage.chart.seen_once = [Point(3.5, 0.1)]
    found = voyage.at(0.0, intent=LEG)
    assert isinstance(found, HoldHeading)
    assert found.heading_rad != 0.0
    assert found.speed_m_s > 0.8
    assert (voyage.stage(), voyage.said) == (Stage.CLEAR, [])


def test_something_certain_close_ahead_at_speed_is_a_crash_stop() -> None:
    voyage = Voyage(*(Point(1.6, -4.0 + 0.2 * step) for step in range(41)))
    found = voyage.at(0.0, boat(speed_m_s=1.5), NORTH)
    assert isinstance(found, intents.Drive)
    assert found.throttle == -1.0


def test_what_is_avoided_for_certain_is_no_reason_to_be_gentle() -> None:
    ghost, rock, met = Voyage(), Voyage(*ROCK), Voyage()
    ghost.chart.seen_once = [Point(3.5, 0.1)]
    met.chart.tracks.all.append(mover(4.0, 0.0, -0.4, 0.0))
    for voyage, eases in ((ghost, True), (rock, False), (met, False)):
        assert voyage.at(0.9, intent=LEG) is not LEG
        assert voyage.planner.eases is eases
    voyage = Voyage(*ROCK)
    voyage.at(0.0, intent=LEG)
    voyage.chart.rocks = []
    voyage.at(0.2, intent=LEG)
    assert not voyage.planner.eases
    ghost.planner.reset()
    assert not ghost.planner.eases


def test_a_sharp_corner_before_a_wall_is_not_cut_to_the_next_leg() -> None:
    wall = [Point(9.0, -9.0 + 0.2 * step) for step in range(91)]
    corner = FollowLeg(Point(-20.0, 0.0), Point(5.0, 0.0), 1.0, Point(-30.0, 10.0), radius_m=1.0)
    assert Voyage(*wall).at(0.0, intent=corner) is corner


def test_a_way_that_nothing_bars_is_kept_though_water_beside_it_was_seen_free() -> None:
    voyage = Voyage(Point(-2.0, -8.0))
    voyage.chart.water.has_ranger = True
    for step in range(13):
        at = Point(0.0, 0.0).moved(math.radians(-28.0), step)
        for bearing_rad in [math.radians(30.0 * side) for side in range(12)]:
            voyage.chart.water.add(Beam(0.0, at, bearing_rad, 0.52, math.inf, 1.0))
    assert voyage.at(0.1, intent=LEG) is LEG


def test_the_decision_holds_for_a_tenth_of_a_second() -> None:
    voyage = Voyage(*ROCK)
    first = voyage.at(0.0, intent=LEG)
    voyage.chart.rocks = []
    assert voyage.at(0.5 * PERIOD_S, intent=LEG) is first
    assert voyage.at(1.1 * PERIOD_S, intent=LEG) is LEG
    assert voyage.stage() is Stage.CLEAR


def test_between_walls_the_boat_waits_tries_again_and_goes_on_when_they_are_gone() -> None:
    voyage = Voyage(*ring(2.5))
    slow = boat(speed_m_s=0.0)
    for step in range(40):
        found = voyage.at(0.1 * step, slow, LEG)
    assert isinstance(found, KeepStation)
    assert voyage.stage() is Stage.BLOCKED
    assert (voyage.said[-1], voyage.said.count(NO_WAY)) == (NO_WAY, 1)
    voyage.at(4.0 + CONFIG.avoidance.retry_s, slow, LEG)
    assert voyage.said.count("Obstacle: trying again") == 1
    for step in range(40):
        voyage.at(40.0 + 0.1 * step, slow, LEG)
    assert voyage.stage() is Stage.BLOCKED
    voyage.chart.rocks = []
    assert voyage.at(45.0, slow, LEG) is LEG
    assert voyage.said[-1] == "Obstacle: path is free"


def test_walls_that_are_met_after_open_water_are_looked_at_for_a_sweep() -> None:
    voyage, walls = Voyage(*ring(2.5)), ring(2.5)
    for step in range(115):
        voyage.chart.rocks = walls if step == 0 or step >= 100 else []
        voyage.at(0.1 * step, boat(speed_m_s=0.0), LEG)
        assert voyage.said == []


def test_a_new_goal_is_a_new_attempt() -> None:
    voyage = Voyage(*ring(2.5))
    for step in range(40):
        voyage.at(0.1 * step, boat(speed_m_s=0.0), LEG)
    assert voyage.stage() is Stage.BLOCKED
    voyage.at(5.0, boat(speed_m_s=0.0), FollowLeg(Point(0.0, 0.0), Point(0.0, 50.0), 1.0))
    assert voyage.stage() is not Stage.BLOCKED


def test_told_not_to_go_round_the_boat_stops_before() -> None:
    config = with_value(CONFIG, "avoidance.goes_round", False)
    far, near = Voyage(*WALL, config=config), Voyage(*WALL, config=config)
    assert far.at(0.0, intent=LEG) is LEG
    assert far.limit_m_s < 0.9
    found = near.at(0.0, boat(2.1, 0.0, 0.05), LEG)
    assert found == KeepStation(Point(2.1, 0.0))
    assert near.said == ["Obstacle ahead: keeping station"]
    near.chart.rocks = []
    assert near.at(1.0, boat(2.1, 0.0, 0.0), LEG) is LEG
    assert near.stage() is Stage.CLEAR


def test_by_hand_nothing_is_replaced_and_the_throttle_is_limited_only_on_request() -> None:
    free, held = Voyage(*ROCK), Voyage(*ROCK, config=with_value(CONFIG, "avoidance.by_hand", True))
    drive = intents.Drive(1.0, 0.0)
    assert free.at(0.0, intent=drive, is_by_hand=True) is drive
    assert free.limit_m_s == math.inf
    assert held.at(0.0, intent=drive, is_by_hand=True) is drive
    assert held.limit_m_s < 1.0


@pytest.mark.parametrize("enable", [0, 1])
def test_switched_off_nothing_happens(enable: int) -> None:
    voyage = Voyage(*ROCK, config=with_value(CONFIG, "avoidance.enable", enable))
    assert voyage.at(0.0, intent=LEG) is LEG
    assert voyage.limit_m_s == math.inf


def test_too_near_and_bow_on_the_boat_backs_off() -> None:
    rock = [Point(0.6, -1.5 + 0.2 * step) for step in range(16)]
    voyage = Voyage(*rock)
    found = voyage.at(0.0, boat(speed_m_s=0.0), LEG)
    assert isinstance(found, HoldHeading)
    assert found.speed_m_s < 0.0
    assert voyage.stage() is Stage.BACK


def crossing(*movers_at: tuple[float, float, float, float], config: BoatConfig = CONFIG) -> Voyage:
    voyage = Voyage(config=config)
    for number, each in enumerate(movers_at, 1):
        track = mover(*each)
        track.number = number
        voyage.chart.tracks.all.append(track)
    return voyage


def test_a_mover_head_on_is_passed_to_starboard_and_reported_once() -> None:
    voyage = crossing((4.0, 0.0, -0.4, 0.0))
    assert heading_deg(voyage.at(0.9, intent=NORTH_1)) > 5.0
    assert voyage.stage() is Stage.PASSING
    voyage.at(1.0, intent=NORTH_1)
    assert voyage.said == [GIVING_WAY]
    assert voyage.is_wary()


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_crossing_traffic_is_not_passed_ahead(side: float) -> None:
    """The boat knows its stop: one that does not would rather stop at once."""
    voyage = crossing((3.5, -2.5 * side, 0.0, 0.6 * side), config=with_value(CONFIG, "handling.stop_m", 3.7))
    found = voyage.at(0.9, intent=NORTH_1)
    assert isinstance(found, HoldHeading)
    way = roll(1.0, 0.0, found.heading_rad, found.speed_m_s, CONFIG)
    for step, at in enumerate(zip(way.ahead_m, way.right_m, strict=True)):
        there = (3.5, -2.5 * side + 0.6 * side * 0.25 * (step + 1))
        assert math.dist(at, there) > 0.8
        assert not (at[0] > there[0] and 0.0 < (at[1] - there[1]) * side < 1.2)


def test_without_a_position_nothing_is_decided() -> None:
    voyage = Voyage(*ROCK)
    voyage.at(0.0, intent=LEG)
    passed = voyage.planner.update(
        LEG, None, CONFIG, voyage.chart, voyage.bounds, is_by_hand=False, now_s=1.0
    )
    assert passed is LEG
    assert voyage.stage() is Stage.CLEAR


def test_the_sonar_is_told_the_course_that_is_held() -> None:
    voyage = Voyage(*ROCK)
    found = voyage.after_a_sweep(intent=LEG)
    assert isinstance(found, HoldHeading)
    assert voyage.chart.wished_course_rad == pytest.approx(found.heading_rad)
    voyage.chart.rocks = []
    voyage.at(3.0, intent=LEG)
    assert voyage.chart.wished_course_rad is None


def test_that_the_boat_is_slow_for_want_of_a_fence_is_told_once() -> None:
    voyage = Voyage()
    voyage.chart.water.has_ranger = True
    for step in range(10):
        voyage.at(0.1 * step, intent=LEG)
    voyage.planner.reset()
    voyage.at(2.0, intent=LEG)
    assert voyage.said == [BY_SIGHT]
    assert "fence" in BY_SIGHT
    assert "AVOID_SIGHT" in BY_SIGHT


@pytest.mark.parametrize("by_sight", [0, 1, 2])
def test_a_boat_that_was_set_to_sail_by_sight_is_not_told_about_it(by_sight: int) -> None:
    voyage = Voyage(config=with_value(CONFIG, "avoidance.by_sight", by_sight))
    voyage.chart.water.has_ranger = True
    voyage.at(0.0, intent=LEG)
    assert voyage.said == []


def test_a_boat_that_wants_no_more_than_sight_allows_is_not_told_about_it() -> None:
    voyage = Voyage()
    voyage.chart.water.has_ranger = True
    voyage.at(0.0, intent=FollowLeg(Point(0.0, 0.0), Point(50.0, 0.0), 0.3))
    assert voyage.said == []


def test_a_boat_that_stays_among_obstacles_says_that_there_is_no_way_whatever_its_goals_are() -> None:
    voyage = Voyage(*ROCK, config=with_value(CONFIG, "avoidance.detour_m", 4.0))
    for step in range(120):
        goal = FollowLeg(Point(0.0, 0.0), Point(50.0 + step, 0.0), 1.0)  # the way is planned anew each time
        voyage.at(0.1 * step, boat(speed_m_s=0.0), goal)
        assert (NO_WAY in voyage.said) is (step > 100)
    voyage = Voyage(*ROCK, config=with_value(CONFIG, "avoidance.detour_m", 4.0))
    for step in range(120):
        voyage.at(
            0.1 * step, boat(0.05 * step, 9.0, 0.5), FollowLeg(Point(0.0, 9.0), Point(50.0 + step, 9.0), 1.0)
        )
    assert NO_WAY not in voyage.said, "it moves on"


def test_a_goal_in_another_direction_ends_the_detour() -> None:
    voyage = Voyage(*ROCK)
    voyage.after_a_sweep(intent=LEG)
    assert voyage.planner._detour.side == 1
    voyage.at(2.0, boat(), FollowLeg(Point(0.0, 0.0), Point(-50.0, 0.0), 1.0))
    assert voyage.planner._detour.side == 0


def test_without_a_way_the_station_is_where_there_was_room() -> None:
    voyage = Voyage(config=with_value(CONFIG, "avoidance.detour_m", 4.0))
    voyage.at(0.0, boat(-3.0, 0.0), LEG)
    voyage.chart.rocks = [Point(0.9, 0.0), Point(0.9, 0.2)]
    for step in range(1, 120):
        voyage.at(0.1 * step, boat(speed_m_s=0.0), LEG)
    assert NO_WAY in voyage.said
    assert voyage.planner._station == KeepStation(Point(-3.0, 0.0))


def test_a_new_attempt_begins_without_a_side() -> None:
    voyage = Voyage(*ROCK, config=with_value(CONFIG, "avoidance.detour_m", 4.0))
    for step in range(450):
        if voyage.stage() is Stage.BLOCKED:
            voyage.planner._detour.side = 1
        voyage.at(0.1 * step, boat(speed_m_s=0.0), LEG)
        if "Obstacle: trying again" in voyage.said:
            break
    assert voyage.said.count(NO_WAY) == 1
    assert voyage.planner._detour.side == 0
