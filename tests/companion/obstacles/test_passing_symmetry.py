"""Giving way knows no north and no origin: a scene that is moved or turned has the same maneuver."""

import math

import pytest
from boat_rig import nav_at
from hypothesis import example, given
from hypothesis import strategies as st
from msgspec.structs import replace

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point
from companion.core.intent import HoldCourse
from companion.core.units import wrap_pi
from companion.geofence.fence import Fence
from companion.obstacles.perception.perception import ObstaclePerception
from companion.obstacles.perception.track import Track
from companion.obstacles.planning.moving_obstacles import EvasiveManeuver, choose_maneuver
from companion.obstacles.planning.scene import Scene

CONFIG = BoatConfig()


def maneuver(
    at: tuple[float, float],
    velocity: tuple[float, float],
    current: tuple[float, float],
    turns: int = 0,
    origin: Point = Point(0.0, 0.0),  # noqa: B008
) -> EvasiveManeuver | None:
    """For a boat that sails north at 1 m/s, in a world that is turned by quarters and moved."""
    turn = 0.5 * math.pi * turns
    c, s = round(math.cos(turn)), round(math.sin(turn))

    def turned(north: float, east: float) -> tuple[float, float]:
        return north * c - east * s, north * s + east * c

    def moved(north: float, east: float) -> Point:
        north, east = turned(north, east)
        return Point(origin.north_m + north, origin.east_m + east)

    mover = Track(1, 0.0, moved(*at), 0.4)
    for tenth in range(1, 10):
        time_s = 0.1 * tenth
        since_s = time_s - 0.9
        place = moved(at[0] + velocity[0] * since_s, at[1] + velocity[1] * since_s)
        mover.predict(time_s, 0.25)
        for axis in (turned(1.0, 0.0), turned(0.0, 1.0)):
            mover.correct(place, *axis, 0.01)
        mover.complete_observation(0.4, *turned(1.0, 0.0))
    mover.is_mover = mover.is_likely_mover = True
    perception = ObstaclePerception(CONFIG.avoidance)
    perception.tracks.all.append(mover)
    perception.reach_m = 4.0
    north_m_s, east_m_s = turned(1.0, 0.0)
    current_n, current_e = turned(*current)
    nav = replace(
        nav_at(origin.north_m, origin.east_m, time_s=0.9), north_m_s=north_m_s, east_m_s=east_m_s,
        surge_m_s=1.0, heading_rad=wrap_pi(turn), current_north_m_s=current_n, current_east_m_s=current_e,
    )  # fmt: skip
    scene = Scene(HoldCourse(wrap_pi(turn), 1.0), nav, CONFIG, perception, Fence(), 0.9)
    return choose_maneuver(scene, wrap_pi(turn), 1.0, None)


PLACES = st.tuples(st.floats(-3.0, 4.0), st.floats(-3.0, 3.0))
VELOCITIES = st.tuples(st.floats(-1.5, 1.5), st.floats(-1.5, 1.5))
CURRENTS = st.tuples(st.floats(-0.3, 0.3), st.floats(-0.3, 0.3))


@given(PLACES, VELOCITIES, CURRENTS, st.integers(1, 3), st.floats(-200.0, 200.0), st.floats(-200.0, 200.0))
@example((1.0, 0.0), (0.0, 1.6e-203), (0.0, 0.0), 1, 1.0, 0.0)
@example((1.0, 0.0), (0.0, 1.6e-203), (0.1875, 0.0), 1, 1.0, 0.0)
def test_a_scene_that_is_turned_and_moved_has_the_same_maneuver(
    at: tuple[float, float],
    velocity: tuple[float, float],
    current: tuple[float, float],
    turns: int,
    north_m: float,
    east_m: float,
) -> None:
    here = maneuver(at, velocity, current)
    there = maneuver(at, velocity, current, turns, Point(north_m, east_m))
    assert (here is None) is (there is None)
    if here is not None and there is not None:
        assert there == pytest.approx(here)
