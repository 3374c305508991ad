"""What is wrong with sensors that are well: reflections, iron, motors' leads, spray, ghosts, noise."""

import math
import statistics
from typing import Any

import msgspec
import pytest
import shapely

from companion.core.geo import LatLon, LocalFrame
from mission_tools.maps.chart import build_chart
from sitl.world.environment.settings import Environment
from sitl.world.environment.waves import Waves
from sitl.world.sensors.battery_monitor import SimBattery
from sitl.world.sensors.compass import BodyField, SimCompass
from sitl.world.sensors.gnss import SimGnss
from sitl.world.sensors.rangers import SonarSettings
from sitl.world.sensors.receivers import GnssSettings
from sitl.world.sensors.settings import BatteryMonitorSettings, CompassSettings
from sitl.world.sensors.sonar import SimSonar
from sitl.world.shore import Shore

FRAME = LocalFrame(LatLon(50.0, -1.2))
BASIN = Shore(build_chart("basin", FRAME, shapely.box(-3.0, -2.0, 3.0, 2.0), ()), reach_m=4.0)
NO_NOISE: dict[str, Any] = dict.fromkeys(
    ("noise_deg", "bias_deg", "gyro_noise_deg_s", "gyro_bias_deg_s"), 0.0
)


def gnss_deviation_m(east_m: float, shore: Shore) -> float:
    settings = GnssSettings(
        rate_hz=1.0, latency_s=0.0, noise_m=0.0, wander_m=0.0, slow_m=0.0,
        multipath_m=1.0, multipath_reach_m=2.0,
    )  # fmt: skip
    gnss = SimGnss(settings, FRAME, 1, shore)
    errors = []
    for second in range(4_000):
        gnss.sample(float(second), 0.0, east_m, 0.0, 0.0)
        fix = gnss.read()
        if fix is not None:
            errors.append(FRAME.to_local(fix.position).east_m - east_m)
    return statistics.pstdev(errors)


def test_reflections_grow_towards_the_waters_edge_and_are_gone_beyond_their_reach() -> None:
    wide = Shore(build_chart("wide", FRAME, shapely.box(-30.0, -30.0, 30.0, 30.0), ()), reach_m=4.0)
    assert gnss_deviation_m(30.0, wide) == pytest.approx(1.0, rel=0.15)
    assert gnss_deviation_m(29.0, wide) == pytest.approx(0.5, rel=0.15)
    assert gnss_deviation_m(27.9, wide) < 1e-6


def deviations_deg(motor_current_a: float = 0.0, **iron: Any) -> list[float]:  # noqa: ANN401
    """Of a compass on every tenth degree."""
    out = []
    for heading_deg in range(0, 360, 10):
        compass = SimCompass(CompassSettings(**NO_NOISE, **iron), 1)
        heading_rad = math.radians(heading_deg)
        compass.sample(0.0, heading_rad, 0.0, motor_current_a)
        reading = compass.read()
        assert reading is not None
        out.append(math.degrees(math.remainder(reading.heading_rad - heading_rad, 2.0 * math.pi)))
    return out


def test_hard_iron_turns_once_with_the_heading_and_soft_iron_twice() -> None:
    hard = deviations_deg(hard_iron_deg=5.0, hard_iron_at_deg=30.0)
    soft = deviations_deg(soft_iron_deg=3.0, soft_iron_at_deg=0.0)
    assert max(hard) == pytest.approx(5.0)
    assert hard[3] == pytest.approx(0.0, abs=1e-9)
    assert [a + b for a, b in zip(hard, hard[18:], strict=False)] == pytest.approx([0.0] * 18, abs=1e-9)
    assert soft[:18] == pytest.approx(soft[18:], abs=1e-9)
    assert max(soft) == pytest.approx(3.0, rel=0.02)
    assert sum(soft) == pytest.approx(0.0, abs=1e-9)


def test_the_field_at_a_magnetometer_is_that_of_the_same_iron() -> None:
    iron: dict[str, Any] = {
        "hard_iron_deg": 4.0, "hard_iron_at_deg": 30.0, "soft_iron_deg": 2.0, "soft_iron_at_deg": 20.0,
        "motor_deg_per_a": 0.25,
    }  # fmt: skip
    field = BodyField(CompassSettings(**NO_NOISE, **iron, magnetometer_mg=200.0, dip_deg=60.0), lambda: 0.0)
    for number, deviation_deg in enumerate(deviations_deg(4.0, **iron)):
        heading_rad = math.radians(10.0 * number)
        ahead, aside, down = field.at(heading_rad, 4.0)
        off_rad = math.remainder(math.atan2(-aside, ahead) - heading_rad, math.tau)
        assert math.degrees(off_rad) == pytest.approx(deviation_deg, abs=0.5)
        assert down == pytest.approx(math.tan(math.radians(60.0)) * 200.0)


