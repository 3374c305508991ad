"""The list of sensors, of real boats whose parts fail."""

import math
from collections.abc import Callable

from blank_messages import blank
from boat_rig import Rig
from shore_rig import Shore

from companion.mavlink.dialect import dialect
from mission_tools.station.messages import Sensor
from mission_tools.station.setup.latest_messages import LatestMessages
from mission_tools.station.setup.sensor_checks import SensorSnapshot
from mission_tools.station.setup.sensors import ROWS, sensors, verdicts
from mission_tools.station.view import View
from mission_tools.station.words import texts

OFF = dialect.FAILURE_TYPE_OFF
GNSS, COMPASS = dialect.FAILURE_UNIT_SENSOR_GPS, dialect.FAILURE_UNIT_SENSOR_MAG
SONAR, BATTERY = dialect.FAILURE_UNIT_SENSOR_DISTANCE_SENSOR, dialect.FAILURE_UNIT_SYSTEM_BATTERY


def seen(shore: Shore) -> dict[str, Sensor]:
    """The list as the page gets it."""
    found = shore.boats.sensors(1)
    assert found is not None
    return {one.name: one for one in found}


def watch(shore: Shore, seconds: float = 4.0) -> dict[str, Sensor]:
    """The page looks twice a second."""
    for _ in range(round(seconds / 0.5)):
        seen(shore)
        shore.run(0.5)
    return seen(shore)


def watch_until(shore: Shore, is_so: Callable[[dict[str, Sensor]], bool], limit_s: float = 20.0) -> None:
    began_s = shore.now_s
    while not is_so(watch(shore, 0.5)):
        assert shore.now_s - began_s < limit_s, seen(shore)


def break_part(rig: Rig, unit: int, failure: int) -> None:
    assert rig.ask(dialect.MAV_CMD_INJECT_FAILURE, unit, failure) == dialect.MAV_RESULT_ACCEPTED


def test_the_parts_of_a_healthy_boat_are_fine_and_have_values() -> None:
    rig = Rig("open", "sensors.depth.fitted=true")
    shore = Shore(rig).ready()
    seen = watch(shore)
    assert [one.name for one in seen.values()] == [row.name for row in ROWS]
    verdicts = {name: one.verdict for name, one in seen.items()}
    assert verdicts.pop("rc") == "skipped"
    assert set(verdicts.values()) == {"fine"}, seen
    assert seen["gnss"].values["fix"] == 5
    assert seen["gnss"].values["satellites"] >= 6
    assert 0.3 < seen["gnss"].values["hdop"] < 2.5
    assert 0.0 <= seen["compass"].values["heading_deg"] < 360.0
    assert 11.0 < seen["battery"].values["voltage_v"] < 13.0
    assert abs(seen["gyro"].values["rate_deg_s"]) < 10.0
    assert -180.0 <= seen["sonar"].values["bearing_deg"] <= 180.0
    assert seen["depth"].values["depth_m"] > 0.0
    assert (seen["motors"].values["left_us"], seen["motors"].values["right_us"]) == (1500, 1500)
    assert all(one.age_s is not None and one.age_s < 2.0 for one in seen.values() if one.verdict == "fine")


def test_parts_that_fail_are_told_and_parts_that_recover_too() -> None:
    rig = Rig()
    shore = Shore(rig).ready()
    names = ("gnss", "compass", "gyro", "sonar", "battery")
    watch_until(shore, lambda seen: all(seen[name].verdict == "fine" for name in names))
    for unit in (GNSS, COMPASS, SONAR, BATTERY):
        break_part(rig, unit, OFF)
    watch_until(shore, lambda seen: all(seen[name].verdict == "failed" for name in names))
    assert all(seen(shore)[name].cure for name in names)
    for unit in (GNSS, COMPASS, SONAR, BATTERY):
        break_part(rig, unit, 0)
    watch_until(shore, lambda seen: all(seen[name].verdict == "fine" for name in names), 60.0)


def test_a_reason_of_the_boat_comes_before_a_fine_verdict() -> None:
    rig = Rig(config={"arming.battery_min_v": 20.0})
    shore = Shore(rig)
    shore.until(lambda: bool(shore.boats.names()), 5.0)
    watch_until(shore, lambda seen: seen["battery"].verdict == "warning", 30.0)
    battery = seen(shore)["battery"]
    assert battery.text == "The battery is too empty to set out."
    assert battery.cure == "Charge or change it."


def test_every_state_has_words_and_each_warning_and_failure_a_cure() -> None:
    for part, states in verdicts().items():
        for state, verdict in states.items():
            assert verdict in ("fine", "warning", "failed", "skipped"), (part, state)
            assert texts()[f"sensor.{part}.{state}.text"]
            has_cure = f"sensor.{part}.{state}.cure" in texts()
            assert has_cure == (verdict in ("warning", "failed")), (part, state)


def test_values_that_are_no_numbers_are_left_out() -> None:
    latest = LatestMessages()
    nan = float("nan")
    latest.on_message(blank("sys_status", onboard_control_sensors_present=0x7FFFFFFF), 1.0)
    latest.on_message(blank("distance_sensor", orientation=100, quaternion=[nan] * 4), 1.0)
    latest.on_message(blank("ekf_status_report", compass_variance=nan, pos_horiz_variance=nan), 1.0)
    for number in range(40):
        latest.on_message(blank("named_value_float", name=f"p{number}".encode(), value=nan), 1.0)
    found = sensors(SensorSnapshot(latest, View(), (), 2.0, True, {}))
    assert len(found) == len(ROWS) + 16
    values = [value for one in found for value in one.values.values()]
    assert [value for value in values if isinstance(value, float) and math.isnan(value)] == []
    assert {one.verdict for one in found[len(ROWS) :]} == {"warning"}


def test_a_probe_is_good_while_it_measures() -> None:
    latest = LatestMessages()
    latest.on_message(blank("named_value_float", name=b"PH", value=7.25, time_boot_ms=1), 1.0)
    for now_s, verdict in ((11.0, "fine"), (11.1, "warning")):
        probe = sensors(SensorSnapshot(latest, View(), (), now_s, True, {}))[-1]
        assert (probe.name, probe.verdict, probe.values) == ("probe PH", verdict, {"value": 7.25})
