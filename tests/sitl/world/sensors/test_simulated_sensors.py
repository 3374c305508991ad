"""What the simulated receivers say: rates, latency, statistics, and numbers of their own."""

import itertools
import math
import statistics
from typing import Any

import pytest
import shapely

from companion.core.geo import LatLon, LocalFrame
from companion.core.readings import GnssFix, HeadingReading, SonarReading
from mission_tools.maps.chart import build_chart
from sitl.world.sensors.compass import SimCompass
from sitl.world.sensors.gnss import SimGnss
from sitl.world.sensors.rangers import SonarSettings
from sitl.world.sensors.receivers import GnssSettings
from sitl.world.sensors.settings import CompassSettings
from sitl.world.sensors.sonar import SimSonar, sweep_bearings_rad
from sitl.world.shore import Shore

DT_S = 0.02
# Everything is heard
SURE: dict[str, Any] = {"noise_m": 0.0, "scatter_db": 0.0, "half_range_m": 100.0, "ghost_share": 0.0}
FRAME = LocalFrame(LatLon(50.0, -1.2))
BASIN = Shore(build_chart("basin", FRAME, shapely.box(-3.0, -2.0, 3.0, 2.0), ()), reach_m=4.0)


def fixes(settings: GnssSettings, seconds: float, seed: int = 1) -> list[GnssFix]:
    gnss = SimGnss(settings, FRAME, seed)
    out: list[GnssFix] = []
    for tick in range(round(seconds / DT_S)):
        gnss.sample(tick * DT_S, 100.0, -50.0, 1.5, -0.5)
        fix = gnss.read()
        if fix is not None and (not out or fix is not out[-1]):
            out.append(fix)
    return out


def headings(settings: CompassSettings, seconds: float, seed: int = 1) -> list[HeadingReading]:
    compass = SimCompass(settings, seed)
    out = []
    for tick in range(round(seconds / DT_S)):
        compass.sample(tick * DT_S, 1.0, 0.2)
        reading = compass.read()
        assert reading is not None
        out.append(reading)
    return out


def pings(
    settings: SonarSettings, seconds: float, heading_rad: float = 0.0, seed: int = 1
) -> list[SonarReading]:
    sonar = SimSonar(settings, BASIN, seed)
    out: list[SonarReading] = []
    for tick in range(round(seconds / DT_S)):
        sonar.sample(tick * DT_S, 0.0, 0.0, heading_rad)
        out.extend(sonar.read())
    return out


def test_white_noise_and_wander_have_the_deviations_asked_for() -> None:
    settings = GnssSettings(
        rate_hz=50.0, noise_m=0.1, wander_m=0.3, wander_s=2.0, slow_m=0.0,
        velocity_noise_m_s=0.05, velocity_noise_s=0.0, jitter_s=0.0,
    )  # fmt: skip
    heard = fixes(settings, 600.0)
    north = [FRAME.to_local(fix.position).north_m - 100.0 for fix in heard]
    assert statistics.pstdev(north) == pytest.approx(math.hypot(0.1, 0.3), rel=0.1)
    assert statistics.fmean(north) == pytest.approx(0.0, abs=0.06)
    # From one fix to the next the wander hardly moves: what remains is √2 × white noise.
    step = [b - a for a, b in itertools.pairwise(north)]
    drift = 0.3 * math.sqrt(2.0 * (1.0 - math.exp(-0.01)))
    assert statistics.pstdev(step) == pytest.approx(math.hypot(0.1 * math.sqrt(2.0), drift), rel=0.03)
    # Fixes many correlation times apart have nothing to do with each other.
    far = [a * b for a, b in zip(north, north[1000:], strict=False)]
    assert statistics.fmean(far) / statistics.pvariance(north) == pytest.approx(0.0, abs=0.15)
    speeds = [fix.north_m_s for fix in heard if fix.north_m_s is not None]
    assert statistics.fmean(speeds) == pytest.approx(1.5, abs=0.002)
    assert statistics.pstdev(speeds) == pytest.approx(0.05, rel=0.03)
    assert statistics.fmean(fix.east_m_s or 0.0 for fix in heard) == pytest.approx(-0.5, abs=0.002)


