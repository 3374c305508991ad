"""Guidance knows no north and no origin: a world that is turned and moved turns and moves its answers."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.config.boat_config import BoatConfig
from companion.core import intent as intents
from companion.core.geo import Point
from companion.core.state import Demand, MotorCommand, NavState
from companion.core.units import wrap_pi
from companion.guidance.pilot import Pilot
from companion.guidance.stall_detector import StallDetector
from companion.guidance.station_keeping import StationKeeping

CONFIG = BoatConfig()
ANGLES = st.floats(-math.pi, math.pi)
SPEEDS = st.floats(-1.0, 1.0)
PLACES = st.builds(Point, st.floats(-20.0, 20.0), st.floats(-20.0, 20.0))
NAVS = st.builds(
    lambda at, heading, surge, sway, current: made(at, heading, surge, sway, *current),
    PLACES, ANGLES, st.floats(-0.5, 2.0), st.floats(-0.3, 0.3), st.tuples(SPEEDS, SPEEDS),
)  # fmt: skip


def made(
    at: Point, heading: float, surge: float, sway: float, current_north: float, current_east: float
) -> NavState:
    c, s = math.cos(heading), math.sin(heading)
    return NavState(
        0.0, at.north_m, at.east_m, heading, 0.1, surge * c - sway * s, surge * s + sway * c, surge, sway,
        0.1, 0.1, current_north_m_s=current_north, current_east_m_s=current_east,
    )  # fmt: skip


class World:
    """Turned by an angle about the origin, then moved."""

    def __init__(self, turn: float, north_m: float, east_m: float) -> None:
        self.turn, self.north_m, self.east_m = turn, north_m, east_m

    def vector(self, north: float, east: float) -> tuple[float, float]:
        c, s = math.cos(self.turn), math.sin(self.turn)
        return north * c - east * s, north * s + east * c

    def place(self, at: Point) -> Point:
        north, east = self.vector(*at)
        return Point(north + self.north_m, east + self.east_m)

    def nav(self, nav: NavState) -> NavState:
        current = self.vector(nav.current_north_m_s, nav.current_east_m_s)
        at, heading = self.place(nav.point), wrap_pi(nav.heading_rad + self.turn)
        return made(at, heading, nav.surge_m_s, nav.sway_m_s, *current)

    def intent(self, intent: intents.Intent) -> intents.Intent:
        match intent:
            case intents.KeepStation(point):
                return intents.KeepStation(self.place(point))
            case intents.HoldCourse(course, speed):
                return intents.HoldCourse(course + self.turn, speed)
            case intents.HoldHeading(heading, speed):
                return intents.HoldHeading(heading + self.turn, speed)
            case intents.FollowCircle(centre, radius_m, clockwise, speed):
                return intents.FollowCircle(self.place(centre), radius_m, clockwise, speed)
            case intents.FollowLeg():
                following = None if intent.next_end is None else self.place(intent.next_end)
                return intents.FollowLeg(
                    self.place(intent.start), self.place(intent.end), intent.speed_m_s, following
                )
        return intent


WORLDS = st.builds(World, ANGLES, st.floats(-300.0, 300.0), st.floats(-300.0, 300.0))


def assert_alike(demand: Demand, turned: Demand, world: World) -> None:
    assert wrap_pi(turned.heading_rad - demand.heading_rad - world.turn) == pytest.approx(0.0, abs=1e-5)
    assert turned.speed_m_s == pytest.approx(demand.speed_m_s, abs=1e-5)
    assert turned.cross_track_m == pytest.approx(demand.cross_track_m, abs=1e-5)
    assert turned.distance_m == pytest.approx(demand.distance_m, abs=1e-5)
    assert turned.yaw_rate_rad_s == pytest.approx(demand.yaw_rate_rad_s, abs=1e-5)


@given(st.tuples(st.floats(-1.4, 1.4), st.floats(-1.4, 1.4)), st.lists(NAVS, min_size=1, max_size=4), WORLDS)
def test_keeping_station_near_the_point(off: tuple[float, float], navs: list[NavState], world: World) -> None:
    here, there = StationKeeping(), StationKeeping()
    for nav in navs:
        point = Point(nav.north_m + off[0], nav.east_m + off[1])
        demand = here.update(point, nav, CONFIG, 0.5)
        assert_alike(demand, there.update(world.place(point), world.nav(nav), CONFIG, 0.5), world)


INTENTS = [
    intents.HoldCourse(0.4, 1.5),
    intents.HoldHeading(-0.6, 1.0),
    intents.HoldTurn(0.3, 0.8),
    intents.FollowCircle(Point(3.0, -8.0), 12.0, True, 1.2),
    intents.FollowCircle(Point(3.0, -8.0), 12.0, False, 1.2),
    intents.FollowLeg(Point(-20.0, -5.0), Point(40.0, 10.0), 1.5),
    intents.FollowLeg(Point(-20.0, -5.0), Point(15.0, 10.0), 1.5, Point(20.0, -60.0)),
    intents.KeepStation(Point(1.0, -2.0)),
]


@given(st.sampled_from(INTENTS), st.lists(NAVS, min_size=1, max_size=3), WORLDS)
def test_every_intent(intent: intents.Intent, navs: list[NavState], world: World) -> None:
    here, there, moved = Pilot(), Pilot(), world.intent(intent)
    for nav in navs:
        demand = here.update(intent, nav, CONFIG, 0.1)
        turned = there.update(moved, world.nav(nav), CONFIG, 0.1)
        assert isinstance(demand, Demand)
        assert isinstance(turned, Demand)
        assert_alike(demand, turned, world)


PHASES = st.lists(st.tuples(NAVS, st.floats(0.0, 1.0), st.floats(0.0, 1.0)), min_size=1, max_size=3)


@pytest.mark.parametrize("held", [False, True])
@given(PHASES, ANGLES, WORLDS)
def test_being_stuck(
    held: bool, phases: list[tuple[NavState, float, float]], heading: float, world: World
) -> None:
    here, there = StallDetector(), StallDetector()
    for nav, left, right in phases:
        command, demand = MotorCommand(left, right), Demand(heading, 1.0)
        turned = Demand(heading + world.turn, 1.0)
        for _ in range(8):
            here.update(demand, command, nav, CONFIG, 1.6, is_at_line=held)
            there.update(turned, command, world.nav(nav), CONFIG, 1.6, is_at_line=held)
        assert here.verdict is there.verdict
        assert here.held_s == pytest.approx(there.held_s)
        assert here.stalled_s == pytest.approx(there.stalled_s)
