"""Station keeping: what is asked for in each place round the point."""

import math

import pytest
from msgspec.structs import replace

from companion.config.boat_config import BoatConfig
from companion.config.tuning import Guidance
from companion.core.geo import Point
from companion.core.state import NavState
from companion.guidance.station_keeping import StationKeeping

SETTING = Guidance(station_radius_m=1.5, min_speed_m_s=0.4, accel_m_s2=0.4)
CONFIG = BoatConfig(guidance=SETTING)
ORIGIN = Point(0.0, 0.0)
STILL = NavState(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1, 0.02)


IN_A_CURRENT = replace(
    STILL, current_north_m_s=-1.0, heading_rad=0.0
)  # it flows south, and the bow is into it


# The figures below follow from the laws by hand: radius 1.5 m, steerage way 0.4 m/s, gain 0.4 m/s per metre

TURNING_S = math.pi / 0.65 + 0.6


def at_once(nav: NavState, config: BoatConfig = CONFIG) -> tuple[float, float]:
    """Heading and speed, with no time for the line or the integral to change."""
    demand = StationKeeping().update(ORIGIN, nav, config, 0.0)
    return demand.heading_rad, demand.speed_m_s


@pytest.mark.parametrize("bow_rad", [0.0, 1.0])
@pytest.mark.parametrize("away_m", [1.6, 2.5, 5.0, 12.0])
def test_the_way_back_is_as_fast_as_the_boat_can_stop_at_half_the_radius(
    away_m: float, bow_rad: float
) -> None:
    braking_m_s = math.sqrt(0.16 + 0.8 * (away_m - 0.75)) - 0.4
    north_m, east_m = ORIGIN.moved(bow_rad, -away_m)
    nav = replace(STILL, north_m=north_m, east_m=east_m, heading_rad=bow_rad)
    assert at_once(nav) == pytest.approx((bow_rad, min(braking_m_s, 2.0)))


def test_a_boat_that_brakes_hard_comes_back_in_proportion_to_the_distance() -> None:
    hard = BoatConfig(guidance=Guidance(station_radius_m=1.5, min_speed_m_s=0.4, accel_m_s2=40.0))
    assert at_once(replace(STILL, north_m=-2.5), hard)[1] == pytest.approx(0.4 + 0.4 * (2.5 - 0.75))


@pytest.mark.parametrize(
    ("bearing_deg", "away_m", "is_astern"),
    [(119.0, 2.9, False), (121.0, 2.9, True), (-121.0, 2.9, True), (180.0, 3.1, False), (180.0, 1.6, True)],
)
def test_a_point_is_backed_to_from_two_radii_and_if_it_bears_more_than_120_degrees(
    bearing_deg: float, away_m: float, is_astern: bool
) -> None:
    bearing = math.radians(bearing_deg)
    nav = replace(STILL, north_m=-away_m * math.cos(bearing), east_m=-away_m * math.sin(bearing))
    heading, speed_m_s = at_once(nav)
    expected = bearing + math.pi if is_astern else bearing
    assert math.remainder(heading - expected, math.tau) == pytest.approx(0.0, abs=1e-9)
    assert speed_m_s == pytest.approx(-0.4 if is_astern else 0.0)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_within_the_radius_the_bow_points_a_little_to_where_the_point_lies_abeam(side: float) -> None:
    # 1.2 m abeam: 0.45 m beyond half the radius, over two radii
    assert at_once(replace(STILL, east_m=-1.2 * side)) == pytest.approx((side * math.atan(0.45 / 3.0), 0.0))
    # and the line turns by 0.25 rad/s per radius abeam
    turned = StationKeeping().update(ORIGIN, replace(STILL, east_m=-1.2 * side), CONFIG, 2.0)
    assert turned.heading_rad == pytest.approx(side * (2.0 * 0.25 * 0.45 / 1.5 + math.atan(0.45 / 3.0)))


@pytest.mark.parametrize(("north_m", "speed_m_s"), [(-0.7, 0.0), (-1.2, 0.18), (1.2, -0.18)])
def test_within_the_radius_it_moves_by_what_exceeds_half_of_it(north_m: float, speed_m_s: float) -> None:
    assert at_once(replace(STILL, north_m=north_m)) == pytest.approx((0.0, speed_m_s))


@pytest.mark.parametrize("away_m", [6.0, 7.0, 30.0])
def test_down_a_current_the_speed_over_ground_is_what_can_be_lost_before_the_point(away_m: float) -> None:
    nav = replace(IN_A_CURRENT, north_m=away_m, heading_rad=-math.pi)
    heading, speed_m_s = at_once(nav)
    assert abs(heading) == pytest.approx(math.pi)
    assert speed_m_s == pytest.approx(min(math.sqrt(0.16 + 0.8 * away_m) - 0.4, 2.0))


