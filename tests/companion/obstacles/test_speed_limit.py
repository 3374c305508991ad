"""Speed limits, and the stops."""

import math

import pytest
from avoidance_rig import CONFIG, Chart, boat

from companion.config.boat_config import with_value
from companion.core.geo import Point
from companion.core.intent import Drive, Stop
from companion.core.state import Demand
from companion.geofence.fence import Fence
from companion.guidance.speed_profile import braking_speed_m_s
from companion.obstacles.planning.clearance import ClearanceField
from companion.obstacles.planning.speed_limit import SpeedLimit

FAST = Demand(0.0, 2.0)


def limit_of(*solid: Point, heading_rad: float = 0.0, by_sight: int = 0) -> SpeedLimit:
    field = ClearanceField(Point(0.0, 0.0), 0.2, 9.0)
    field.fill(list(solid), list(solid), 0.4)
    limit, config = SpeedLimit(), with_value(CONFIG, "avoidance.by_sight", by_sight)
    limit.update(boat(heading_rad=heading_rad), config, Chart(), field, Fence(), 0.0)
    return limit


def test_the_boat_can_stop_before_what_is_ahead_and_astern() -> None:
    ahead, astern = limit_of(Point(3.7, 0.1)), limit_of(Point(-3.7, 0.1))
    allowed = braking_speed_m_s(0.5 * 3.2, 0.0, CONFIG.guidance)
    assert ahead.ahead_m_s == pytest.approx(allowed, abs=0.1)
    assert ahead.astern_m_s == math.inf
    assert limit_of(Point(5.1, 0.1)).ahead_m_s == math.inf
    assert astern.astern_m_s == pytest.approx(allowed, abs=0.1)
    assert astern.ahead_m_s == math.inf
    assert limit_of(Point(0.1, 3.7), heading_rad=math.pi / 2).ahead_m_s == pytest.approx(allowed, abs=0.1)


def test_demands_are_limited_both_ways() -> None:
    limit = limit_of(Point(2.1, 0.1), Point(-2.1, 0.1))
    assert limit.apply(FAST, boat(), CONFIG) == Demand(0.0, limit.ahead_m_s)
    assert limit.apply(Demand(0.0, -2.0), boat(), CONFIG) == Demand(0.0, -limit.astern_m_s)
    slow = Demand(0.0, 0.01)
    assert limit.apply(slow, boat(), CONFIG) is slow


def test_a_throttle_by_hand_is_limited_to_what_holds_the_speed() -> None:
    limit, drive = limit_of(Point(1.1, 0.1)), Drive(1.0, 0.3)
    held = limit.apply(drive, boat(), CONFIG)
    assert isinstance(held, Drive)
    assert held.throttle < 0.0
    assert held.steering == 0.3
    assert limit.apply(drive, boat(speed_m_s=9.0), CONFIG) == Drive(-1.0, 0.3)
    assert limit.apply(Drive(-1.0, 0.0), boat(), CONFIG) == Drive(-1.0, 0.0)
    assert limit.apply(Stop(), boat(), CONFIG) == Stop()


def test_released_nothing_is_limited_but_what_sight_asked_for_is_known() -> None:
    limit = limit_of(Point(2.1, 0.1), by_sight=1)
    limit.release()
    assert limit.ahead_m_s == limit.astern_m_s == math.inf
    assert limit.sight_m_s < 1.0
