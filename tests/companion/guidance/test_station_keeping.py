"""Station keeping: what is asked for in each place round the point."""

import math

import pytest
from msgspec.structs import replace

from companion.config.boat_config import BoatConfig, Guidance
from companion.core.geo import Point
from companion.core.state import NavState
from companion.guidance.station_keeping import StationKeeping

SETTING = Guidance(station_radius_m=1.5, min_speed_m_s=0.4, accel_m_s2=0.4)
CONFIG = BoatConfig(guidance=SETTING)
ORIGIN = Point(0.0, 0.0)
STILL = NavState(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1, 0.02)


def test_on_the_spot_nothing_is_asked_but_the_heading_there_is() -> None:
    demand = StationKeeping().update(ORIGIN, replace(STILL, heading_rad=0.8), CONFIG, 0.02)
    assert demand.heading_rad == pytest.approx(0.8)
    assert demand.speed_m_s == 0.0


def test_from_far_away_it_sails_back_at_cruise_speed() -> None:
    demand = StationKeeping().update(ORIGIN, replace(STILL, north_m=-50.0), CONFIG, 0.02)
    assert demand.heading_rad == pytest.approx(0.0)
    assert demand.speed_m_s == 2.0
    assert demand.distance_m == pytest.approx(50.0)


def test_the_way_back_slows_toward_the_point() -> None:
    speeds = [
        StationKeeping().update(ORIGIN, replace(STILL, north_m=-far), CONFIG, 0.02).speed_m_s
        for far in (20.0, 5.0, 3.0, 1.6)
    ]
    assert speeds == sorted(speeds, reverse=True)
    assert speeds[-1] > 0.0


def test_a_point_far_behind_is_turned_to_on_the_spot() -> None:
    demand = StationKeeping().update(ORIGIN, replace(STILL, north_m=20.0), CONFIG, 0.02)
    assert abs(demand.heading_rad) == pytest.approx(math.pi)
    assert demand.speed_m_s == 0.0


def test_a_point_close_behind_is_backed_to() -> None:
    demand = StationKeeping().update(ORIGIN, replace(STILL, north_m=2.0), CONFIG, 0.02)
    assert demand.heading_rad == pytest.approx(0.0, abs=1e-9)
    assert -SETTING.min_speed_m_s <= demand.speed_m_s < 0.0


@pytest.mark.parametrize(("north_m", "sign"), [(-1.2, 1.0), (1.2, -1.0)])
def test_inside_the_circle_it_moves_along_its_line(north_m: float, sign: float) -> None:
    demand = StationKeeping().update(ORIGIN, replace(STILL, north_m=north_m), CONFIG, 0.02)
    assert demand.heading_rad == pytest.approx(0.0)
    assert demand.speed_m_s * sign > 0.0


def test_a_point_abeam_draws_the_line_round_to_it() -> None:
    station = StationKeeping()
    nav = replace(STILL, east_m=-1.2)
    headings = [station.update(ORIGIN, nav, CONFIG, 0.02).heading_rad for _ in range(6000)]
    assert 0.0 < headings[0] < headings[50] < headings[-1]
    assert headings[-1] == pytest.approx(math.pi / 2, abs=0.05)


def test_reset_takes_the_bow_as_it_lies() -> None:
    station = StationKeeping()
    station.update(ORIGIN, STILL, CONFIG, 0.02)
    station.reset()
    turned = replace(STILL, heading_rad=-2.0)
    assert station.update(ORIGIN, turned, CONFIG, 0.02).heading_rad == pytest.approx(-2.0)


IN_A_CURRENT = replace(
    STILL, current_north_m_s=-1.0, heading_rad=0.0
)  # it flows south, and the bow is into it


def test_on_the_spot_in_a_current_it_lies_into_it_and_stays_over_ground() -> None:
    for heading_rad in (0.0, 2.0, -2.0):
        nav = replace(IN_A_CURRENT, heading_rad=heading_rad)
        assert StationKeeping().update(ORIGIN, nav, CONFIG, 0.02).heading_rad == pytest.approx(0.0)
    assert StationKeeping().update(ORIGIN, IN_A_CURRENT, CONFIG, 0.02).speed_m_s == pytest.approx(0.0)


@pytest.mark.parametrize(("north_m", "sign"), [(-1.0, 1.0), (1.0, -1.0)])
def test_it_moves_up_and_lets_itself_down_without_turning_about(north_m: float, sign: float) -> None:
    demand = StationKeeping().update(ORIGIN, replace(IN_A_CURRENT, north_m=north_m), CONFIG, 0.02)
    assert demand.heading_rad == pytest.approx(0.0)
    assert demand.speed_m_s * sign > 0.0


def test_what_lies_abeam_is_reached_with_the_bow_a_little_aside() -> None:
    to_starboard = StationKeeping().update(ORIGIN, replace(IN_A_CURRENT, east_m=-1.0), CONFIG, 0.02)
    assert 0.1 < to_starboard.heading_rad < math.pi / 4
    to_port = StationKeeping().update(ORIGIN, replace(IN_A_CURRENT, east_m=1.0), CONFIG, 0.02)
    assert to_port.heading_rad == pytest.approx(-to_starboard.heading_rad)


def test_carried_down_from_far_upstream_it_turns_before_it_is_there() -> None:
    far, near = (
        StationKeeping()
        .update(ORIGIN, replace(IN_A_CURRENT, north_m=up, heading_rad=math.pi), CONFIG, 0.02)
        .heading_rad
        for up in (30.0, 5.0)
    )
    assert abs(far) == pytest.approx(math.pi)
    assert near == pytest.approx(0.0)


def test_an_error_that_stays_is_learned_and_no_more_than_is_allowed() -> None:
    station = StationKeeping()
    nav = replace(IN_A_CURRENT, north_m=-0.5)
    first = station.update(ORIGIN, nav, CONFIG, 0.02).speed_m_s
    for _ in range(50_000):
        last = station.update(ORIGIN, nav, CONFIG, 0.02).speed_m_s
    assert first < last <= first + 0.5 * SETTING.min_speed_m_s + 1e-9


def test_a_set_that_comes_and_goes_does_not_change_its_mind() -> None:
    station = StationKeeping()
    station.update(ORIGIN, replace(STILL, current_north_m_s=-0.25, heading_rad=1.0), CONFIG, 0.02)
    weaker = replace(STILL, current_north_m_s=-0.15, heading_rad=1.0)
    assert station.update(ORIGIN, weaker, CONFIG, 0.02).heading_rad == pytest.approx(0.0)
    assert StationKeeping().update(ORIGIN, weaker, CONFIG, 0.02).heading_rad == pytest.approx(1.0)
