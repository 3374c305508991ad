"""An autopilot's messages as readings."""

import math

import pytest
from autopilot_bench import Bench
from pymavlink.dialects.v20 import ardupilotmega as mavlink
from twins.lines import known
from twins.rover import HEALTH

AHRS, MAGNETOMETER, RC = 0x200000, 0x4, 0x10000
ALIGNED, UNINITIALIZED = 1, 1024


@pytest.fixture
def bench() -> Bench:
    bench = Bench()
    bench.run(3.0)
    return bench


def test_a_fix_has_place_velocity_and_accuracies_of_the_receiver(bench: Bench) -> None:
    fix = known(bench.readings.fix)
    assert (fix.position.lat_deg, fix.position.lon_deg) == (50.0, -1.2)
    assert (fix.north_m_s, fix.east_m_s) == pytest.approx((0.0, 2.005), abs=2e-4)  # of 2.00 to 2.01
    accuracies = fix.horizontal_accuracy_m, fix.vertical_accuracy_m, fix.speed_accuracy_m_s
    assert (fix.fix_type, fix.satellites, fix.hdop, accuracies) == (3, 14, 0.8, (0.7, 0.9, 0.15))
    assert fix.unix_time_s == pytest.approx(1.7e9 + bench.rover.now_s, abs=0.3)


def test_a_fix_is_stamped_with_its_measurement_by_the_clock_of_the_autopilot(bench: Bench) -> None:
    measured_s = math.floor(bench.rover.now_s / 0.2) * 0.2 + bench.now_s - bench.rover.now_s
    assert known(bench.readings.fix).time_s == pytest.approx(measured_s - 0.11, abs=0.002)  # 0.1 and 0.01


def test_a_fix_that_is_repeated_keeps_its_stamp_and_a_lost_one_is_told(bench: Bench) -> None:
    bench.rover.fix = {"type": 1}
    bench.run(0.3)
    assert known(bench.readings.fix).fix_type == 1


def test_an_unknown_velocity_is_none(bench: Bench) -> None:
    bench.rover.fix = {"vel": 0xFFFF}
    bench.run(0.5)
    assert known(bench.readings.fix).north_m_s is None


def test_heading_and_yaw_rate_are_of_true_north_and_forty_a_second(bench: Bench) -> None:
    heading = known(bench.readings.heading)
    assert (heading.heading_rad, heading.yaw_rate_rad_s) == pytest.approx((1.0, 0.1))
    assert (heading.roll_rad, heading.pitch_rad) == pytest.approx((0.02, -0.01))
    assert not heading.is_magnetic
    assert bench.rover.intervals_s[30] == pytest.approx(0.025)


def test_readings_are_dated_well_again_ten_seconds_after_the_clocks_have_slipped(bench: Bench) -> None:
    bench.now_s += 0.3
    bench.run(11.0)
    assert known(bench.readings.heading).time_s == pytest.approx(bench.now_s - 0.01, abs=0.03)


@pytest.mark.parametrize(
    ("health", "flags"),
    [
        (HEALTH & ~AHRS, ALIGNED),
        (HEALTH & ~MAGNETOMETER, ALIGNED),
        (HEALTH, 0),
        (HEALTH, ALIGNED | UNINITIALIZED),
    ],
)
def test_there_is_no_heading_without_a_healthy_filter_and_compass(
    bench: Bench, health: int, flags: int
) -> None:
    bench.rover.health, bench.rover.flags = health, flags
    bench.run(1.0)
    before = known(bench.readings.heading)
    bench.run(1.0)
    assert bench.readings.heading is before


def test_there_is_no_heading_once_the_filter_rejects_the_compass(bench: Bench) -> None:
    rejecting = mavlink.MAVLink_ekf_status_report_message(ALIGNED, 0.1, 0.1, 0.1, 1.2, 0.0)
    bench.rover.intervals_s.pop(193)
    bench.link._came_s[193] = math.inf  # not asked for again
    bench.feed(rejecting.pack(bench.rover.wire))
    before = known(bench.readings.heading)
    bench.run(1.0)
    assert bench.readings.heading is before