def test_it_turns_up_current_from_as_far_as_the_turn_carries_it() -> None:
    before, after = (
        at_once(replace(IN_A_CURRENT, north_m=TURNING_S + off_m, heading_rad=-math.pi))[0]
        for off_m in (0.01, -0.01)
    )
    assert abs(before) == pytest.approx(math.pi)
    assert after == pytest.approx(0.0)
    # in a slow current that is less than two radii
    slow = replace(STILL, current_north_m_s=-0.3, heading_rad=-math.pi)
    assert abs(at_once(replace(slow, north_m=3.01))[0]) == pytest.approx(math.pi)
    assert at_once(replace(slow, north_m=2.99))[0] == pytest.approx(0.0)


@pytest.mark.parametrize(
    ("north_m", "east_m", "current_m_s", "up_m_s", "across_m_s"),
    [
        (-1.0, 0.0, 1.0, 1.4, 0.0),
        (1.4, 0.0, 1.0, 0.44, 0.0),
        (2.9, 0.0, 1.0, 0.3, 0.0),  # at least 0.3 of the current
        (-10.0, 0.0, 2.9, 3.0, 0.0),  # at most the top speed
        (0.0, -1.0, 1.0, 1.0, 0.4),
        (0.0, 1.0, 1.0, 1.0, -0.4),
        (-0.5, 2.0, 1.0, 1.2, -0.8),
        (0.0, -4.0, 1.0, 1.0, 1.0),  # across at most as much as up
        (0.0, 4.0, 1.0, 1.0, -1.0),
    ],
)
@pytest.mark.parametrize("heading_rad", [0.0, 0.5, -1.5, 1.6])
def test_against_a_current_the_speed_through_the_water_is_the_current_and_the_gain(
    north_m: float, east_m: float, current_m_s: float, up_m_s: float, across_m_s: float, heading_rad: float
) -> None:
    nav = replace(
        STILL, north_m=north_m, east_m=east_m, current_north_m_s=-current_m_s, heading_rad=heading_rad
    )
    c, s = math.cos(heading_rad), math.sin(heading_rad)
    water_m_s = up_m_s * c + across_m_s * s if abs(heading_rad) < 0.5 * math.pi else 0.0
    assert at_once(nav) == pytest.approx((math.atan2(across_m_s, up_m_s), water_m_s - current_m_s * c))


def test_the_integral_grows_by_a_thirtieth_per_metre_and_second_within_the_radius_only() -> None:
    station = StationKeeping()
    for number in range(1, 9):
        speed_m_s = station.update(ORIGIN, replace(IN_A_CURRENT, north_m=-0.5), CONFIG, 1.0).speed_m_s
        assert speed_m_s == pytest.approx(0.2 + 0.03 * 0.5 * number)
    outside = replace(IN_A_CURRENT, north_m=-2.0)
    for _ in range(3):
        assert station.update(ORIGIN, outside, CONFIG, 1.0).speed_m_s == pytest.approx(0.8 + 0.12)
    station.reset()
    assert station.update(ORIGIN, outside, CONFIG, 1.0).speed_m_s == pytest.approx(0.8)
    beside = StationKeeping()
    for number in range(1, 5):
        demand = beside.update(ORIGIN, replace(IN_A_CURRENT, east_m=-1.0), CONFIG, 1.0)
        assert demand.heading_rad == pytest.approx(math.atan(0.4 + 0.03 * number))


@pytest.mark.parametrize("north_m", [-0.5, 0.5])
def test_the_integral_is_at_most_half_of_steerage_way(north_m: float) -> None:
    station = StationKeeping()
    for _ in range(40):
        speed_m_s = station.update(ORIGIN, replace(IN_A_CURRENT, north_m=north_m), CONFIG, 1.0).speed_m_s
    assert speed_m_s == pytest.approx(-0.4 * north_m + math.copysign(0.2, -north_m))


def test_the_bow_goes_into_a_current_of_half_of_steerage_way_and_leaves_it_at_three_tenths() -> None:
    station, headings = StationKeeping(), []
    for current_m_s in (0.19, 0.21, 0.13, 0.11, 0.19, 0.21):
        nav = replace(STILL, current_north_m_s=-current_m_s, heading_rad=1.0)
        station.update(ORIGIN, nav, CONFIG, 0.0)
        headings.append(station._is_into_current)
    assert headings == [False, True, True, False, False, True]
