"""Waves: their height, their drift, and what they do to hull and propellers."""

import math
import statistics

import pytest
from msgspec.structs import replace

from sitl.scenarios.scenario import load_scenario
from sitl.world.environment.settings import Environment
from sitl.world.environment.waves import Waves
from sitl.world.sensors.compass import SimCompass
from sitl.world.sensors.settings import CompassSettings
from sitl.world.truth import Truth
from sitl.world.world import World

DT_S = 0.02
SEA = Environment(wave_height_m=0.3, wave_period_s=2.5, wave_from_deg=0.0)


def watch(waves: Waves, for_s: float) -> list[tuple[float, float, float, float]]:
    out = []
    for tick in range(round(for_s / 0.1)):
        waves.step(tick * 0.1, 0.0, 0.0, 1.0, 0.0)
        out.append((waves.heave_m, waves.north_m_s, waves.east_m_s, waves.yaw_rate_rad_s))
    return out


def test_the_significant_height_is_four_standard_deviations() -> None:
    heaves = [one[0] for seed in range(10) for one in watch(Waves(SEA, 0.01, seed), 300.0)]
    assert 4.0 * statistics.pstdev(heaves) == pytest.approx(0.3, rel=0.05)


def test_waves_run_to_where_they_do_not_come_from_and_carry_the_boat_there() -> None:
    waves = Waves(SEA, 0.01, 1)
    assert waves.drift_north_m_s < -0.02
    assert abs(waves.drift_east_m_s) < 0.4 * abs(waves.drift_north_m_s)
    assert statistics.fmean(one[1] for one in watch(waves, 1000.0)) == pytest.approx(
        waves.drift_north_m_s, abs=0.005
    )


def test_waves_from_ahead_do_not_turn_the_boat_but_those_from_the_bow_quarter_do() -> None:
    waves = Waves(Environment(wave_height_m=0.3, wave_period_s=2.5, wave_from_deg=45.0), 1.0, 1)
    yaw = [one[3] for one in watch(waves, 200.0)]
    assert statistics.pstdev(yaw) > 0.02
    assert abs(statistics.fmean(yaw)) < 0.01


def test_a_sea_that_is_turned_with_the_boat_moves_it_the_same() -> None:
    cos, sin = math.cos(1.0), math.sin(1.0)
    ahead, turned = (Waves(replace(SEA, wave_from_deg=20.0 + math.degrees(by)), 1.0, 1) for by in (0.0, 1.0))
    for tick in range(50):
        ahead.step(0.1 * tick, 0.0, 0.0, 1.0, 0.0)
        turned.step(0.1 * tick, 0.0, 0.0, cos, sin)
        motion = (turned.yaw_rate_rad_s, turned.heave_m, turned.stern_m)
        assert motion == pytest.approx((ahead.yaw_rate_rad_s, ahead.heave_m, ahead.stern_m))


def test_a_hull_much_shorter_than_the_waves_follows_the_water_at_its_stern() -> None:
    waves = Waves(SEA, 0.01, 1)
    for tick in range(50):
        waves.step(0.1 * tick, 0.0, 0.0, 1.0, 0.0)
        assert abs(waves.stern_m) < 1e-5


def test_a_breaking_sea_is_refused() -> None:
    with pytest.raises(ValueError, match=r"wave_height_m = 0\.5: expected at most 0\.1 with waves of 1 s"):
        Environment(wave_height_m=0.5, wave_period_s=1.0)


def sailed(*settings: str, throttle: float, for_s: float) -> list[Truth]:
    water = World(load_scenario("open", ["sensors.sonar.fitted=false", *settings]))
    water.hardware.motors.write(throttle, throttle)
    return [water.step(DT_S) for _ in range(round(for_s / DT_S))]


WAVES = ("environment.wave_height_m=0.3", "environment.wave_period_s=2.5", "environment.wave_from_deg=45")


