"""Where the look-out has its ranger look."""

import math
from itertools import pairwise

import msgspec
import pytest
from boat_rig import nav_at

from companion.core.geo import Point
from companion.core.state import NavState
from companion.obstacles.perception.occupancy import Beam
from companion.obstacles.perception.sonar_schedule import ALL_ROUND, choose_sector
from companion.obstacles.perception.track import Track
from companion.obstacles.perception.tracks import ObstacleTracks
from companion.sensors.servo_scan import ServoScan

REACH_M = 4.0


def under_way(speed_m_s: float) -> NavState:
    return msgspec.structs.replace(nav_at(), north_m_s=speed_m_s, surge_m_s=speed_m_s)


def tracks_of(*tracks: Track) -> ObstacleTracks:
    out = ObstacleTracks(1.0)
    out.all += tracks
    return out


def track(north_m: float, east_m: float, alone: int = 1, seen_s: float = 0.0) -> Track:
    out = Track(1, seen_s, Point(north_m, east_m), 0.4)
    out.isolated_count, out.whole_count = alone, 1
    return out


@pytest.mark.parametrize(("speed_m_s", "half_deg"), [(3.0, 30.4), (2.0, 30.4), (1.06, 49.0), (0.79, 180.0)])
def test_the_faster_the_boat_the_narrower_the_sector_in_which_it_can_meet_a_mover(
    speed_m_s: float, half_deg: float
) -> None:
    sector = choose_sector(under_way(speed_m_s), ObstacleTracks(1.0), REACH_M, 0.0, is_open=True)
    assert sector.port_rad == -sector.starboard_rad
    assert math.degrees(sector.starboard_rad) == pytest.approx(half_deg, abs=0.5)


def test_at_cruise_the_sweep_returns_to_the_bow_every_quarter_of_a_second() -> None:
    scan = ServoScan([math.radians(15.0 * step) for step in range(-6, 7)])
    scan.set_sector(*choose_sector(under_way(2.0), ObstacleTracks(1.0), REACH_M, 0.0, is_open=True))
    ahead = [ping for ping in range(100) if abs(scan.turn()) < 0.01]
    assert max(b - a for a, b in pairwise(ahead)) * 0.06 <= 0.25


@pytest.mark.parametrize(("turn_deg", "sector_deg"), [(80.0, (-30.0, 95.0)), (-100.0, (-115.0, 30.0))])
def test_a_course_about_to_be_taken_is_looked_at(turn_deg: float, sector_deg: tuple[float, float]) -> None:
    nav = msgspec.structs.replace(under_way(2.0), heading_rad=0.5)
    wished = 0.5 + math.radians(turn_deg)
    sector = choose_sector(nav, ObstacleTracks(1.0), REACH_M, 0.0, None, wished, is_open=True)
    assert [math.degrees(side) for side in sector] == pytest.approx(sector_deg, abs=1.0)


def test_among_things_that_lie_still_it_looks_all_round() -> None:
    assert choose_sector(under_way(2.0), ObstacleTracks(1.0), REACH_M, 0.0, is_open=False) == ALL_ROUND


def test_a_single_echo_is_looked_at_again_in_open_water() -> None:
    beam = Beam(0.0, Point(0.0, 0.0), math.radians(30.0), math.radians(15.0), 3.0, REACH_M)
    nav = msgspec.structs.replace(under_way(2.0), north_m=0.2, heading_rad=0.1)
    bearing = math.atan2(3.0 * 0.5, 3.0 * math.cos(math.radians(30.0)) - 0.2) - 0.1
    sector = choose_sector(nav, tracks_of(track(3.0, 1.5)), REACH_M, 0.1, beam, is_open=True)
    assert sector == pytest.approx((bearing, bearing))


@pytest.mark.parametrize(("speed_m_s", "looks_again"), [(1.4, True), (1.3, False), (1.0, False)])
def test_a_boat_that_has_time_keeps_its_sweep_after_a_single_echo(
    speed_m_s: float, looks_again: bool
) -> None:
    beam = Beam(0.0, Point(0.0, 0.0), 0.5, math.radians(15.0), 3.0, REACH_M)
    sector = choose_sector(under_way(speed_m_s), ObstacleTracks(1.0), REACH_M, 0.1, beam, is_open=True)
    assert (sector.port_rad == sector.starboard_rad) is looks_again