def test_compass_and_gyro_have_bias_and_noise_as_asked_for() -> None:
    settings = CompassSettings(noise_deg=2.0, bias_deg=5.0, gyro_noise_deg_s=1.0, gyro_bias_deg_s=-0.5)
    heard = headings(settings, 200.0)
    heading_deg = [math.degrees(reading.heading_rad - 1.0) for reading in heard]
    rate_deg_s = [math.degrees((reading.yaw_rate_rad_s or 0.0) - 0.2) for reading in heard]
    assert statistics.fmean(heading_deg) == pytest.approx(5.0, abs=0.1)
    assert statistics.pstdev(heading_deg) == pytest.approx(2.0, rel=0.05)
    assert statistics.fmean(rate_deg_s) == pytest.approx(-0.5, abs=0.05)
    assert statistics.pstdev(rate_deg_s) == pytest.approx(1.0, rel=0.05)


def test_the_sweep_goes_to_and_fro_from_port_to_starboard() -> None:
    degrees = [round(math.degrees(bearing)) for bearing in sweep_bearings_rad(SonarSettings())]
    assert degrees[:3] == [-90, -75, -60]
    assert degrees[12] == 90
    assert degrees[13:] == [75, 60, 45, 30, 15, 0, -15, -30, -45, -60, -75]
    assert sweep_bearings_rad(SonarSettings(sweep_deg=0.0)) == (0.0,)


def test_pings_come_every_sixty_milliseconds_and_measure_the_walls() -> None:
    settings = SonarSettings(**SURE, cone_deg=0.0, servo_dead_s=0.0, servo_deg_s=1000.0)
    heard = pings(settings, 0.78)
    assert [ping.time_s for ping in heard] == pytest.approx([0.06 * n for n in range(13)])
    by_bearing = {round(math.degrees(ping.bearing_rad)): ping.range_m for ping in heard}
    assert by_bearing[-90] == pytest.approx(3.0)
    assert by_bearing[0] == pytest.approx(2.0)
    assert by_bearing[45] == pytest.approx(2.0 * math.sqrt(2.0))
    assert by_bearing[90] == pytest.approx(3.0)


def test_a_wide_cone_hears_the_nearest_of_what_it_covers() -> None:
    narrow, wide = (
        pings(SonarSettings(**SURE, sweep_deg=0.0, cone_deg=cone), 0.1, math.radians(60.0))[0].range_m
        for cone in (0.0, 40.0)
    )
    assert narrow == pytest.approx(3.0 / math.sin(math.radians(60.0)))
    # At 1.5 half cones, the left edge of what is heard of a loud echo meets the north wall.
    assert wide == pytest.approx(2.0 / math.cos(math.radians(60.0 - 1.5 * 20.0)))


def test_sonar_noise_stays_within_the_parts_range() -> None:
    settings = SonarSettings(**{**SURE, "noise_m": 1.0}, min_range_m=0.5, max_range_m=3.5)
    ranges = [ping.range_m for ping in pings(settings, 60.0) if ping.range_m is not None]
    assert min(ranges) == 0.5
    assert max(ranges) == 3.5


def test_unread_pings_do_not_pile_up() -> None:
    sonar = SimSonar(SonarSettings(), BASIN, 1)
    for tick in range(10_000):
        sonar.sample(tick * DT_S, 0.0, 0.0, 0.0)
    assert len(sonar.read()) == 64
    assert sonar.read() == []


def test_the_same_seed_gives_the_same_pings_and_another_gives_others() -> None:
    assert pings(SonarSettings(), 2.0) == pings(SonarSettings(), 2.0)
    assert pings(SonarSettings(), 2.0, seed=2) != pings(SonarSettings(), 2.0)
