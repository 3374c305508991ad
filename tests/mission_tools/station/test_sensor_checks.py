"""What is said of each part of a boat, from single messages."""

from typing import Any

import pytest
from blank_messages import blank

from companion.mavlink.dialect import dialect
from mission_tools.station.setup import sensor_checks as checks
from mission_tools.station.setup.latest_messages import MESSAGES, LatestMessages
from mission_tools.station.setup.sensor_checks import Board, Found, SensorSnapshot
from mission_tools.station.view import HANDLERS, View

BATTERY, MAG = dialect.MAV_SYS_STATUS_SENSOR_BATTERY, dialect.MAV_SYS_STATUS_SENSOR_3D_MAG
GYRO, RC = dialect.MAV_SYS_STATUS_SENSOR_3D_GYRO, dialect.MAV_SYS_STATUS_SENSOR_RC_RECEIVER
ALL = 0x7FFFFFFF


def status(fitted: int = ALL, well: int = ALL, **values: Any) -> Any:  # noqa: ANN401
    bits = {"onboard_control_sensors_present": fitted, "onboard_control_sensors_health": well}
    return blank("sys_status", **(bits | values))


def seen(*messages: Any, now_s: float = 1.0, board: Board | None = None) -> SensorSnapshot:  # noqa: ANN401
    """A boat of which these messages were heard at 1 s."""
    latest, view = LatestMessages(), View()
    for one in messages:
        if one.get_msgId() in MESSAGES:
            latest.on_message(one, 1.0)
        handler = HANDLERS.get(one.get_msgId())
        if handler is not None:
            handler(view, one)
    return SensorSnapshot(latest, view, (), now_s, True, board or {})


def fix(fix_type: int, **values: Any) -> Any:  # noqa: ANN401
    return blank("gps_raw_int", fix_type=fix_type, **values)


@pytest.mark.parametrize(
    ("messages", "now_s", "state"),
    [
        ([], 1.0, "unheard"),
        ([fix(0)], 1.0, "none"),
        ([fix(1)], 1.0, "no_fix"),
        ([fix(1)], 4.1, "silent"),
        ([fix(2)], 1.0, "flat"),
        ([fix(3)], 4.0, "good"),
        ([fix(3)], 4.1, "silent"),
        ([fix(3, eph=250)], 1.0, "good"),
        ([fix(3, eph=251)], 1.0, "inaccurate"),
        ([fix(3, eph=0xFFFF)], 1.0, "good"),
        ([fix(3), blank("ekf_status_report", flags=dialect.EKF_GPS_GLITCHING)], 1.0, "doubted"),
        ([fix(3), blank("ekf_status_report", pos_horiz_variance=0.79)], 1.0, "good"),
        ([fix(3), blank("ekf_status_report", pos_horiz_variance=0.8)], 1.0, "replaced"),
        ([fix(3), blank("ekf_status_report", pos_horiz_variance=float("nan"))], 1.0, "replaced"),
    ],
)
def test_a_receiver_is_judged_by_its_fix_and_by_the_boats_filter(
    messages: list[Any], now_s: float, state: str
) -> None:
    assert checks.examine_gnss(seen(*messages, now_s=now_s))[0] == state


def test_a_receiver_tells_only_what_it_knows() -> None:
    heard = fix(3, satellites_visible=9, eph=120, h_acc=1500)
    assert checks.examine_gnss(seen(heard))[1] == {"fix": 3, "satellites": 9, "hdop": 1.2, "error_m": 1.5}
    assert checks.examine_gnss(seen(fix(3, satellites_visible=0xFF, eph=0xFFFF)))[1] == {"fix": 3}
    assert checks.examine_gnss(seen(fix(1, eph=120, h_acc=1500)))[1] == {"fix": 1, "satellites": 0}


@pytest.mark.parametrize(
    ("well", "doubt", "state"),
    [
        (ALL, 0.49, "good"),
        (ALL, 0.5, "doubted"),
        (ALL, 0.8, "replaced"),
        (ALL, 1.0, "lost"),
        (ALL, float("inf"), "lost"),
        (ALL & ~MAG, 0.0, "lost"),
    ],
)
def test_a_compass_is_judged_by_how_far_the_filter_doubts_it(well: int, doubt: float, state: str) -> None:
    found = checks.examine_compass(
        seen(status(well=well), blank("ekf_status_report", compass_variance=doubt))
    )
    assert found[0] == state
    assert found[1]["doubt"] == pytest.approx(min(doubt, 1.0), abs=0.01)


def test_a_compass_tells_its_field_and_heading() -> None:
    imu = blank("scaled_imu", xmag=300, ymag=-400)
    heard = seen(status(), imu, blank("vfr_hud", heading=302))
    assert checks.examine_compass(heard) == (
        "good",
        {"field_mg": 500, "heading_deg": 302.0},
    )
    assert checks.examine_compass(seen(imu))[0] == "unheard"


