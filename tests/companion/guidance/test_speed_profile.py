"""The speed profile against the formulas it stands for."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.config.boat_config import BoatConfig, with_value
from companion.guidance.path import Node, Path
from companion.guidance.speed_profile import (
    GAINING_SHARE,
    REACTION_S,
    braking_speed_m_s,
    gaining_m_s2,
    leg_speed_m_s,
    steered_speed_m_s,
    with_speeds,
)

CONFIG = BoatConfig()
SETTING = CONFIG.guidance  # accel 0.4 m/s², slowest 0.4 m/s, pivot 1.05 rad


@pytest.mark.parametrize(
    ("water_m_s", "expected"),
    [(0.0, 0.4 / 0.75), (1.5, 0.4), (2.0, 0.4 * 20.0 / 27.0), (2.9, 0.08), (3.5, 0.08)],
)
def test_speed_is_gained_slowly_near_the_top_speed(water_m_s: float, expected: float) -> None:
    assert gaining_m_s2(water_m_s, CONFIG) == pytest.approx(expected)


@given(st.floats(0.0, 200.0), st.floats(0.0, 2.0))
def test_braking_covers_the_reaction_and_the_slowing(distance_m: float, end_speed: float) -> None:
    speed = braking_speed_m_s(distance_m, end_speed, SETTING)
    if speed > end_speed:
        needed_m = speed * REACTION_S + (speed**2 - end_speed**2) / (2.0 * SETTING.accel_m_s2)
        assert needed_m == pytest.approx(distance_m, abs=1e-6)
    else:
        assert speed == end_speed
        assert distance_m <= end_speed * REACTION_S + 1e-6


def test_steerage_way_is_kept_to_the_end_and_beyond() -> None:
    assert leg_speed_m_s(2.0, 0.0, 0.0, CONFIG) == SETTING.min_speed_m_s
    assert leg_speed_m_s(2.0, -5.0, 0.0, CONFIG) == SETTING.min_speed_m_s
    assert leg_speed_m_s(0.2, 0.0, 0.0, CONFIG) == 0.2


@given(st.floats(0.05, 5.0), st.floats(-10.0, 200.0), st.floats(0.0, 3.0))
def test_no_leg_is_sailed_faster_than_it_says(speed: float, distance_m: float, end_speed: float) -> None:
    allowed = leg_speed_m_s(speed, distance_m, end_speed, CONFIG)
    assert min(speed, SETTING.min_speed_m_s) <= allowed <= speed


def test_the_boat_pivots_beyond_the_pivot_angle_only() -> None:
    pivot = SETTING.pivot_angle_rad
    assert steered_speed_m_s(2.0, 0.5 * pivot, CONFIG) == 2.0
    assert steered_speed_m_s(2.0, -0.75 * pivot, CONFIG) == pytest.approx(1.0)
    assert steered_speed_m_s(2.0, pivot, CONFIG) == SETTING.min_speed_m_s
    assert steered_speed_m_s(2.0, math.nextafter(-pivot, -4.0), CONFIG) == 0.0


@given(st.floats(0.0, 3.0), st.floats(0.0, math.pi), st.floats(0.0, math.pi))
def test_a_worse_heading_is_never_sailed_faster(speed: float, one: float, other: float) -> None:
    near, far = sorted((one, other))
    assert steered_speed_m_s(speed, far, CONFIG) <= steered_speed_m_s(speed, near, CONFIG) <= speed


def row(*stops: tuple[float, float]) -> list[Node]:
    """Nodes northward: how far, how fast."""
    return [Node(north_m, 0.0, 0.0, speed_m_s) for north_m, speed_m_s in stops]


def test_speed_is_gathered_held_and_lost_on_a_straight_stretch() -> None:
    slow, gained, lost = 0.5, 2.0 * GAINING_SHARE * SETTING.accel_m_s2, 2.0 * SETTING.accel_m_s2
    ends = [Node(3.0 + 0.6 * along_m, 4.0 + 0.8 * along_m, 0.93, slow) for along_m in (0.0, 40.0)]
    path = Path(with_speeds(ends, [], 2.0, CONFIG))
    for along_m in (0.0, 0.5, 2.0):
        assert path.speed_m_s(along_m) == pytest.approx(math.sqrt(slow**2 + gained * along_m))
        assert path.speed_m_s(40.0 - along_m) == pytest.approx(math.sqrt(slow**2 + lost * along_m))
    assert path.speed_m_s(20.0) == 2.0


@pytest.mark.parametrize(("start", "end", "length_m"), [(1.0, 0.4, 3.0), (0.0, 0.0, 0.5)])
def test_the_peak_between_two_speeds_lies_where_gaining_and_losing_meet(
    start: float, end: float, length_m: float
) -> None:
    """A peak that is reckoned too low bends the gain; the sum of both roads must be the stretch."""
    peak = with_speeds(row((0.0, start), (length_m, end)), [], 2.0, CONFIG)[1]
    gained_m = (peak.speed_m_s**2 - start**2) / (2.0 * GAINING_SHARE * SETTING.accel_m_s2)
    lost_m = (peak.speed_m_s**2 - end**2) / (2.0 * SETTING.accel_m_s2)
    assert gained_m == pytest.approx(peak.north_m)
    assert gained_m + lost_m == pytest.approx(length_m)


def test_speed_may_be_gathered_half_as_fast_again_as_it_is_lost() -> None:
    # from rest over 5 m at 0.6 m/s²: √6 m/s; at 0.4 m/s² the boat could lose no more than 2 m/s
    gathered = with_speeds(row((0.0, 0.0), (5.0, 2.2)), [], 3.0, CONFIG)
    assert gathered[-1].speed_m_s == pytest.approx(2.2)
    too_fast = with_speeds(row((0.0, 0.0), (5.0, 2.6)), [], 3.0, CONFIG)
    assert too_fast[-1].speed_m_s == pytest.approx(math.sqrt(6.0))
    moving = with_speeds(row((0.0, 1.5), (3.0, 2.6)), [], 3.0, CONFIG)
    assert moving[-1].speed_m_s == pytest.approx(math.sqrt(1.5**2 + 1.2 * 3.0))
    lost = with_speeds(row((0.0, 2.2), (5.0, 0.0)), [], 3.0, CONFIG)
    assert lost[0].speed_m_s == pytest.approx(2.0)


@pytest.mark.parametrize("surge_time_s", [0.5, 2.0])
def test_on_a_leg_the_hulls_own_response_time_counts(surge_time_s: float) -> None:
    config = with_value(CONFIG, "handling.surge_time_s", surge_time_s)
    delay = 0.4 * surge_time_s
    expected = math.sqrt(delay * delay + 0.7 * 0.7 + 0.8 * 4.0) - delay
    assert leg_speed_m_s(2.0, 4.0, 0.7, config) == pytest.approx(expected)
    assert leg_speed_m_s(2.0, 4.0, 2.0, config) == 2.0
