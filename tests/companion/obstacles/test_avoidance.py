"""Decisions of avoidance, from a map that this file draws; whole voyages are in closed_loop."""

import math

import msgspec
import pytest
from boat_rig import nav_at

from companion.config.boat_config import BoatConfig, with_value
from companion.core.geo import Point
from companion.core.intent import (
    Drive,
    FollowCircle,
    FollowLeg,
    HoldCourse,
    HoldHeading,
    Intent,
    KeepStation,
    Stop,
)
from companion.core.state import Demand, NavState
from companion.core.status_text import StatusText
from companion.geofence.fence import Fence
from companion.obstacles.perception.perception import ObstaclePerception
from companion.obstacles.planning.avoidance import PERIOD_S, Avoidance, Stage
from companion.sensors.readings import SonarReading

CONFIG = BoatConfig()
LEG = FollowLeg(Point(0.0, 0.0), Point(50.0, 0.0), 2.0)
BY_HAND = with_value(CONFIG, "avoidance.by_hand", True)


def under_way(speed_m_s: float = 1.0, time_s: float = 0.0) -> NavState:
    return msgspec.structs.replace(nav_at(time_s=time_s), north_m_s=speed_m_s, surge_m_s=speed_m_s)


def lookout_of(*echoes: tuple[float, float]) -> ObstaclePerception:
    """Bearings in degrees and ranges, each seen three times."""
    perception = ObstaclePerception(CONFIG.avoidance)
    for time_s in (0.0, 0.1, 0.2):
        pings = [(SonarReading(time_s, math.radians(deg), range_m), None) for deg, range_m in echoes]
        perception.ingest(pings, nav_at(time_s=time_s), CONFIG.avoidance, time_s)
    return perception


ROCK_AHEAD = ((0.0, 3.0),)
WALL = tuple((deg, 2.5 / math.cos(math.radians(deg))) for deg in range(-45, 60, 15))
SEALED = tuple((deg, 1.3) for deg in range(-180, 180, 10))


class Hand:
    """Avoidance with its surroundings held."""

    def __init__(self, perception: ObstaclePerception, config: BoatConfig = CONFIG) -> None:
        self.status_texts: list[StatusText] = []
        self.avoidance = Avoidance(self.status_texts)
        self.perception, self.config = perception, config
        self.now_s = 0.8  # long enough after the last look for it to be no riddle any more

    def sail(self, intent: Intent, nav: NavState | None = None, is_by_hand: bool = False) -> Intent:
        self.now_s += PERIOD_S
        return self.avoidance.update(
            intent,
            under_way() if nav is None else nav,
            self.config,
            self.perception,
            Fence(),
            is_by_hand=is_by_hand,
            now_s=self.now_s,
        )


def test_in_open_water_every_intent_goes_through() -> None:
    hand = Hand(ObstaclePerception(CONFIG.avoidance))
    for intent in (LEG, Stop(), Drive(1.0, 0.0), KeepStation(Point(1.0, 1.0)), HoldCourse(1.0, 1.0)):
        assert hand.sail(intent) is intent
    assert hand.avoidance.safe_speed.limit(Demand(0.0, 2.0), under_way(), CONFIG) == Demand(0.0, 2.0)


def test_in_open_water_the_intent_passes_unchanged() -> None:
    hand = Hand(ObstaclePerception(CONFIG.avoidance))
    fence = Fence()
    passed = hand.avoidance.update(
        LEG, under_way(), CONFIG, hand.perception, fence, is_by_hand=False, now_s=1.0
    )
    assert passed is LEG
    assert hand.avoidance.stage is Stage.CLEAR


@pytest.mark.parametrize(
    "intent", [LEG, HoldCourse(0.0, 2.0), HoldHeading(0.0, 2.0), KeepStation(Point(8.0, 0.0))]
)
def test_a_rock_ahead_is_passed_whatever_leads_there(intent: Intent) -> None:
    hand = Hand(lookout_of(*ROCK_AHEAD))
    course = hand.sail(intent)
    assert isinstance(course, HoldCourse)
    assert 0.3 < abs(course.course_rad) < 1.0
    assert hand.avoidance.stage is Stage.ROUND
    assert "passing to" in hand.status_texts[0].text


def test_a_rock_on_the_circle_is_passed() -> None:
    hand = Hand(lookout_of(*ROCK_AHEAD))
    circle = FollowCircle(Point(0.0, 12.0), 12.0, True, 1.0)
    assert isinstance(hand.sail(circle), HoldCourse)


