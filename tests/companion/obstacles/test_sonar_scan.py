import math

from hypothesis import given
from hypothesis import strategies as st

from companion.core.readings import SonarReading
from companion.obstacles.perception.sonar_scan import SECTOR_RAD, SECTORS, STALE_S, UNKNOWN_CM, SonarScan

BEAM_RAD = math.radians(15.0)
pings = st.builds(
    SonarReading,
    time_s=st.floats(0.0, 10.0),
    bearing_rad=st.floats(-10.0, 10.0),
    range_m=st.none() | st.floats(0.02, 4.0),
    max_range_m=st.sampled_from([4.0, 10.0]),
)


def test_nothing_seen_is_all_unknown() -> None:
    assert SonarScan().distances_cm(0.0) == ([UNKNOWN_CM] * SECTORS, 0)
    assert SonarScan().is_empty(0.0)


def test_a_ping_fills_its_beam_and_no_more() -> None:
    sweep = SonarScan()
    sweep.add(SonarReading(1.0, math.pi / 2, 1.5), BEAM_RAD)
    distances, farthest_cm = sweep.distances_cm(1.0)
    assert {number for number, cm in enumerate(distances) if cm == 150} == {17, 18, 19}
    assert distances.count(UNKNOWN_CM) == SECTORS - 3
    assert farthest_cm == 400


def test_clear_as_far_as_a_short_ranger_sees_is_not_clear_as_far_as_a_long_one() -> None:
    sweep = SonarScan()
    sweep.add(SonarReading(1.0, 0.0, None, max_range_m=4.0), SECTOR_RAD)
    sweep.add(SonarReading(1.0, math.pi, 6.0, max_range_m=10.0), SECTOR_RAD)
    distances, farthest_cm = sweep.distances_cm(1.0)
    assert farthest_cm == 1000
    assert distances[0] == UNKNOWN_CM
    assert distances[36] == 600


def test_what_was_seen_long_ago_is_forgotten() -> None:
    sweep = SonarScan()
    sweep.add(SonarReading(1.0, 0.0, 1.0))
    assert sweep.distances_cm(1.0 + STALE_S)[0][0] == 100
    assert sweep.distances_cm(1.01 + STALE_S)[0][0] == UNKNOWN_CM
    assert sweep.is_empty(1.01 + STALE_S)


@given(st.lists(st.tuples(pings, st.floats(0.0, 10.0)), max_size=30), st.floats(0.0, 15.0))
def test_any_readings_fit_the_message(seen: list[tuple[SonarReading, float]], now_s: float) -> None:
    sweep = SonarScan()
    for ping, beam_rad in seen:
        sweep.add(ping, beam_rad)
    distances, farthest_cm = sweep.distances_cm(now_s)
    assert len(distances) == SECTORS
    assert all(0 <= cm <= farthest_cm + 1 or cm == UNKNOWN_CM for cm in distances)


@given(pings, st.floats(0.0, 10.0))
def test_the_sector_that_a_ping_points_at_always_has_it(ping: SonarReading, beam_rad: float) -> None:
    sweep = SonarScan()
    sweep.add(ping, beam_rad)
    sector = round(ping.bearing_rad / SECTOR_RAD) % SECTORS
    assert sweep.distances_cm(ping.time_s)[0][sector] != UNKNOWN_CM


def test_an_echo_in_the_blind_range_is_at_its_end() -> None:
    sweep = SonarScan()
    sweep.add(SonarReading(1.0, 0.0, 0.1, 0.25, 4.5))
    assert sweep.distances_cm(1.0)[0][0] == 25


def test_a_range_beyond_the_field_leaves_a_number_for_clear_water() -> None:
    sweep = SonarScan()
    sweep.add(SonarReading(1.0, 0.0, None, max_range_m=900.0), SECTOR_RAD)
    distances, farthest_cm = sweep.distances_cm(1.0)
    assert (distances[0], farthest_cm) == (65534, 65533)
