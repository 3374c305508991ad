"""Station keeping: what is asked for in each place round the point."""

import math

import pytest
from msgspec.structs import replace

from companion.config import Guidance
from companion.geo import Point
from companion.guidance.station_keeping import StationKeeping
from companion.state import NavState

SETTING = Guidance(station_radius_m=1.5, min_speed_m_s=0.4, accel_m_s2=0.4)
ORIGIN = Point(0.0, 0.0)
STILL = NavState(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1, 0.02)


def test_on_the_spot_nothing_is_asked_but_the_heading_there_is() -> None:
    demand = StationKeeping().update(ORIGIN, replace(STILL, heading_rad=0.8), SETTING, 2.0, 0.02)
    assert demand.heading_rad == pytest.approx(0.8)
    assert demand.speed_m_s == 0.0


def test_from_far_away_it_sails_back_at_cruise_speed() -> None:
    demand = StationKeeping().update(ORIGIN, replace(STILL, north_m=-50.0), SETTING, 2.0, 0.02)
    assert demand.heading_rad == pytest.approx(0.0)
    assert demand.speed_m_s == 2.0
    assert demand.distance_m == pytest.approx(50.0)


def test_the_way_back_slows_toward_the_point() -> None:
    speeds = [
        StationKeeping().update(ORIGIN, replace(STILL, north_m=-far), SETTING, 2.0, 0.02).speed_m_s
        for far in (20.0, 5.0, 3.0, 1.6)
    ]
    assert speeds == sorted(speeds, reverse=True)
    assert speeds[-1] > 0.0


def test_a_point_far_behind_is_turned_to_on_the_spot() -> None:
    demand = StationKeeping().update(ORIGIN, replace(STILL, north_m=20.0), SETTING, 2.0, 0.02)
    assert abs(demand.heading_rad) == pytest.approx(math.pi)
    assert demand.speed_m_s == 0.0


def test_a_point_close_behind_is_backed_to() -> None:
    demand = StationKeeping().update(ORIGIN, replace(STILL, north_m=2.0), SETTING, 2.0, 0.02)
    assert demand.heading_rad == pytest.approx(0.0, abs=1e-9)
    assert -SETTING.min_speed_m_s <= demand.speed_m_s < 0.0


@pytest.mark.parametrize(("north_m", "sign"), [(-1.2, 1.0), (1.2, -1.0)])
def test_inside_the_circle_it_moves_along_its_line(north_m: float, sign: float) -> None:
    demand = StationKeeping().update(ORIGIN, replace(STILL, north_m=north_m), SETTING, 2.0, 0.02)
    assert demand.heading_rad == pytest.approx(0.0)
    assert demand.speed_m_s * sign > 0.0


def test_a_point_abeam_draws_the_line_round_to_it() -> None:
    station = StationKeeping()
    nav = replace(STILL, east_m=-1.2)
    headings = [station.update(ORIGIN, nav, SETTING, 2.0, 0.02).heading_rad for _ in range(6000)]
    assert 0.0 < headings[0] < headings[50] < headings[-1]
    assert headings[-1] == pytest.approx(math.pi / 2, abs=0.05)


def test_reset_takes_the_bow_as_it_lies() -> None:
    station = StationKeeping()
    station.update(ORIGIN, STILL, SETTING, 2.0, 0.02)
    station.reset()
    turned = replace(STILL, heading_rad=-2.0)
    assert station.update(ORIGIN, turned, SETTING, 2.0, 0.02).heading_rad == pytest.approx(-2.0)