def test_a_boat_adrift_in_waves_moves_to_and_fro_and_slowly_along_with_them() -> None:
    truths = sailed(*WAVES, throttle=0.0, for_s=120.0)
    assert statistics.pstdev(one.north_m_s for one in truths) > 0.1
    last = truths[-1]
    assert last.north_m < -1.0
    assert last.east_m < -1.0
    assert last.current_north_m_s == pytest.approx(last.north_m / 120.0, abs=0.02)


def test_propellers_suck_air_now_and_then_in_a_steep_sea() -> None:
    steep = ("environment.wave_height_m=0.22", "environment.wave_period_s=1.5", "environment.wave_from_deg=0")
    shallow = "thrusters.propeller.depth_m=0.015"
    thrusts = [one.left_thrust_n for one in sailed(*steep, shallow, throttle=0.6, for_s=60.0)[500:]]
    assert min(thrusts) < 0.8 * max(thrusts)
    calm = [one.left_thrust_n for one in sailed(throttle=0.6, for_s=60.0)[500:]]
    assert min(calm) == pytest.approx(max(calm), rel=0.05)


def test_the_hull_lies_along_the_water() -> None:
    """A short hull's roll and pitch are the slopes of the surface, by differences of its height."""
    waves, cos, sin = Waves(SEA, 0.01, 3), math.cos(0.7), math.sin(0.7)
    for tick in range(100):
        now_s, north_m, east_m = 0.1 * tick, 0.3 * tick, -0.2 * tick
        waves.step(now_s, north_m, east_m, cos, sin)
        height_m, slope_n, slope_e = waves.surface(north_m, east_m, now_s)
        assert waves.heave_m == pytest.approx(height_m, abs=1e-4)

        ahead = waves.surface(north_m + 0.01 * cos, east_m + 0.01 * sin, now_s)[0] - height_m
        aside = waves.surface(north_m - 0.01 * sin, east_m + 0.01 * cos, now_s)[0] - height_m
        assert waves.pitch_rad == pytest.approx(ahead / 0.01, abs=0.005)
        assert waves.roll_rad == pytest.approx(-aside / 0.01, abs=0.005)
        assert slope_n * cos + slope_e * sin == pytest.approx(waves.pitch_rad, abs=1e-5)


def test_a_long_hull_leans_less_than_a_short_one() -> None:
    leans = []
    for length_m in (0.01, 1.0, 3.0):
        waves, pitch = Waves(replace(SEA, wave_period_s=1.8), length_m, 3), []
        for tick in range(3000):
            waves.step(0.1 * tick, 0.0, 0.0, 1.0, 0.0)
            pitch.append(waves.pitch_rad)
        leans.append(statistics.pstdev(pitch))
    assert leans == sorted(leans, reverse=True)
    assert leans[0] > 1.3 * leans[2]


def test_the_compass_reports_the_lean_and_a_bare_one_compensates_it() -> None:
    for settings in (
        CompassSettings(noise_deg=0.0, bias_deg=0.0),
        CompassSettings(noise_deg=0.0, bias_deg=0.0, magnetometer_mg=200.0),
    ):
        compass = SimCompass(settings, 1)
        compass.sample(0.0, 0.8, 0.0, lean=(0.2, -0.1))
        heard = compass.read()
        assert heard is not None
        assert (heard.roll_rad, heard.pitch_rad) == (0.2, -0.1)
        assert heard.heading_rad == pytest.approx(0.8, abs=1e-6)
    plain = SimCompass(CompassSettings(reports_lean=False), 1)
    plain.sample(0.0, 0.8, 0.0, lean=(0.2, -0.1))
    reading = plain.read()
    assert reading is not None
    assert reading.roll_rad is reading.pitch_rad is None


def test_a_boat_in_waves_knows_its_roll_and_pitch() -> None:
    world = World(load_scenario("open", ["environment.wave_height_m=0.2", "environment.wave_from_deg=45"]))
    for _ in range(100):
        world.step(DT_S)
        reading = world.hardware.compass.read()
        assert reading is not None
        assert (reading.roll_rad, reading.pitch_rad) == (world.waves.roll_rad, world.waves.pitch_rad)
        assert reading.roll_rad != 0.0 != reading.pitch_rad
