"""Currents that change with place and time, and currents from files."""

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.core.errors import ConfigError
from sitl.scenarios.scenario import load_scenario
from sitl.world.environment.current import Current
from sitl.world.environment.grid import read_grid
from sitl.world.environment.settings import Environment, Gyre, River, Tide
from sitl.world.world import World

DT_S = 0.02
RIVER = River(speed_m_s=1.0, width_m=20.0, through=(5.0, 10.0), to_deg=90.0)
GYRE = Gyre(speed_m_s=0.5, radius_m=10.0, centre=(3.0, 4.0))
PLACE = st.floats(-40.0, 40.0)
CSV = """north_m,east_m,current_east_m_s,current_north_m_s
0,0,0.0,0.0
0,10,1.0,0.0
20,0,0.0,0.4
20,10,1.0,0.4
"""


@pytest.mark.parametrize(
    ("off_m", "speed_m_s"), [(0.0, 1.0), (5.0, 0.75), (-5.0, 0.75), (10.0, 0.0), (50.0, 0.0)]
)
def test_a_river_is_a_parabola_between_its_banks(off_m: float, speed_m_s: float) -> None:
    water = Current(Environment(river=RIVER))
    north_m_s, east_m_s = water.at(10.0 + off_m, 123.0, 0.0)
    assert [north_m_s, east_m_s] == pytest.approx([0.0, speed_m_s], abs=1e-12)


def test_a_gyre_is_fastest_at_its_radius_and_goes_round_clockwise() -> None:
    water = Current(Environment(gyre=GYRE))
    assert water.at(14.0, 3.0, 0.0) == pytest.approx((0.0, 0.5))  # north of its centre: to the east
    assert water.at(4.0, 13.0, 0.0) == pytest.approx((-0.5, 0.0))  # east of it: to the south
    speeds = [math.hypot(*water.at(4.0 + away, 3.0, 0.0)) for away in (2.0, 8.0, 10.0, 12.0, 30.0)]
    assert max(speeds) == speeds[2]
    assert water.at(4.0, 3.0, 0.0) == (0.0, 0.0)


@given(north_m=PLACE, east_m=PLACE)
def test_no_water_comes_from_nowhere(north_m: float, east_m: float) -> None:
    water, h = Current(Environment(river=RIVER, gyre=GYRE)), 1e-4
    if abs(abs(north_m - 10.0) - 10.0) < 0.01:
        return  # the banks, where the profile has its kink
    along = (water.at(north_m + h, east_m, 0.0)[0] - water.at(north_m - h, east_m, 0.0)[0]) / (2.0 * h)
    across = (water.at(north_m, east_m + h, 0.0)[1] - water.at(north_m, east_m - h, 0.0)[1]) / (2.0 * h)
    assert along + across == pytest.approx(0.0, abs=1e-8)


def test_a_tide_turns_every_half_period() -> None:
    water = Current(Environment(tide=Tide(speed_m_s=0.6, to_deg=0.0, period_s=100.0, strongest_s=10.0)))
    assert [water.at(0.0, 0.0, time_s)[0] for time_s in (10.0, 35.0, 60.0)] == pytest.approx([0.6, 0.0, -0.6])
    tide = "environment.tide={speed_m_s=0.6, to_deg=0.0, period_s=100.0, strongest_s=0.0}"
    assert World(load_scenario("open", [tide])).truth.current_north_m_s == 0.6


def test_all_currents_of_a_scenario_are_summed_and_a_plain_one_is_uniform() -> None:
    plain = Environment(current_m_s=0.2, current_to_deg=0.0)
    assert Current(plain).is_uniform
    both = Current(Environment(current_m_s=0.2, current_to_deg=0.0, river=RIVER))
    assert not both.is_uniform
    assert both.at(10.0, 0.0, 0.0) == pytest.approx((0.2, 1.0))