@pytest.mark.parametrize(
    ("flags", "mag_ratio", "has_heading"), [(0x33F, 0.2, True), (0x33E, 0.2, False), (0x33F, 1.2, False)]
)
def test_px4_tells_the_health_of_its_filter_by_its_own_report(
    flags: int, mag_ratio: float, *, has_heading: bool
) -> None:
    """As its source packs it, streams/ESTIMATOR_STATUS.hpp; its other messages are those of Rover."""
    bench = Bench()
    bench.feed(mavlink.MAVLink_heartbeat_message(10, 12, 0x51, 0, 4, 3).pack(bench.rover.wire))
    for message in (
        mavlink.MAVLink_estimator_status_message(1, flags, 0.1, 0.1, 0.1, mag_ratio, 0.0, 0.0, 0.5, 0.5),
        mavlink.MAVLink_sys_status_message(
            0, AHRS | MAGNETOMETER, AHRS | MAGNETOMETER, 0, 0xFFFF, -1, -1, *[0] * 6
        ),
        mavlink.MAVLink_attitude_message(5000, 0.02, -0.01, 1.0, 0.0, 0.0, 0.1),
    ):
        bench.feed(message.pack(bench.rover.wire))
    assert (bench.readings.heading is not None) is has_heading
    assert bench.readings.battery is None
    asked = {
        message.param1 for message in bench.link.tick(bench.now_s) if message.get_type() == "COMMAND_LONG"
    }
    assert mavlink.MAVLINK_MSG_ID_EKF_STATUS_REPORT not in asked
    assert mavlink.MAVLINK_MSG_ID_GPS_RAW_INT in asked


def test_there_is_no_heading_without_reports_of_health(bench: Bench) -> None:
    bench.rover.intervals_s.pop(193)
    bench.link._came_s[193] = math.inf
    bench.run(4.0)
    before = known(bench.readings.heading)
    bench.run(0.5)
    assert bench.readings.heading is before


def test_the_battery_is_that_of_the_monitor(bench: Bench) -> None:
    battery = known(bench.readings.battery)
    assert (battery.voltage_v, battery.current_a) == (12.1, 4.3)


@pytest.mark.parametrize("is_lost", [True, False])
def test_the_transmitter_is_lost_as_the_autopilot_says(bench: Bench, *, is_lost: bool) -> None:
    if is_lost:
        bench.rover.health &= ~RC
    bench.run(1.0)
    reading = known(bench.readings.rc)
    assert (len(reading.channels_us), reading.channels_us[1], reading.channels_us[3:]) == (
        5,
        1500,
        (1500, 1900),
    )
    assert (reading.is_failsafe, reading.quality) == (is_lost, 0.5)


def ranged(bench: Bench, orientation: int, distance_cm: int, quality: int = 0) -> None:
    report = mavlink.MAVLink_distance_sensor_message(
        0, 20, 700, distance_cm, 0, 0, orientation, 0, signal_quality=quality
    )
    bench.feed(report.pack(bench.rover.wire))


def test_a_ranger_that_looks_down_is_a_depth_sounder(bench: Bench) -> None:
    ranged(bench, 25, 230, 90)
    depth = known(bench.readings.depth)
    assert (depth.depth_m, depth.quality, depth.min_range_m, depth.max_range_m) == (2.3, 0.9, 0.2, 7.0)
    ranged(bench, 25, 700)
    assert known(bench.readings.depth).depth_m is None
    ranged(bench, 25, 230, 1)
    assert known(bench.readings.depth).depth_m is None


def test_rangers_around_are_pings(bench: Bench) -> None:
    for orientation, distance_cm in ((0, 150), (2, 750), (7, 10), (24, 100)):
        ranged(bench, orientation, distance_cm)
    pings = [(round(math.degrees(ping.bearing_rad)), ping.range_m) for ping in bench.readings.pings]
    assert pings == [(0, 1.5), (90, None), (-45, None)]
    assert bench.readings.dropped == 1
