"""Guidance for a boat that cannot turn on the spot: least radius, way while turning, room for the turn."""

import math
from itertools import pairwise

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from msgspec.structs import replace

from companion.config.boat_config import BoatConfig, decode_config
from companion.core.geo import Point
from companion.core.intent import FollowCircle, FollowLeg
from companion.core.state import Demand, NavState
from companion.core.units import wrap_pi
from companion.guidance.fillet import Bend, best_fillet
from companion.guidance.pilot import Pilot
from companion.guidance.station_keeping import StationKeeping, turning_s

RADIUS_M = 3.0


def config(layout: str = "rudder") -> BoatConfig:
    """A boat that cruises at 1.2 m/s; least speed 0.4 m/s."""
    tree = {
        "drive": {"layout": layout, "turn_radius_m": RADIUS_M},
        "speed": {"cruise_m_s": 1.2},
        "handling": {"top_speed_m_s": 2.2, "turn_rate_rad_s": 0.8},
        "guidance": {"station_radius_m": 1.5, "min_speed_m_s": 0.4, "corner_accel_m_s2": 5.0},
    }
    return decode_config(tree, "test")


RUDDER, PAIR, BOTH = config(), config("differential"), config("differential_rudder")
ORIGIN = Point(0.0, 0.0)
STILL = NavState(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1, 0.02)


@given(
    st.floats(0.1, 2.3).flatmap(lambda size: st.sampled_from([size, -size])),
    st.floats(0.0, 0.6),
    st.floats(-math.pi, math.pi),
)
def test_no_fillet_is_tighter_than_the_least_radius_through_the_water(
    turn_rad: float, current_m_s: float, to_rad: float
) -> None:
    north, east = current_m_s * math.cos(to_rad), current_m_s * math.sin(to_rad)
    found = best_fillet(Bend(0.0, turn_rad, 25.0, 25.0, 4.0, 1.2, north, east, 50.0, 0.0), RUDDER)
    assume(found is not None)
    assert found is not None
    step_s = found.time_s / (len(found.nodes) - 1)
    through = []
    for node in found.nodes:
        ahead = node.speed_m_s * math.cos(node.turned_rad) - north
        aside = node.speed_m_s * math.sin(node.turned_rad) - east
        through.append((math.atan2(aside, ahead), math.hypot(ahead, aside)))
    for (bow, speed), (later, later_speed) in pairwise(through):
        turned = abs(wrap_pi(later - bow))
        assert turned * RADIUS_M <= 1.02 * step_s * max(speed, later_speed) + 1e-3


def test_turning_around_takes_the_time_of_half_a_circle() -> None:
    assert turning_s(RUDDER) == pytest.approx(math.pi * RADIUS_M / 1.2 + 0.6)
    assert turning_s(PAIR) == pytest.approx(math.pi / 0.8 + 0.6)


def follow(leg: FollowLeg, nav: NavState, setting: BoatConfig) -> Demand:
    demand = Pilot().update(leg, nav, setting, 0.1)
    assert isinstance(demand, Demand)
    return demand


def test_a_corner_too_sharp_for_a_fillet_is_passed_with_way_on() -> None:
    leg = FollowLeg(ORIGIN, Point(30.0, 0.0), 1.2, next_end=Point(0.0, 1.0))
    carried = replace(STILL, north_m=29.0, north_m_s=0.8, surge_m_s=0.8, current_north_m_s=0.4)
    # Two motors turn around before the stop, and drift onto it; a rudder boat sails on
    assert abs(wrap_pi(follow(leg, carried, PAIR).heading_rad)) > 1.0
    assert follow(leg, carried, RUDDER).heading_rad == pytest.approx(0.0, abs=0.1)
    assert follow(leg, carried, RUDDER).speed_m_s >= 0.4


@pytest.mark.parametrize(("setting", "radius_m"), [(RUDDER, RADIUS_M), (PAIR, 1.0)])
def test_no_circle_is_smaller_than_the_least_radius(setting: BoatConfig, radius_m: float) -> None:
    circle = FollowCircle(Point(0.0, 5.0), 1.0, clockwise=True, speed_m_s=0.5)
    demand = Pilot().update(circle, STILL, setting, 0.1)
    assert isinstance(demand, Demand)
    assert demand.cross_track_m == pytest.approx(radius_m - 5.0)


def station(north_m: float, east_m: float, heading_rad: float = 0.0) -> Demand:
    nav = replace(STILL, north_m=north_m, east_m=east_m, heading_rad=heading_rad)
    return StationKeeping().update(ORIGIN, nav, RUDDER, 0.1)


@pytest.mark.parametrize("bow_rad", [0.0, 1.0])
@pytest.mark.parametrize(
    ("east_m", "goes_straight"), [(-5.9, True), (-6.1, False), (5.9, True), (6.1, False)]
)
def test_a_point_within_the_turning_circle_is_left_behind_first(
    east_m: float, goes_straight: bool, bow_rad: float
) -> None:
    # Abeam, the circle of 3 m reaches 6 m
    demand = station(*ORIGIN.moved(bow_rad + 0.5 * math.pi, east_m), bow_rad)
    expected = 0.0 if goes_straight else -math.copysign(0.5 * math.pi, east_m)
    assert demand.heading_rad == pytest.approx(bow_rad + expected)
    assert demand.speed_m_s >= 0.4


def test_it_sails_on_into_the_inner_half_of_the_radius_then_drifts() -> None:
    keeping, speeds = StationKeeping(), []
    for north_m in (-1.6, -1.0, -0.76, -0.74, -1.0, -1.49):
        speeds.append(keeping.update(ORIGIN, replace(STILL, north_m=north_m), RUDDER, 0.1).speed_m_s)
    assert [speed > 0.0 for speed in speeds] == [True, True, True, False, False, False]
