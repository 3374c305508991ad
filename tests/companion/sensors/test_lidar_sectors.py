"""A lidar's rays in sectors: what is an echo, what is free water, and what says nothing."""

import math
from collections.abc import Callable
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.config.sensors import LidarPart
from companion.core.readings import SonarReading
from companion.sensors.lidar.sectors import DOUBTFUL, NO_ECHO, SECTOR_RAD, Ray, SectorScan

RAY_S, STEP_DEG = 1.0 / 4500.0, 0.8  # an LD06 at 10 Hz
TURN = round(360.0 / STEP_DEG)


def lidar(**values: object) -> SectorScan:
    return SectorScan(LidarPart(driver="ld06", **{"period_s": 0.0, **values}))  # type: ignore[arg-type]


def turns(scan: SectorScan, range_of: Callable[[float], float], count: int = 3) -> list[SonarReading]:
    """What the last of some turns tells, with the sectors that it completes of the one before."""
    readings: list[SonarReading] = []
    for _ in range(count):
        rays = [(math.radians(ray * STEP_DEG), range_of(ray * STEP_DEG)) for ray in range(TURN)]
        readings = scan.add(rays, max(scan._latest_s, 0.0) + TURN * RAY_S, RAY_S)
    return readings


def told(readings: list[SonarReading]) -> dict[int, float | None]:
    """Range by bearing in degrees."""
    return {round(math.degrees(one.bearing_rad)) % 360: one.range_m for one in readings}


def between(
    first_deg: float, last_deg: float, range_m: float, else_m: float = NO_ECHO
) -> Callable[[float], float]:
    return lambda angle_deg: range_m if first_deg <= angle_deg <= last_deg else else_m


def test_open_water_is_free_all_round() -> None:
    readings = turns(lidar(), lambda _: NO_ECHO)
    assert told(readings) == dict.fromkeys(range(0, 360, 5))
    assert {(one.min_range_m, one.max_range_m) for one in readings} == {(0.03, 8.0)}


def test_the_nearest_echo_of_a_sector_is_told() -> None:
    ranges = told(turns(lidar(), lambda angle_deg: 2.0 + 0.01 * angle_deg))
    assert ranges[90] == pytest.approx(2.0 + 0.01 * 88.0)
    assert ranges[180] == pytest.approx(2.0 + 0.01 * 177.6)


@pytest.mark.parametrize(
    ("mounting", "bearing_deg"),
    [({}, 30), ({"yaw_rad": math.radians(90.0)}, 120), ({"upside_down": True}, 330),
     ({"yaw_rad": math.radians(90.0), "upside_down": True}, 60), ({"yaw_rad": math.pi}, 210)],
)  # fmt: skip
def test_bearings_are_from_the_bow_however_it_is_mounted(
    mounting: dict[str, object], bearing_deg: int
) -> None:
    readings = turns(lidar(**mounting), between(28.0, 32.0, 3.0))
    assert [bearing for bearing, range_m in told(readings).items() if range_m is not None] == [bearing_deg]
    assert all(abs(one.bearing_rad) <= math.pi for one in readings)


@pytest.mark.parametrize(
    ("blind_deg", "hidden"),
    [((170.0, 190.0), {170, 175, 180, 185, 190}), ((-10.0, 10.0), {350, 355, 0, 5, 10}),
     ((173.0, 173.0), {175}), ((350.0, -350.0), {350, 355, 0, 5, 10})],
)  # fmt: skip
def test_what_is_hidden_says_nothing_and_its_echoes_are_no_obstacle(
    blind_deg: tuple[float, float], hidden: set[int]
) -> None:
    first, last = map(math.radians, blind_deg)
    for upside_down in (False, True):
        scan = lidar(blind_rad=((first, last),), upside_down=upside_down)
        for range_m in (NO_ECHO, 1.0):
            assert set(range(0, 360, 5)) - set(told(turns(scan, lambda _, m=range_m: m))) == hidden  # type: ignore[misc]


def test_a_single_ray_is_no_echo_and_no_free_water() -> None:
    scan = lidar()
    turns(scan, lambda _: NO_ECHO)
    assert 90 not in told(turns(scan, between(89.5, 89.7, 3.0), 1))


def test_a_single_ray_counts_when_the_pass_before_met_the_same() -> None:
    scan = lidar()
    assert told(turns(scan, between(89.5, 89.7, 3.0), 2))[90] == 3.0
    assert told(turns(scan, between(89.5, 89.7, 2.8), 1))[90] == 2.8, "the boat has come nearer"
    assert 90 not in told(turns(scan, between(89.5, 89.7, 2.4), 1))


def test_a_drop_before_a_wall_hides_it_not() -> None:
    scan = lidar()
    turns(scan, lambda _: 5.0)
    assert told(turns(scan, between(89.5, 89.7, 2.0, else_m=5.0), 1))[90] == 5.0