def test_a_gyro_is_fitted_well_or_silent() -> None:
    turning = blank("scaled_imu", zgyro=-100)
    assert checks.examine_gyro(seen(turning)) == ("unheard", {})
    assert checks.examine_gyro(seen(status(fitted=ALL & ~GYRO))) == ("absent", {})
    assert checks.examine_gyro(seen(status(), turning)) == ("good", {"rate_deg_s": -5.7})
    assert checks.examine_gyro(seen(status(well=ALL & ~GYRO)))[0] == "silent"


def battery(**values: int) -> Found:
    measured = {"voltage_battery": 11_400, "current_battery": 250, "battery_remaining": 60}
    return checks.examine_battery(seen(status(**(measured | values))))


def test_a_battery_tells_what_is_measured() -> None:
    assert checks.examine_battery(seen()) == ("unheard", {})
    assert battery(fitted=ALL & ~BATTERY) == ("absent", {})
    assert battery() == ("good", {"voltage_v": 11.4, "current_a": 2.5, "percent": 60})
    assert battery(well=ALL & ~BATTERY)[0] == "low"
    assert battery(current_battery=0)[1]["current_a"] == 0.0
    assert battery(current_battery=-1) == ("no_current", {"voltage_v": 11.4, "percent": 60})
    assert battery(voltage_battery=0xFFFF)[0] == "silent"
    assert [battery(battery_remaining=one)[1].get("percent") for one in (-1, 0, 100, 101)] == [
        None,
        0,
        100,
        None,
    ]


def test_the_time_left_is_not_told_of_a_boat_at_rest() -> None:
    pack = blank("battery_status", time_remaining=900, voltages=[0xFFFF] * 10, voltages_ext=[0] * 4)
    heard = seen(status(voltage_battery=11_400), pack)
    assert heard.view.battery_left_s == 900.0
    assert "left_s" not in checks.examine_battery(heard)[1]


@pytest.mark.parametrize(
    ("voltages", "cells_v"),
    [([3800, 3790], [3.8, 3.79]), ([11_400], None), ([3800, 0xFFFE], None), ([3800, 0], None)],
)
def test_cells_are_shown_where_they_are_measured_one_by_one(
    voltages: list[int], cells_v: list[float] | None
) -> None:
    pack = blank("battery_status", voltages=(voltages + [0xFFFF] * 10)[:10], voltages_ext=[0] * 4)
    heard = seen(status(voltage_battery=11_400), pack)
    assert checks.examine_battery(heard)[1].get("cells_v") == cells_v


def test_a_transmitter_shows_its_channels_and_signal() -> None:
    rc = blank("rc_channels", chancount=3, chan1_raw=1500, chan2_raw=0xFFFF, chan3_raw=1100, rssi=127)
    assert checks.examine_rc(seen(rc)) == ("unheard", {})
    assert checks.examine_rc(seen(status(fitted=ALL & ~RC))) == ("absent", {})
    assert checks.examine_rc(seen(status(), rc)) == ("good", {"channels_us": [1500, 1100], "signal": 0.5})
    assert checks.examine_rc(seen(status(well=ALL & ~RC), rc))[0] == "off"
    unknown = blank("rc_channels", rssi=0xFF)
    assert checks.examine_rc(seen(status(), unknown)) == ("good", {})


@pytest.mark.parametrize(
    ("left_us", "right_us", "state"), [(1500, 0, "rest"), (1501, 1500, "turning"), (1500, 1499, "turning")]
)
def test_motors_turn_when_either_pulse_is_off_its_rest(left_us: int, right_us: int, state: str) -> None:
    outputs = blank("servo_output_raw", servo1_raw=left_us, servo2_raw=1900, servo3_raw=right_us)
    assert checks.examine_motors(seen(outputs)) == (state, {"left_us": left_us, "right_us": right_us})


def test_a_clock_is_good_once_it_knows_the_date() -> None:
    assert checks.examine_clock(seen()) == ("unheard", {})
    boot = blank("system_time", time_boot_ms=61_500)
    assert checks.examine_clock(seen(boot)) == ("unknown", {"running_s": 61})
    dated = blank("system_time", time_boot_ms=1000, time_unix_usec=1_700_000_000_900_000)
    assert checks.examine_clock(seen(dated)) == ("good", {"running_s": 1, "date_s": 1_700_000_000})


def test_a_computer_is_busy_or_hot_from_its_limits_on() -> None:
    def found(load: int, **board: float) -> Found:
        return checks.examine_computer(
            seen(status(load=load), blank("meminfo", freemem32=5 * 10**8), board=board)
        )

    assert checks.examine_computer(seen()) == ("unheard", {})
    assert found(949, temperature_c=79.9, disk_free_mb=7) == (
        "good",
        {"load": 0.949, "memory_mb": 500, "temperature_c": 79.9, "disk_mb": 7},
    )
    assert found(950)[0] == "busy"
    assert found(100, temperature_c=80.0)[0] == "hot"