def test_the_motors_leads_pull_the_compass_as_hard_as_they_carry_current() -> None:
    weak, strong = (deviations_deg(current_a, motor_deg_per_a=0.5) for current_a in (2.0, 8.0))
    assert max(weak) == pytest.approx(1.0)
    assert strong == pytest.approx([4.0 * one for one in weak])
    assert deviations_deg(0.0, motor_deg_per_a=0.5) == pytest.approx([0.0] * 36, abs=1e-9)


def test_the_gyros_bias_wanders_as_far_in_a_minute_as_it_should() -> None:
    after_deg_s = []
    for seed in range(100):
        compass = SimCompass(CompassSettings(rate_hz=5.0, **NO_NOISE, gyro_walk_deg_s=0.5), seed)
        for sample in range(301):
            compass.sample(sample * 0.2, 0.0, 0.0)
        reading = compass.read()
        assert reading is not None
        assert reading.yaw_rate_rad_s is not None
        after_deg_s.append(math.degrees(reading.yaw_rate_rad_s))
    assert statistics.pstdev(after_deg_s) == pytest.approx(0.5, rel=0.2)


# Everything is heard
SURE: dict[str, Any] = {"noise_m": 0.0, "scatter_db": 0.0, "half_range_m": 100.0, "ghost_share": 0.0}


def ranges(settings: SonarSettings, heading_deg: float = 0.0, wave_m: float = 0.0) -> list[float | None]:
    """Of a ranger that is too high for its beam to meet the water."""
    sonar = SimSonar(msgspec.structs.replace(settings, height_m=100.0), BASIN, 1)
    sea = Waves(Environment(wave_height_m=wave_m, wave_period_s=3.0), 1.0, 1)
    out: list[float | None] = []
    for ping in range(5_000):
        sonar.sample(ping * settings.ping_s, 0.0, 0.0, math.radians(heading_deg), sea)
        out += [heard.range_m for heard in sonar.read()]
    return out


def test_a_wall_met_at_a_flat_angle_mirrors_the_ping_away() -> None:
    settings = SonarSettings(**SURE, sweep_deg=0.0, cone_deg=0.0, specular_deg=25.0)
    assert set(ranges(settings, 0.0)) == {2.0}
    assert {one and round(one, 9) for one in ranges(settings, 20.0)} == {
        round(2.0 / math.cos(math.radians(20.0)), 9)
    }
    assert set(ranges(settings, 40.0)) == {None}


def test_spray_makes_near_echoes_in_waves_alone() -> None:
    settings = SonarSettings(**SURE, sweep_deg=0.0, spray_per_m=0.4)
    calm, rough = ranges(settings), ranges(settings, wave_m=0.5)
    assert set(calm) == {2.0}
    sprayed = [one for one in rough if one is not None and one < 1.0]
    assert len(sprayed) / len(rough) == pytest.approx(0.2, rel=0.1)
    assert max(sprayed) < 0.7


def test_ghosts_are_as_frequent_as_asked_for_and_anywhere() -> None:
    heard = ranges(SonarSettings(**{**SURE, "ghost_share": 0.1}, sweep_deg=0.0))
    ghosts = [one for one in heard if one is not None and one != 2.0]
    assert len(ghosts) / len(heard) == pytest.approx(0.1, rel=0.1)
    assert min(ghosts) < 0.2
    assert max(ghosts) > 3.8


def test_the_battery_monitor_has_the_noise_and_the_gain_asked_for() -> None:
    settings = BatteryMonitorSettings(voltage_noise_v=0.1, current_noise_a=0.2, current_gain=1.1)
    battery = SimBattery(10.0, settings, 1)
    heard = []
    for sample in range(5000):
        battery.sample(sample * 0.1, 12.0, 3.0)
        reading = battery.read()
        assert reading is not None
        assert reading.current_a is not None
        heard.append((reading.voltage_v, reading.current_a))
    volts, amperes = zip(*heard, strict=True)
    assert (statistics.fmean(volts), statistics.fmean(amperes)) == pytest.approx((12.0, 3.3), abs=0.02)
    assert (statistics.pstdev(volts), statistics.pstdev(amperes)) == pytest.approx((0.1, 0.2), rel=0.05)
