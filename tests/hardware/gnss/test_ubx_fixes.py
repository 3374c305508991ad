"""Fixes and headings of a u-blox receiver."""

import math

import pytest
from twins.lines import known
from twins.ubx_bench import Bench
from twins.ubx_receiver import NEO_6M, ZED_F9P

from companion.core.readings import GnssFix
from companion.sensors.gnss_heading import GnssHeading


def test_a_fix_has_the_receivers_velocity_accuracies_and_time() -> None:
    bench = Bench()
    bench.until_running()
    fix = bench.run(1.0).fixes[-1]
    assert (fix.position.lat_deg, fix.position.lon_deg) == pytest.approx((50.5, -1.2), abs=1e-7)
    assert (fix.north_m_s, fix.east_m_s) == pytest.approx((1.2, -0.3))
    assert (fix.horizontal_accuracy_m, fix.vertical_accuracy_m, fix.speed_accuracy_m_s) == pytest.approx(
        (1.5, 3.0, 0.25)
    )
    assert (fix.fix_type, fix.satellites, fix.hdop, fix.altitude_m) == pytest.approx((3, 14, 0.85, 12.5))
    assert fix.time_of_day_s == pytest.approx(216_000.0 % 86_400.0 + fix.time_s, abs=0.15)  # of its week
    assert fix.unix_time_s is not None
    # 2024-05-28 09:00:00 UTC at second 0 of the receiver
    assert fix.unix_time_s - 1_716_886_800.0 == pytest.approx(fix.time_s, abs=0.15)


@pytest.mark.parametrize(
    ("changes", "fix_type"),
    [
        ({"carrier": 1}, 5),
        ({"carrier": 2}, 6),
        ({"fix_type": 2}, 2),
        ({"fix_type": 4}, 3),
        ({"fix_type": 1}, 1),  # dead reckoning alone
        ({"fix_type": 5}, 1),  # time only
        ({"correction_age": 3}, 4),
        ({"invalid_position": 1}, 1),
        ({"fix_ok": 0}, 1),  # outside the receiver's accuracy masks
    ],
)
def test_fix_quality_follows_the_receivers_flags(changes: dict[str, int], fix_type: int) -> None:
    bench = Bench()
    for name, value in changes.items():
        setattr(bench.receiver.motion, name, value)
    bench.until_running()
    fix = bench.run(1.0).fixes[-1]
    assert fix.fix_type == fix_type
    assert (fix.north_m_s is None) == (fix_type == 1)


def test_sentences_beside_solutions_are_not_fixes_of_their_own() -> None:
    bench = Bench(ZED_F9P)
    bench.receiver.refused.add(0x10740002)  # NMEA output stays on
    bench.until_running()
    assert bench.receiver.settings.nmea_out
    bench.fixes.clear()
    bench.run(5.0)
    assert {fix.satellites for fix in bench.fixes} == {14}  # the sentences say 9
    bench.receiver.settings.outputs["PVT"] = 0
    bench.receiver.is_deaf = True  # or it would be set up again
    bench.run(2.5)
    assert bench.fixes[-1].satellites == 9


def test_an_old_dilution_of_precision_gives_way_to_that_of_the_position() -> None:
    bench = Bench(ZED_F9P)
    bench.until_running()
    bench.run(1.0)
    bench.receiver.settings.outputs["DOP"] = 0
    assert bench.run(1.8).fixes[-1].hdop == 0.85
    assert bench.run(0.6).fixes[-1].hdop == 1.6


@pytest.mark.parametrize("valid", [(0, 1, 1), (1, 0, 1), (1, 1, 0)])
def test_a_time_without_date_or_leap_seconds_is_not_used(valid: tuple[int, int, int]) -> None:
    bench = Bench()
    bench.receiver.motion.valid = valid
    bench.until_running()
    assert bench.run(1.0).fixes[-1].unix_time_s is None


def test_the_age_of_corrections_is_the_upper_bound_of_its_class() -> None:
    bench = Bench(ZED_F9P)
    bench.until_running()
    # UBX-22008968, NAV-PVT, lastCorrectionAge
    classes_s = [None, 1.0, 2.0, 5.0, 10.0, 15.0, 20.0, 30.0, 45.0, 60.0, 90.0, 120.0, math.inf]
    for code, age_s in enumerate(classes_s):
        bench.receiver.motion.correction_age = code
        assert bench.run(0.5).fixes[-1].correction_age_s == age_s


def test_a_u_blox_6_sends_accuracies_and_fixes_as_sentences() -> None:
    bench = Bench(NEO_6M)
    bench.until_running()
    bench.fixes.clear()
    fix = bench.run(2.0).fixes[-1]
    assert len(bench.fixes) == pytest.approx(10, abs=1)
    assert (fix.fix_type, fix.satellites) == (3, 9)
    assert fix.horizontal_accuracy_m == pytest.approx(2.5)
    # GGA, RMC, GSA and GST; GSV is most of the bytes, GLL and VTG repeat what RMC has
    on, off = {"NMEA0": 1, "NMEA4": 1, "NMEA2": 1, "NMEA7": 1}, {"NMEA3": 0, "NMEA1": 0, "NMEA5": 0}
    assert bench.receiver.settings.outputs == on | off


def test_a_heading_of_two_antennas_is_accepted_and_its_loss_reported() -> None:
    heading = GnssHeading(antenna_bearing_rad=math.radians(-10.0), baseline_m=1.0, latency_s=0.05)
    bench = Bench(ZED_F9P, heading=heading)
    bench.until_running()
    bench.run(2.0)
    reading = known(heading.latest)
    assert math.degrees(reading.heading_rad) == pytest.approx(100.0)
    assert bench.clock() - reading.time_s < 0.4
    assert [fix.heading_rad for fix in bench.fixes[-1:]] == [reading.heading_rad]
    assert bench.fixes[-1].heading_accuracy_rad == pytest.approx(math.radians(0.4))
    bench.texts.clear()
    bench.receiver.motion.baseline_carrier = 1
    bench.run(5.0)
    assert bench.texts == ["GNSS heading lost: baseline not fixed"]
    latest = known(heading.latest)
    assert bench.clock() - latest.time_s > 4.0
    last: GnssFix = bench.fixes[-1]
    assert last.heading_rad is None
    bench.receiver.motion.baseline_carrier = 2
    bench.run(1.0)
    assert bench.texts[1:] == ["GNSS heading is back"]


@pytest.mark.parametrize(
    ("changes", "why"),
    [
        ({"length_m": 1.12}, "baseline 1.12 m, expected 1.00 m"),
        ({"length_m": 0.81}, "baseline 0.81 m, expected 1.00 m"),
        ({"heading_accuracy": 7.0}, "accuracy 7 degrees"),
        ({"heading_valid": 0}, "no baseline between the antennas"),
    ],
)
def test_a_doubtful_heading_is_not_used(changes: dict[str, float], why: str) -> None:
    heading = GnssHeading(baseline_m=1.0)
    bench = Bench(ZED_F9P, heading=heading)
    bench.until_running()
    bench.run(1.0)
    for name, value in changes.items():
        setattr(bench.receiver.motion, name, value)
    bench.run(0.5)
    latest = heading.latest
    bench.run(3.5)
    assert heading.latest is latest
    assert f"GNSS heading lost: {why}" in bench.texts
