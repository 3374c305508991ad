"""Moving obstacles: where they are, who sees them, and what they do to a boat."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.core.errors import ConfigError
from sitl.scenarios.scenario import load_scenario
from sitl.world.movers import Mover, Movers, MoverSettings

places = st.tuples(st.floats(-50.0, 50.0), st.floats(-50.0, 50.0))


def test_a_mover_waits_then_goes_straight_on() -> None:
    mover = Mover(MoverSettings(start=(1.0, 2.0), at_s=10.0, velocity_m_s=(0.5, -1.0)))
    assert mover.position_m(9.0) == (1.0, 2.0)
    assert mover.position_m(14.0) == (3.0, -2.0)


def test_a_mover_goes_from_waypoint_to_waypoint_and_stops_at_the_last() -> None:
    mover = Mover(MoverSettings(start=(0.0, 0.0), waypoints=((10.0, 0.0), (10.0, 10.0)), speed_m_s=2.0))
    at = [mover.position_m(time_s) for time_s in (0.0, 2.5, 5.0, 7.5, 10.0, 99.0)]
    assert at == [(0.0, 0.0), (5.0, 0.0), (10.0, 0.0), (10.0, 5.0), (10.0, 10.0), (10.0, 10.0)]


def test_a_looping_mover_comes_round_again() -> None:
    mover = Mover(MoverSettings(start=(0.0, 0.0), waypoints=((4.0, 0.0),), speed_m_s=1.0, loop=True))
    assert [mover.position_m(time_s)[0] for time_s in (3.0, 5.0, 8.0, 11.0)] == [3.0, 3.0, 0.0, 3.0]


@given(
    start=places,
    waypoints=st.lists(places, min_size=1, max_size=5),
    speed_m_s=st.floats(0.1, 5.0),
    loop=st.booleans(),
    time_s=st.floats(0.0, 500.0),
)
def test_no_mover_ever_outruns_its_speed(
    start: tuple[float, float],
    waypoints: list[tuple[float, float]],
    speed_m_s: float,
    loop: bool,
    time_s: float,
) -> None:
    mover = Mover(MoverSettings(start=start, waypoints=tuple(waypoints), speed_m_s=speed_m_s, loop=loop))
    before, after = mover.position_m(time_s), mover.position_m(time_s + 0.5)
    assert math.dist(before, after) <= 0.5 * speed_m_s * (1.0 + 1e-6) + 1e-6


@given(st.floats(-math.pi, math.pi), st.floats(0.1, 3.0), st.floats(0.05, 0.9))
def test_a_ray_at_a_mover_measures_to_its_edge(bearing_rad: float, beyond_m: float, radius_m: float) -> None:
    far_m = beyond_m + radius_m
    start = (3.0 + far_m * math.sin(bearing_rad), far_m * math.cos(bearing_rad) - 2.0)
    movers = Movers([MoverSettings(start=start, radius_m=radius_m)])
    assert movers.gap_m(3.0, -2.0, 0.0) == pytest.approx(beyond_m)
    (echo,) = movers.echoes(3.0, -2.0, bearing_rad, 0.1, 4.0, 0.0)
    assert echo == pytest.approx((beyond_m, radius_m, 0.0), abs=1e-6)
    assert movers.echoes(3.0, -2.0, bearing_rad, 0.1, 0.99 * beyond_m, 0.0) == []
    assert movers.echoes(3.0, -2.0, bearing_rad + math.pi, 0.1, 4.0, 0.0) == []
    aside_rad = math.asin(0.6 * radius_m / far_m)
    edge_m = far_m * math.cos(aside_rad) - 0.8 * radius_m
    assert movers.echoes(3.0, -2.0, bearing_rad + aside_rad, 0.0, 4.0, 0.0)[0][0] == pytest.approx(edge_m)
    off_rad = math.asin(radius_m / far_m) + 0.09  # its edge is within the cone
    assert movers.echoes(3.0, -2.0, bearing_rad + off_rad, 0.1, 4.0, 0.0)[0][2] == pytest.approx(0.09)
    assert movers.echoes(3.0, -2.0, bearing_rad + off_rad + 0.02, 0.1, 4.0, 0.0) == []


@pytest.mark.parametrize(
    ("table", "named"),
    [
        ("{start=[0,0], waypoints=[[1,1]]}", "speed_m_s"),
        ("{start=[0,0], waypoints=[[1,1]], speed_m_s=1, velocity_m_s=[1,0]}", "velocity_m_s"),
        ("{radius_m=1}", "start"),
        ("{start=[0,0], radius_m=0}", "radius_m"),
    ],
)
def test_a_mover_that_cannot_be_is_refused_by_key(table: str, named: str) -> None:
    with pytest.raises(ConfigError, match=named):
        load_scenario("open", [f"movers=[{table}]"])
