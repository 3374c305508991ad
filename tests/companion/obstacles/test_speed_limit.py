"""Speed limits, and the stops."""

import math
from itertools import cycle

import pytest
from avoidance_rig import CONFIG, Chart, boat
from msgspec.structs import replace

from companion.config.boat_config import with_value
from companion.config.tuning import FenceSetting
from companion.core.geo import LatLon, LocalFrame, Point
from companion.core.intent import Drive, Stop
from companion.core.state import Demand
from companion.geofence.fence import Fence, FenceCircle
from companion.guidance.speed_profile import braking_speed_m_s
from companion.obstacles.perception.occupancy import Beam
from companion.obstacles.perception.sonar_schedule import Sector
from companion.obstacles.planning.clearance import ClearanceField
from companion.obstacles.planning.motion import BOW, CRASH_STOP, roll
from companion.obstacles.planning.speed_limit import SpeedLimit, allowed_speed_m_s, crash_stop

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


AHEAD = Sector(-0.53, 0.53)
HERE = Point(0.0, 0.0)
BEAM_RAD = math.radians(15.0)


def looked(reach_m: float = 4.0, *, ahead_rad: float = 0.0) -> Chart:
    chart = Chart()
    chart.water.has_ranger, chart.sector, chart.reach_m = True, AHEAD, reach_m
    for _ in range(2):
        chart.water.add(Beam(0.0, HERE, ahead_rad, BEAM_RAD, math.inf, reach_m))
    return chart


@pytest.mark.parametrize("reach_m", [4.0, 6.0, 8.0])
def test_by_sight_a_crash_stop_a_pass_of_the_sweep_later_ends_a_margin_before_what_a_ranger_may_miss(
    reach_m: float,
) -> None:
    found = allowed_speed_m_s(boat(speed_m_s=0.0), CONFIG, looked(reach_m), Fence(), 0.0)
    stops_m = max(roll(found, 0.0, 0.0, CRASH_STOP, CONFIG).ahead_m) - BOW
    room_m = 0.75 * reach_m - CONFIG.avoidance.margin_m
    assert 0.85 * room_m < stops_m + 0.18 * found < room_m + 0.2


def test_with_four_metres_of_sight_the_boat_sails_at_little_more_than_half_its_cruise() -> None:
    assert allowed_speed_m_s(boat(), CONFIG, looked(), Fence(), 0.0) == pytest.approx(1.12, abs=0.03)
    lake = with_value(CONFIG, "handling.stop_m", 3.7)  # which it measured: a boat that did not is careful
    assert allowed_speed_m_s(boat(), lake, looked(), Fence(), 0.0) == pytest.approx(1.24, abs=0.03)


def test_a_sweep_all_round_looks_ahead_seldom_and_so_the_boat_is_slower() -> None:
    chart = looked()
    chart.sector = Sector(-math.pi, math.pi)
    assert allowed_speed_m_s(boat(), CONFIG, chart, Fence(), 0.0) == pytest.approx(1.03, abs=0.03)
    chart.sector = Sector(0.3, 0.3)  # a second look at an echo does not look ahead at all
    assert allowed_speed_m_s(boat(), CONFIG, chart, Fence(), 0.0) == pytest.approx(1.12, abs=0.03)


def test_the_sweep_does_not_make_the_limit_rise_and_fall() -> None:
    chart, found = looked(), []
    bearings = cycle([0.0, 15.0, 30.0, 15.0, 0.0, -15.0, -30.0, -15.0])
    for ping in range(100):
        now_s = 0.06 * ping
        nav = boat(1.75 * now_s, 0.0, 1.75, 0.1)  # between two bearings of the sweep
        beam = Beam(now_s, nav.point, math.radians(next(bearings)) + 0.1, BEAM_RAD, math.inf, 4.0)
        chart.water.add(beam)
        if ping > 20:
            found.append(allowed_speed_m_s(nav, CONFIG, chart, Fence(), now_s))
    assert min(found) == pytest.approx(max(found), abs=0.01)
    assert min(found) > 1.1


def test_water_looked_at_too_long_ago_or_never_is_crossed_at_the_slowest_speed() -> None:
    assert allowed_speed_m_s(boat(), CONFIG, looked(ahead_rad=math.pi), Fence(), 0.0) == 0.4


def test_a_current_from_astern_leaves_less_room() -> None:
    found = []
    for current_m_s in (0.2, 0.0, -0.2):
        nav = replace(boat(), current_north_m_s=current_m_s)
        found.append(allowed_speed_m_s(nav, CONFIG, looked(), Fence(), 0.0))
    shorter = looked(4.0 - 3.5 * 0.2 / 0.75)
    assert found[0] == pytest.approx(allowed_speed_m_s(boat(), CONFIG, shorter, Fence(), 0.0), abs=0.05)
    assert found[1] == found[2]


def test_a_propeller_that_gives_little_astern_allows_less_speed() -> None:
    weak = with_value(CONFIG, "thrusters.asymmetry", 4.0)
    assert allowed_speed_m_s(boat(), weak, looked(), Fence(), 0.0) < 1.05


def test_known_water_sets_no_limit_and_costs_no_bookkeeping() -> None:
    chart, fence, frame = looked(), Fence(), LocalFrame(LatLon(50.0, -1.2))
    fence.set_areas([FenceCircle(frame.origin, 50.0, True)])
    fence.update(frame, None, FenceSetting(enabled=True))
    assert allowed_speed_m_s(boat(), CONFIG, chart, fence, 0.0) == math.inf
    assert not chart.water.is_used
    uncharted = with_value(CONFIG, "avoidance.by_sight", 1)
    assert allowed_speed_m_s(boat(), uncharted, chart, fence, 0.0) < 2.0
    assert chart.water.is_used


def test_no_propeller_turns_astern_for_the_limit_of_sight_unless_the_boat_is_much_too_fast() -> None:
    limit = limit_of(by_sight=1)
    limit.ahead_m_s = limit.sight_m_s = 1.0
    held = limit.apply(FAST, boat(speed_m_s=1.4), CONFIG)
    assert held == Demand(0.0, 1.0, brakes=False)
    assert limit.apply(FAST, boat(speed_m_s=1.6), CONFIG) == Demand(0.0, 1.0)
    limit.reduce_to(0.8)  # before something known
    assert limit.apply(FAST, boat(speed_m_s=1.0), CONFIG) == Demand(0.0, 0.8)


@pytest.mark.parametrize(("yaw_rate_rad_s", "steering"), [(0.2, -0.1), (-0.2, 0.1), (1.0, -0.2)])
def test_a_crash_stop_steadies_the_heading_with_little_of_the_thrust(
    yaw_rate_rad_s: float, steering: float
) -> None:
    found = crash_stop(replace(boat(), yaw_rate_rad_s=yaw_rate_rad_s), CONFIG)
    assert found.steering == pytest.approx(steering)
    assert found.throttle == -CONFIG.speed.max_throttle
