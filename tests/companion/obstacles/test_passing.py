"""Letting pass what moves: courses and speeds chosen against movers that this file makes."""

import math

import msgspec
import pytest
from boat_rig import nav_at

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point
from companion.core.intent import HoldCourse
from companion.geofence.fence import Fence
from companion.obstacles.perception.perception import ObstaclePerception
from companion.obstacles.perception.track import Track
from companion.obstacles.planning.moving_obstacles import EvasiveManeuver, choose_maneuver
from companion.obstacles.planning.scene import Scene

CONFIG = BoatConfig()
SPEED_M_S = 1.0


def scene_with(north_m: float, east_m: float, north_m_s: float, east_m_s: float) -> Scene:
    """A boat at the origin, sailing north, and one mover whose pace is well known."""
    perception = ObstaclePerception(CONFIG.avoidance)
    mover = Track(1, 0.0, Point(north_m, east_m), 0.4)
    for tenth in range(1, 10):
        time_s = 0.1 * tenth
        at = Point(north_m + north_m_s * (time_s - 0.9), east_m + east_m_s * (time_s - 0.9))
        mover.predict(time_s, 0.25)
        mover.correct(at, 1.0, 0.0, 0.01)
        mover.correct(at, 0.0, 1.0, 0.01)
        mover.complete_observation(0.4, 1.0, 0.0)
    mover.is_mover = mover.is_likely_mover = True
    perception.tracks.all.append(mover)
    perception.reach_m = 4.0
    nav = msgspec.structs.replace(nav_at(time_s=0.9), north_m_s=SPEED_M_S, surge_m_s=SPEED_M_S)
    return Scene(HoldCourse(0.0, SPEED_M_S), nav, CONFIG, perception, Fence(), 0.9)


def choose(scene: Scene, last: EvasiveManeuver | None = None) -> EvasiveManeuver | None:
    return choose_maneuver(scene, 0.0, SPEED_M_S, last)


def test_what_goes_away_or_passes_far_off_is_left_alone() -> None:
    assert choose(scene_with(3.5, 0.0, 1.5, 0.0)) is None
    assert choose(scene_with(3.0, 3.0, 0.0, 0.5)) is None


def test_what_comes_head_on_is_given_way_to_by_turning_to_starboard() -> None:
    passing = choose(scene_with(3.5, 0.0, -0.5, 0.0))
    assert passing is not None
    assert passing.turn_rad > 0.3
    assert passing.speed_m_s > 0.0


def test_what_comes_head_on_a_little_to_starboard_is_passed_to_port() -> None:
    passing = choose(scene_with(3.5, 0.5, -0.5, 0.0))
    assert passing is not None
    assert passing.turn_rad < -0.3


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_the_boat_does_not_pass_ahead_of_a_crossing_mover(side: float) -> None:
    passing = choose(scene_with(3.2, -1.6 * side, 0.0, 0.5 * side))
    assert passing is not None
    assert passing.turn_rad * side <= 0.0


def test_what_is_past_is_forgotten_and_the_own_course_sailed_again() -> None:
    assert choose(scene_with(-1.5, 1.0, -0.5, 0.0), EvasiveManeuver(0.7, 1.0)) is None


def test_alongside_the_stern_is_not_swung_at_it() -> None:
    last = EvasiveManeuver(0.7, SPEED_M_S)
    passing = choose(scene_with(0.2, -1.0, -0.3, 0.0), last)
    assert passing is not None
    assert passing.turn_rad >= 0.0
    assert math.isfinite(passing.speed_m_s)
