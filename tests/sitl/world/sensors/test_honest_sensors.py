"""The emulated sensors are no better than real ones, and what the boat assumes of them is not quite so."""

import math
import statistics
from typing import Any

import pytest
import shapely

from companion.core.geo import LatLon, LocalFrame
from companion.core.readings import GnssFix, HeadingReading
from mission_tools.maps.chart import build_chart
from sitl.world.sensors.compass import SimCompass
from sitl.world.sensors.gnss import SimGnss, stated_accuracy_m
from sitl.world.sensors.rangers import SonarSettings
from sitl.world.sensors.receivers import GnssSettings
from sitl.world.sensors.settings import CompassSettings
from sitl.world.sensors.sonar import SimSonar
from sitl.world.shore import Shore

DT_S = 0.02
FRAME = LocalFrame(LatLon(50.0, -1.2))
STILL: dict[str, Any] = {"noise_deg": 0.0, "bias_deg": 0.0, "gyro_noise_deg_s": 0.0, "gyro_bias_deg_s": 0.0}


def arrivals(gnss: SimGnss, seconds: float) -> list[tuple[float, GnssFix]]:
    """When each fix came, and the fix."""
    out: list[tuple[float, GnssFix]] = []
    for tick in range(round(seconds / DT_S)):
        now_s = tick * DT_S
        gnss.sample(now_s, 0.0, 0.0, 0.0, 0.0)
        fix = gnss.read()
        if fix is not None and (not out or fix is not out[-1][1]):
            out.append((now_s, fix))
    return out


def test_by_default_fixes_come_a_tenth_to_three_tenths_of_a_second_late_and_in_order() -> None:
    heard = arrivals(SimGnss(GnssSettings(), FRAME, 1), 60.0)
    delays_s = [came_s - 0.2 * number for number, (came_s, _) in enumerate(heard)]
    assert min(delays_s) >= 0.1
    assert max(delays_s) <= 0.3 + DT_S
    assert statistics.pstdev(delays_s) > 0.02
    stamps_s = [fix.time_s for _, fix in heard]
    assert stamps_s == sorted(stamps_s)


def test_a_fix_is_dated_by_arrival_until_the_shortest_delay_has_been_seen() -> None:
    heard = arrivals(SimGnss(GnssSettings(), FRAME, 1, assumed_latency_s=0.1), 60.0)
    first_s, first = heard[0]
    assert first.time_s == pytest.approx(first_s - 0.1)  # nothing but its arrival is known of the first
    errors_s = [fix.time_s - 0.2 * number for number, (_, fix) in enumerate(heard)]
    # Then only what the boat's configuration is off by remains, and a tick.
    assert all(0.05 <= error_s <= 0.05 + DT_S for error_s in errors_s[50:])


def test_stated_accuracy_is_a_class_and_says_nothing_of_the_errors() -> None:
    good, bad = GnssSettings(noise_m=0.01, wander_m=0.0), GnssSettings(noise_m=2.0, wander_m=3.0)
    told = {
        fix.horizontal_accuracy_m
        for settings in (good, bad)
        for _, fix in arrivals(SimGnss(settings, FRAME, 1), 5.0)
    }
    assert told == {stated_accuracy_m(3, 0.9)}
    assert stated_accuracy_m(3, 0.9) == pytest.approx(1.1)
    assert stated_accuracy_m(3, 1.8) == pytest.approx(2.2)
    assert [round(stated_accuracy_m(kind, 0.9), 3) for kind in (4, 5, 6)] == [0.6, 0.3, 0.015]


def reading(
    settings: CompassSettings, heading_rad: float, rate: float, surge: float, added: float = 0.0
) -> HeadingReading:
    compass = SimCompass(settings, 1, added)
    compass.sample(0.0, heading_rad, rate, 0.0, surge)
    heard = compass.read()
    assert heard is not None
    return heard


def off_deg(
    settings: CompassSettings, heading_deg: float, rate: float, surge: float, added: float = 0.0
) -> float:
    heard = reading(settings, math.radians(heading_deg), rate, surge, added)
    return math.degrees(heard.heading_rad) - heading_deg


def test_declination_is_taken_out_as_far_as_the_boat_is_configured_for_it() -> None:
    settings = CompassSettings(**STILL, declination_deg=-3.0)
    assert off_deg(settings, 40.0, 0.0, 0.0) == pytest.approx(3.0)
    assert off_deg(settings, 40.0, 0.0, 0.0, math.radians(-3.0)) == pytest.approx(0.0, abs=1e-9)


def test_a_turn_tilts_the_compass_most_on_northerly_and_southerly_courses() -> None:
    settings = CompassSettings(**STILL, dip_deg=66.0, turn_tilt_share=0.2)
    # Sideways acceleration 2 m/s × 0.8 rad/s: 9.3° of apparent heel, a fifth of it believed.
    expected_deg = math.degrees(0.2 * 1.6 / 9.81 * math.tan(math.radians(66.0)))
    assert off_deg(settings, 0.0, 0.8, 2.0) == pytest.approx(-expected_deg)
    assert off_deg(settings, 0.0, -0.8, 2.0) == pytest.approx(expected_deg)
    assert off_deg(settings, 90.0, 0.8, 2.0) == pytest.approx(0.0, abs=1e-9)
    assert off_deg(settings, 170.0, 0.8, 2.0) == pytest.approx(expected_deg * math.cos(math.radians(10.0)))
    scaled = reading(CompassSettings(**STILL, gyro_scale=1.02), 0.0, 0.5, 0.0)
    assert scaled.yaw_rate_rad_s == pytest.approx(0.51)


def test_the_ranger_looks_where_its_servo_is_and_says_where_it_should_be() -> None:
    # A wall on the starboard side alone: swinging out the ranger meets it late, swinging back it keeps it.
    wall = shapely.box(-9.0, -9.0, 2.0, 9.0)
    shore = Shore(build_chart("wall", FRAME, wall, ()), reach_m=4.0)

    def by_bearing(dead_s: float, deg_s: float) -> dict[tuple[int, bool], float | None]:
        settings = SonarSettings(
            noise_m=0.0, scatter_db=0.0, half_range_m=100.0, ghost_share=0.0, cone_deg=0.0,
            servo_dead_s=dead_s, servo_deg_s=deg_s,
        )  # fmt: skip
        sonar, before = SimSonar(settings, shore, 1), -100
        out: dict[tuple[int, bool], float | None] = {}
        for tick in range(300):
            sonar.sample(tick * DT_S, 0.0, 0.0, 0.0)
            for ping in sonar.read():
                bearing = round(math.degrees(ping.bearing_rad))
                out[bearing, bearing > before] = ping.range_m
                before = bearing
        return out

    ideal = by_bearing(0.0, 10_000.0)
    assert ideal[60, True] == pytest.approx(ideal[60, False])
    real = by_bearing(0.03, 300.0)
    out_m, back_m, ideal_m = real[60, True], real[60, False], ideal[60, True]
    assert out_m is not None
    assert back_m is not None
    assert ideal_m is not None
    assert out_m > ideal_m + 0.1
    assert back_m < ideal_m - 0.05
