"""Speed limits before obstacles. Full throttle makes 3.33 m/s; the gain of the speed loop is 2 per m/s."""

import math

import pytest
from boat_rig import nav_at
from msgspec.structs import replace
from test_scene import moving, scene_of

from companion.config.boat_config import BoatConfig, decode_config, with_value
from companion.core.geo import Point
from companion.core.intent import Drive, Stop
from companion.core.state import Demand
from companion.obstacles.perception.perception import ObstaclePerception
from companion.obstacles.planning.safe_speed import SafeSpeed, crash_stop

CONFIG = BoatConfig()
NAV = nav_at()


def stopping_m_s(room_m: float) -> float:
    """v = √((a t)² + 2 a d) − a t with a = 0.4 m/s², t = 1 s and d half of the room."""
    return math.sqrt(0.16 + 0.4 * room_m) - 0.4


def limited(*obstacles: Point, speed_m_s: float = 1.0) -> SafeSpeed:
    safe = SafeSpeed()
    safe.update(scene_of(*obstacles, nav=moving(speed_m_s)), ObstaclePerception(CONFIG.avoidance))
    return safe


def test_without_obstacles_there_is_no_limit() -> None:
    safe, demand = limited(), Demand(0.0, 5.0)
    assert (safe.ahead_m_s, safe.astern_m_s) == (math.inf, math.inf)
    assert safe.limit(demand, NAV, CONFIG) is demand


def test_the_limits_ahead_and_astern_are_those_of_the_room_there() -> None:
    ahead = limited(Point(3.0, 0.0))
    assert ahead.ahead_m_s == pytest.approx(stopping_m_s(2.4))
    assert ahead.astern_m_s == math.inf
    astern = limited(Point(-2.0, 0.0))
    assert astern.ahead_m_s == math.inf
    assert astern.astern_m_s == pytest.approx(stopping_m_s(1.4))
    assert ahead.limit(Demand(0.3, 2.0, 1.0), NAV, CONFIG) == Demand(0.3, ahead.ahead_m_s, 1.0)
    assert ahead.limit(Demand(0.3, -2.0), NAV, CONFIG) == Demand(0.3, -2.0)
    assert astern.limit(Demand(0.3, -2.0), NAV, CONFIG) == Demand(0.3, -astern.astern_m_s)
    assert astern.limit(Demand(0.3, 2.0), NAV, CONFIG) == Demand(0.3, 2.0)
    assert ahead.limit(Stop(), NAV, CONFIG) == Stop()


def test_the_course_made_good_counts_as_well_as_the_bow() -> None:
    safe = SafeSpeed()
    aside = replace(moving(0.0), east_m_s=1.0)
    safe.update(scene_of(Point(0.0, 3.0), nav=aside), ObstaclePerception(CONFIG.avoidance))
    assert safe.ahead_m_s == pytest.approx(stopping_m_s(2.4))


def test_a_boat_that_is_much_too_fast_stops_with_full_reverse() -> None:
    safe, demand = limited(Point(3.0, 0.0)), Demand(0.0, 2.0)
    most = stopping_m_s(2.4) + 0.9 * 0.4
    slower = safe.limit(demand, moving(most - 0.01), CONFIG)
    assert isinstance(slower, Demand)
    faster = safe.limit(demand, moving(most + 0.01, yaw_rate_rad_s=0.2), CONFIG)
    assert isinstance(faster, Drive)
    assert faster.throttle == -1.0
    assert faster.steering == pytest.approx(-0.1)


@pytest.mark.parametrize(("rate", "steering"), [(0.1, -0.05), (-0.1, 0.05), (9.0, -0.2), (-9.0, 0.2)])
def test_a_crash_stop_steadies_the_bow(rate: float, steering: float) -> None:
    config = with_value(CONFIG, "speed.max_throttle", 0.7)
    stop = crash_stop(replace(NAV, yaw_rate_rad_s=rate), config)
    assert stop.throttle == -0.7
    assert stop.steering == pytest.approx(steering)


def test_by_hand_the_throttle_is_what_holds_the_limit() -> None:
    safe = limited(Point(3.0, 0.0))
    limit = stopping_m_s(2.4)
    held = safe.limit(Drive(1.0, 0.2), moving(limit + 0.1), CONFIG)
    assert isinstance(held, Drive)
    assert held.throttle == pytest.approx(0.3 * limit - 0.2)
    assert held.steering == 0.2
    assert safe.limit(Drive(1.0, 0.0), moving(3.0), CONFIG) == Drive(-1.0, 0.0)
    for drive in (Drive(0.01, 0.2), Drive(-1.0, 0.2)):
        assert safe.limit(drive, moving(limit), CONFIG) == drive
    assert limited(Point(-2.0, 0.0)).limit(Drive(1.0, 0.0), NAV, CONFIG) == Drive(1.0, 0.0)


def test_limits_are_lowered_raised_and_removed() -> None:
    safe = SafeSpeed()
    steps = [(safe.reduce_to, 1.0, 1.0), (safe.reduce_to, 2.0, 1.0), (safe.raise_to, 0.5, 1.0)]
    for change, limit, expected in [*steps, (safe.raise_to, 1.5, 1.5)]:
        change(limit)
        assert safe.ahead_m_s == expected
    safe.clear()
    assert (safe.ahead_m_s, safe.astern_m_s) == (math.inf, math.inf)


@pytest.mark.parametrize(
    ("heading_rad", "obstacles", "speed_m_s"),
    [
        (2.0, (Point(0.8, 0.0),), -0.4),  # no room ahead for a turn: astern, the rudder turning it on
        (-2.0, (Point(0.8, 0.0),), -0.4),
        (2.0, (Point(0.8, 0.0), Point(-0.8, 0.0)), -stopping_m_s(0.2)),  # no room astern either
        (0.5, (Point(0.8, 0.0),), stopping_m_s(0.2)),  # no turn: it stops
        (2.0, (Point(4.0, 0.0),), 0.5),  # room enough to turn ahead
    ],
)
def test_without_room_to_turn_ahead_a_rudder_boat_turns_astern(
    heading_rad: float, obstacles: tuple[Point, ...], speed_m_s: float
) -> None:
    rudder = decode_config({"drive": {"layout": "rudder"}}, "test")
    safe, demand = limited(*obstacles, speed_m_s=0.0), Demand(heading_rad, 0.5)
    limit = safe.limit(demand, NAV, rudder)
    assert isinstance(limit, Demand)
    assert limit.speed_m_s == pytest.approx(speed_m_s)
    on_the_spot = safe.limit(demand, NAV, CONFIG)
    assert isinstance(on_the_spot, Demand)
    assert on_the_spot.speed_m_s >= 0.0