@pytest.mark.parametrize("range_m", [DOUBTFUL, 0.02])
def test_a_doubtful_or_covered_ray_keeps_its_sector_from_being_free(range_m: float) -> None:
    ranges = told(turns(lidar(), between(89.5, 89.7, range_m)))
    assert set(range(0, 360, 5)) - set(ranges) == {90}
    assert set(told(turns(lidar(), between(88.7, 88.9, range_m, else_m=4.0))).values()) == {4.0}


def test_what_is_beyond_its_range_is_none_of_its_business() -> None:
    assert set(told(turns(lidar(), lambda _: 8.1)).values()) == {None}
    assert set(told(turns(lidar(max_range_m=9.0), lambda _: 8.1)).values()) == {8.1}


def test_a_sector_whose_rays_were_lost_is_not_free() -> None:
    scan = lidar()
    turns(scan, lambda _: NO_ECHO)
    rays = [
        (math.radians(ray * STEP_DEG), NO_ECHO) for ray in range(TURN) if not 88.5 <= ray * STEP_DEG <= 97.0
    ]
    ranges = told(scan.add(rays, 4 * TURN * RAY_S, RAY_S))
    assert set(range(0, 360, 5)) - set(ranges) == {90, 95}


def test_each_sector_has_the_time_of_its_own_rays() -> None:
    readings = turns(lidar(), lambda _: NO_ECHO)
    times = {round(math.degrees(one.bearing_rad)) % 360: one.time_s for one in readings}
    for bearing_deg in (90, 180, 270):
        assert times[bearing_deg] == pytest.approx(0.2 + 0.1 * (bearing_deg + 2.0) / 360.0, abs=3 * RAY_S)
    assert sorted(times.values()) == [one.time_s for one in readings]


def test_a_direction_is_told_no_oftener_than_its_period() -> None:
    scan = lidar(period_s=0.15)
    passes = [turns(scan, lambda _: NO_ECHO, 1) for _ in range(20)]
    times = [
        one.time_s for found in passes for one in found if one.bearing_rad == pytest.approx(math.pi / 2.0)
    ]
    assert [round(b - a, 3) for a, b in pairwise(times)] == [0.2] * 9


def test_what_was_begun_before_a_gap_is_forgotten() -> None:
    scan = lidar()
    turns(scan, lambda _: 2.0)
    late = [(math.radians(ray * STEP_DEG), NO_ECHO) for ray in range(TURN)]
    readings = scan.add(late, 10.0, RAY_S)
    assert {one.range_m for one in readings} == {None}
    assert min(one.time_s for one in readings) > 9.8


def test_rays_without_an_echo_may_come_a_little_before_their_time() -> None:
    """An A1's, recorded: 8° ahead of the neighbours that met something."""
    scan = SectorScan(LidarPart(driver="rplidar_a1"))
    rays: list[Ray] = []
    for ray in range(720):
        is_blank = ray % 12 in (5, 6)
        angle_deg = ray + (8.0 if is_blank else 0.0)
        rays.append((math.radians(angle_deg % 360.0), NO_ECHO if is_blank else 1.2))
    readings = scan.add(rays, 1.0, 0.5e-3)
    assert len(readings) > 2 * 72 - 6
    assert {one.range_m for one in readings} == {1.2}


def test_a_ray_that_comes_too_late_changes_nothing() -> None:
    rays = [(math.radians(ray * STEP_DEG), NO_ECHO) for ray in range(TURN)]
    late = [*rays[:200], (math.radians(100.0), 2.0), *rays[200:]]
    found, expected = (lidar().add(one, 1.0, RAY_S) for one in (late, rays))
    assert [one.bearing_rad for one in found] == [one.bearing_rad for one in expected]


def test_two_rays_on_either_side_of_a_border_are_an_echo_of_both_sectors() -> None:
    scan = lidar()
    turns(scan, lambda _: NO_ECHO)
    ranges = told(turns(scan, between(87.1, 88.1, 3.0), 1))
    assert (ranges[85], ranges[90]) == (3.0, 3.0)


@given(
    st.lists(st.lists(st.tuples(st.floats(0.0, 20.0), st.floats(0.0, 50.0) | st.just(DOUBTFUL)), max_size=80))
)
def test_any_rays_give_readings_within_range_or_none(chunks: list[list[Ray]]) -> None:
    scan = lidar()
    for number, rays in enumerate(chunks):
        for one in scan.add(rays, 0.02 * number, RAY_S):
            assert one.range_m is None or 0.03 <= one.range_m <= 8.0
            assert abs(one.bearing_rad / SECTOR_RAD - round(one.bearing_rad / SECTOR_RAD)) < 1e-6