def test_a_rock_beside_the_way_or_beyond_its_end_is_left_alone() -> None:
    hand = Hand(lookout_of((60.0, 3.0)))
    assert hand.sail(LEG) is LEG
    near = KeepStation(Point(1.0, 0.0))
    assert Hand(lookout_of(*ROCK_AHEAD)).sail(near, under_way(0.0)) is near


def test_the_side_is_kept_while_the_boat_goes_round() -> None:
    hand = Hand(lookout_of(*WALL))
    courses = [hand.sail(LEG) for _ in range(20)]
    signs = {math.copysign(1.0, one.course_rad) for one in courses if isinstance(one, HoldCourse)}
    assert len(signs) <= 1
    assert len(hand.status_texts) == 1


def test_speed_is_held_to_what_can_be_stopped_from_before_the_thing() -> None:
    far, near = Hand(lookout_of((0.0, 3.9))), Hand(lookout_of((0.0, 1.5)))
    for hand in (far, near):
        hand.sail(LEG)
    fast = Demand(0.0, 2.0)
    far_m_s, near_m_s = (
        demand.speed_m_s
        for demand in (hand.avoidance.safe_speed.limit(fast, under_way(0.1), CONFIG) for hand in (far, near))
        if isinstance(demand, Demand)
    )
    assert 0.0 <= near_m_s < far_m_s < 2.0


def test_one_echo_alone_only_slows_the_boat() -> None:
    perception = ObstaclePerception(CONFIG.avoidance)
    perception.ingest([(SonarReading(0.3, 0.0, 3.0), None)], under_way(time_s=0.3), CONFIG.avoidance, 0.3)
    hand = Hand(perception)
    assert hand.sail(LEG) is LEG
    assert hand.avoidance.safe_speed.ahead_m_s < 2.0


def test_where_there_is_no_way_the_boat_waits_tells_and_tries_again() -> None:
    hand = Hand(lookout_of(*SEALED))
    hand.sail(LEG, under_way(0.0))
    assert hand.avoidance.stage is Stage.BLOCKED
    assert isinstance(hand.sail(LEG, under_way(0.0)), KeepStation)
    assert [notice.text for notice in hand.status_texts] == ["Obstacle: no way around, keeping station"]
    hand.now_s += 100.0  # all is forgotten by then
    assert hand.sail(LEG, under_way(0.0)) is LEG
    assert hand.status_texts[-1].text == "Obstacle: path is free"


def test_by_hand_nothing_is_steered_and_only_if_asked_for_is_speed_held() -> None:
    drive = Drive(1.0, 0.0)
    free, held = Hand(lookout_of((0.0, 1.0))), Hand(lookout_of((0.0, 1.0)), BY_HAND)
    for hand in (free, held):
        assert hand.sail(drive, is_by_hand=True) is drive
    assert free.avoidance.safe_speed.limit(drive, under_way(), CONFIG) == drive
    braked = held.avoidance.safe_speed.limit(drive, under_way(), BY_HAND)
    assert isinstance(braked, Drive)
    assert braked.throttle < 0.0
    assert held.avoidance.safe_speed.limit(Drive(-1.0, 0.0), under_way(), BY_HAND) == Drive(-1.0, 0.0)


def test_by_sight_the_boat_sails_no_faster_than_it_sees() -> None:
    config = with_value(CONFIG, "avoidance.by_sight", 1)
    perception = ObstaclePerception(config.avoidance)
    blind, seeing = Hand(perception, config), Hand(perception, config)
    blind.sail(LEG)
    assert blind.avoidance.safe_speed.ahead_m_s == CONFIG.guidance.min_speed_m_s
    perception.ingest([(SonarReading(0.3, 0.0, None), None)], under_way(time_s=0.3), config.avoidance, 0.3)
    seeing.sail(LEG)
    assert 0.8 < seeing.avoidance.safe_speed.ahead_m_s < 1.2


def test_another_goal_is_another_matter() -> None:
    hand = Hand(lookout_of(*ROCK_AHEAD))
    assert isinstance(hand.sail(LEG), HoldCourse)
    back = FollowLeg(Point(0.0, 0.0), Point(-50.0, 0.0), 2.0)
    assert hand.sail(back, under_way(0.0)) is back


def test_without_an_estimate_or_switched_off_nothing_is_changed() -> None:
    off = with_value(CONFIG, "avoidance.enable", 1)
    hand = Hand(lookout_of(*ROCK_AHEAD), off)
    assert hand.sail(LEG) is LEG
    assert (
        hand.avoidance.update(LEG, None, CONFIG, hand.perception, Fence(), is_by_hand=False, now_s=9.0) is LEG
    )
