"""Where the ranger looks: literal bearings, times and ranges."""

import math
from itertools import pairwise

import pytest
from boat_rig import nav_at
from msgspec.structs import replace

from companion.core.geo import Point
from companion.core.state import NavState
from companion.obstacles.perception.occupancy import Beam
from companion.obstacles.perception.sonar_schedule import ALL_ROUND, choose_sector
from companion.obstacles.perception.track import Track
from companion.obstacles.perception.tracks import ObstacleTracks
from companion.sensors.servo_scan import ServoScan

REACH_M = 4.0


def track(north_m: float, east_m: float = 0.0, *, is_mover: bool = False) -> Track:
    found = Track(1, 10.0, Point(100.0 + north_m, 50.0 + east_m), 0.4)
    found.isolated_count, found.whole_count, found.is_mover = 1, 1, is_mover
    return found


def sector_of(*tracks: Track, now_s: float = 10.0, speed_m_s: float = 0.7) -> tuple[float, float]:
    known = ObstacleTracks(1.0)
    known.all += tracks
    nav = replace(nav_at(100.0, 50.0), north_m_s=0.6 * speed_m_s, east_m_s=-0.8 * speed_m_s)
    return choose_sector(nav, known, 4.0, now_s, is_open=True)


def test_the_sector_about_a_track_shows_the_water_beside_it() -> None:
    half = 0.53 + math.asin(0.4 / 3.0)
    assert sector_of(track(3.0)) == pytest.approx((-half, half))
    bearing = math.atan2(1.0, 2.0)
    half = 0.53 + math.asin(0.4 / math.sqrt(5.0))
    assert sector_of(track(2.0, 1.0)) == pytest.approx((bearing - half, bearing + half))
    assert sector_of(track(2.0, 1.0), track(3.0)) == sector_of(track(3.0), track(2.0, 1.0))
    assert sector_of(track(3.0), track(2.0, 1.0)) == sector_of(track(2.0, 1.0))
    near = 0.53 + math.asin(0.5)
    assert sector_of(track(0.5)) == pytest.approx((-near, near))
    assert sector_of(track(2.0, 1.0, is_mover=True)) == pytest.approx((-0.53, bearing + half))
    assert sector_of(track(2.0, -1.0, is_mover=True)) == pytest.approx((-bearing - half, 0.53))


@pytest.mark.parametrize(
    ("off_rad", "is_watched"), [(1.59, True), (-1.59, True), (1.61, False), (-1.61, False)]
)
def test_what_is_abaft_the_beam_is_not_watched(off_rad: float, is_watched: bool) -> None:
    found = sector_of(track(2.0 * math.cos(off_rad), 2.0 * math.sin(off_rad)))
    assert (found != ALL_ROUND) is is_watched


@pytest.mark.parametrize(("unseen_s", "is_watched"), [(1.49, True), (1.51, False)])
def test_a_mover_is_searched_for_a_while(unseen_s: float, is_watched: bool) -> None:
    found = sector_of(track(2.0, 1.0, is_mover=True), now_s=10.0 + unseen_s)
    assert (found != ALL_ROUND) is is_watched


def test_a_new_track_is_watched_for_a_time_or_until_it_is_lost() -> None:
    new = track(3.0)
    for observations, now_s, seen_s, is_watched in (
        (2, 10.1, 10.0, True),
        (2, 11.49, 11.4, True),
        (2, 11.51, 11.4, False),
        (2, 10.39, 10.0, True),
        (2, 10.41, 10.0, False),
        (3, 10.1, 10.0, False),
    ):
        new.observations, new.whole_count, new.seen_s = observations, observations, seen_s
        assert (sector_of(new, now_s=now_s) != ALL_ROUND) is is_watched
    new.observations, new.isolated_count, new.whole_count = 2, 0, 1
    assert sector_of(new, now_s=10.1) == ALL_ROUND
    new.whole_count = 0
    assert sector_of(new, now_s=10.1) != ALL_ROUND


def under_way(speed_m_s: float) -> NavState:
    return replace(nav_at(), north_m_s=speed_m_s, surge_m_s=speed_m_s)


def test_at_cruise_the_sweep_returns_to_the_bow_every_quarter_of_a_second() -> None:
    scan = ServoScan([math.radians(15.0 * step) for step in range(-6, 7)])
    scan.set_sector(*choose_sector(under_way(2.0), ObstacleTracks(1.0), REACH_M, 0.0, is_open=True))
    ahead = [ping for ping in range(100) if abs(scan.turn()) < 0.01]
    assert max(b - a for a, b in pairwise(ahead)) * 0.06 <= 0.25


def test_a_single_echo_is_looked_at_again_in_open_water() -> None:
    beam = Beam(0.0, Point(0.0, 0.0), math.radians(30.0), math.radians(15.0), 3.0, REACH_M)
    nav = replace(under_way(2.0), north_m=0.2, heading_rad=0.1)
    bearing = math.atan2(3.0 * 0.5, 3.0 * math.cos(math.radians(30.0)) - 0.2) - 0.1
    sector = choose_sector(nav, ObstacleTracks(1.0), REACH_M, 0.1, beam, is_open=True)
    assert sector == pytest.approx((bearing, bearing))
