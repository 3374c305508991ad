"""Gusts and their force: strength, direction, symmetry, and what a boat does in them."""

import math
import statistics

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sitl.scenarios.scenario import load_scenario
from sitl.world.environment.settings import Environment
from sitl.world.environment.wind import PEAK_FACTOR, Wind
from sitl.world.hull_settings import WindageSettings
from sitl.world.truth import Truth
from sitl.world.windage import AIR_KG_M3, Windage
from sitl.world.world import World

DT_S = 0.02
SPEED = st.floats(-15.0, 15.0)
BOAT = WindageSettings()


def speeds(wind: Wind, for_s: float) -> list[tuple[float, float]]:
    out = []
    for tick in range(round(for_s * 10)):
        wind.step(tick / 10.0)
        out.append((wind.north_m_s, wind.east_m_s))
    return out


@pytest.mark.parametrize(
    ("from_deg", "north", "east"),
    [(0.0, -6.0, 0.0), (90.0, 0.0, -6.0), (180.0, 6.0, 0.0), (225.0, 4.243, 4.243)],
)
def test_a_steady_wind_blows_from_where_it_is_said_to_come(
    from_deg: float, north: float, east: float
) -> None:
    wind = Wind(Environment(wind_m_s=6.0, wind_from_deg=from_deg), seed=1)
    assert set(speeds(wind, 5.0)) == {(wind.north_m_s, wind.east_m_s)}
    assert [wind.north_m_s, wind.east_m_s] == pytest.approx([north, east], abs=1e-3)


def test_gusts_peak_near_the_given_speed_within_ten_minutes_and_keep_the_mean() -> None:
    weather = Environment(wind_m_s=5.0, wind_from_deg=0.0, gust_m_s=8.0)
    runs = [speeds(Wind(weather, seed), 600.0) for seed in range(8)]
    peaks = [max(math.hypot(*one) for one in run) for run in runs]
    assert statistics.mean(peaks) == pytest.approx(8.0, abs=0.5)
    assert max(peaks) < 10.0
    assert statistics.mean(-north for run in runs for north, _ in run) == pytest.approx(5.0, abs=0.1)
    assert abs(statistics.mean(east for run in runs for _, east in run)) < 0.1


def test_gusts_forget_themselves_with_their_correlation_time() -> None:
    wind = Wind(Environment(wind_m_s=5.0, gust_m_s=8.0, gust_s=4.0), seed=3)
    along = [-north - 5.0 for north, _ in speeds(wind, 10_000.0)]
    power = statistics.fmean(one * one for one in along)
    for lag_s in (2.0, 4.0, 8.0):
        steps = round(lag_s * 10)
        product = statistics.fmean(one * other for one, other in zip(along, along[steps:], strict=False))
        assert product / power == pytest.approx(math.exp(-lag_s / 4.0), abs=0.05)
    assert math.sqrt(power) == pytest.approx(3.0 / PEAK_FACTOR, abs=0.05)


def test_gusts_below_the_mean_are_refused() -> None:
    with pytest.raises(ValueError, match="gust_m_s = 3: expected at least wind_m_s = 5"):
        Environment(wind_m_s=5.0, gust_m_s=3.0)


def test_a_headwind_pushes_back_and_a_beam_wind_aside_as_the_formula_says() -> None:
    windage = Windage(BOAT, 1.0)
    surge_n, sway_n, yaw_nm = windage.force(-8.0, 0.0)
    assert surge_n == pytest.approx(-0.5 * AIR_KG_M3 * 0.8 * 0.05 * 64.0)
    assert (sway_n, yaw_nm) == (0.0, 0.0)
    surge_n, sway_n, yaw_nm = windage.force(0.0, 8.0)  # from port
    assert sway_n == pytest.approx(0.5 * AIR_KG_M3 * 0.9 * 0.14 * 64.0)
    assert (surge_n, yaw_nm) == (0.0, 0.0)


def test_the_moment_is_that_of_the_lever_and_of_the_slender_body() -> None:
    windage = Windage(WindageSettings(lever_m=0.1), 2.0)
    _, sway_n, yaw_nm = windage.force(3.0, 6.0)
    body_nm = AIR_KG_M3 * BOAT.turning * BOAT.lateral_area_m2 * 2.0 * 3.0 * 6.0
    assert yaw_nm == pytest.approx(0.1 * sway_n - body_nm)


@given(ahead=SPEED, starboard=SPEED)
def test_the_force_is_mirrored_with_the_wind_and_grows_with_its_square(
    ahead: float, starboard: float
) -> None:
    windage = Windage(BOAT, 1.0)
    surge_n, sway_n, yaw_nm = windage.force(ahead, starboard)
    assert windage.force(ahead, -starboard) == (surge_n, -sway_n, -yaw_nm)
    quadruple = [4.0 * surge_n, 4.0 * sway_n, 4.0 * yaw_nm]
    assert list(windage.force(2.0 * ahead, 2.0 * starboard)) == pytest.approx(quadruple, abs=1e-300)
    assert surge_n * ahead + sway_n * starboard >= 0.0  # the air gives work, never takes it


def drift(*settings: str, for_s: float) -> Truth:
    water = World(load_scenario("open", ["sensors.sonar.fitted=false", *settings]))
    for _ in range(round(for_s / DT_S)):
        water.step(DT_S)
    return water.truth


def test_a_boat_with_stopped_motors_drifts_downwind_at_a_few_percent_of_the_wind() -> None:
    truth = drift("environment.wind_m_s=8", "environment.wind_from_deg=270", for_s=120.0)
    assert 0.04 * 8.0 < truth.east_m_s < 0.07 * 8.0
    assert (truth.wind_north_m_s, truth.wind_east_m_s) == pytest.approx((0.0, 8.0), abs=1e-9)


def test_another_wind_can_be_made_to_blow_at_run_time() -> None:
    water = World(load_scenario("open"))
    assert water.wind.is_calm
    water.wind.set_wind(6.0, math.pi)
    for _ in range(100):
        water.step(DT_S)
    assert water.truth.wind_north_m_s == pytest.approx(6.0)
    assert water.truth.north_m_s > 0.0
    water.wind.set_wind(0.0, 0.0)
    assert water.wind.is_calm
