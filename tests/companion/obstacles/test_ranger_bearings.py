"""Where the ranger looks, and when it is noisy: literal bearings, times and ranges."""

import math

import pytest
from boat_rig import nav_at
from msgspec.structs import replace

from companion.core.geo import Point
from companion.core.readings import SonarReading
from companion.obstacles.perception.sonar_noise import SonarNoiseMonitor
from companion.obstacles.perception.sonar_scan import SonarScan
from companion.obstacles.perception.sonar_schedule import ALL_ROUND, choose_sector
from companion.obstacles.perception.track import Track
from companion.obstacles.perception.tracks import ObstacleTracks
from companion.sensors.servo_scan import ServoScan


@pytest.mark.parametrize(
    ("port_rad", "starboard_rad", "expected"), [(0.1, 0.2, 0.0), (0.3, 0.4, 0.5), (-0.9, -0.8, -1.0)]
)
def test_a_sector_without_a_bearing_is_watched_by_the_nearest_one(
    port_rad: float, starboard_rad: float, expected: float
) -> None:
    scan = ServoScan((-1.0, -0.5, 0.0, 0.5, 1.0))
    scan.set_sector(port_rad, starboard_rad)
    assert [scan.turn() for _ in range(6)][-1] == expected


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


@pytest.mark.parametrize(("leap_m", "is_noisy"), [(0.45, False), (0.55, True)])
def test_leaps_of_more_than_an_eighth_of_the_reach_are_noise(leap_m: float, is_noisy: bool) -> None:
    monitor = SonarNoiseMonitor()
    for number in range(100):
        monitor.update(1.0 + (leap_m if number % 2 else 0.0), 4.0)
    assert monitor.is_noisy is is_noisy


def test_a_ping_fills_fifteen_degrees_by_default() -> None:
    scan = SonarScan()
    scan.add(SonarReading(1.0, 0.0, 2.0))
    distances_cm, _ = scan.distances_cm(1.0)
    assert {sector for sector, cm in enumerate(distances_cm) if cm == 200} == {71, 0, 1}