def test_a_grid_is_linear_between_its_points_and_constant_outside(tmp_path: Path) -> None:
    path = tmp_path / "water.csv"
    path.write_text(CSV)
    grid = read_grid(path)
    assert grid.at(0.0, 0.0, 0.0) == (0.0, 0.0)
    assert grid.at(5.0, 2.5, 0.0) == pytest.approx((0.1, 0.25))
    assert grid.at(20.0, 10.0, 0.0) == pytest.approx((0.4, 1.0))
    assert grid.at(99.0, -99.0, 1e6) == pytest.approx((0.4, 0.0))


def test_a_grid_in_time_is_linear_between_its_sheets(tmp_path: Path) -> None:
    path = tmp_path / "water.npz"
    sheet = np.array([[1.0] * 3, [1.0] * 3, [3.0] * 3])
    np.savez(
        path,
        time_s=[0.0, 100.0],
        north_m=[0.0, 1.0, 2.0],
        east_m=[0.0, 1.0, 2.0],
        current_north_m_s=np.stack([0.0 * sheet, 1.0 * sheet]),
        current_east_m_s=np.full((2, 3, 3), 0.5),
    )
    grid = read_grid(path)
    assert grid.at(0.3, 1.7, 25.0) == pytest.approx((0.25, 0.5))
    assert grid.at(0.3, 1.7, 1000.0) == pytest.approx((1.0, 0.5))


@pytest.mark.parametrize(
    ("name", "text", "what"),
    [
        ("none.csv", None, "No such file"),
        ("bare.csv", "east_m,north_m\n1,2\n", "it has no current_east_m_s, current_north_m_s"),
        ("word.csv", CSV + "x,0,0,0\n", "line 6: expected four numbers"),
        ("twice.csv", CSV + "20,10,1,1\n", "line 6: the point (10, 20) comes twice"),
        ("hole.csv", CSV + "30,10,1,1\n", "5 points are no grid of 2 × 3"),
        ("nan.csv", CSV.replace("0.4", "nan"), "current_north_m_s: expected finite numbers"),
        ("not.npz", "hello", "not a current"),
        ("empty.csv", "east_m,north_m,current_east_m_s,current_north_m_s\n", "0 points are no grid"),
    ],
)
def test_a_file_that_is_no_current_is_named_with_what_is_wrong(
    tmp_path: Path, name: str, text: str | None, what: str
) -> None:
    path = tmp_path / name
    if text is not None:
        path.write_text(text)
    with pytest.raises(ConfigError) as caught:
        read_grid(path)
    assert str(path) in str(caught.value)
    assert what in str(caught.value)


def test_a_scenarios_current_file_lies_beside_it(tmp_path: Path) -> None:
    (tmp_path / "water.csv").write_text(CSV)
    scenario = tmp_path / "mine.toml"
    scenario.write_text(
        '[origin]\nlat_deg = 50.0\nlon_deg = 0.0\n[environment]\ncurrent_file = "water.csv"\n'
    )
    water = World(load_scenario(str(scenario), ["boat.start=[10.0, 20.0]"]))
    assert (water.truth.current_north_m_s, water.truth.current_east_m_s) == pytest.approx((0.4, 1.0))


def test_a_boat_that_enters_a_stream_keeps_its_way_over_ground_at_first_and_is_then_carried() -> None:
    wall = "environment.river={speed_m_s=1.0, width_m=10.0, through=[0.0, 20.0], to_deg=90.0}"
    water = World(load_scenario("open", ["sensors.sonar.fitted=false", wall, "boat.heading_deg=0"]))
    water.hardware.motors.write(0.6, 0.6)
    fastest = 0.0
    while water.truth.north_m < 20.0:
        before = water.truth
        truth = water.step(DT_S)
        fastest = max(fastest, abs(truth.east_m_s - before.east_m_s))
    assert fastest < 0.05  # no jump over ground
    assert water.truth.east_m_s > 0.4
    assert water.truth.sway_m_s < -0.1  # the stream has not caught it yet: the water still passes it
