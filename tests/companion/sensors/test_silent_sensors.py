"""Each sensor of the whole boat in turn falls silent: its last reading must not pass for a present one."""

import dataclasses
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import msgspec
import pytest
from boat_rig import FAILED, OK
from log_rig import LogRig, read_log

from companion.autopilot.sensor_suite import READ_S
from companion.boat import Boat
from companion.core.modes import Mode
from companion.core.readings import BatteryReading, HeadingReading
from companion.mavlink.dialect import dialect

pytestmark = pytest.mark.slow

LOITER = 5
FITTED = (
    "sensors.depth.fitted=true",
    "sensors.hull.fitted=true",
    "sensors.rc.fitted=true",
    "sensors.sonar.fitted=true",
)


class Silenceable:
    """A part whose driver can fall silent: as all drivers, it then repeats its latest reading.

    given: what to report instead of the part's own reading, without a time.
    """

    def __init__(self, part: Any) -> None:  # noqa: ANN401  any part
        self.part = part
        self.given: msgspec.Struct | None = None
        self.is_silent = False
        self.latest: Any = None

    def read(self) -> Any:  # noqa: ANN401
        if self.is_silent:
            return [] if isinstance(self.latest, list) else self.latest
        self.latest = self.part.read()
        if self.given is not None and self.latest is not None:
            self.latest = msgspec.structs.replace(self.given, time_s=self.latest.time_s)
        return self.latest

    def __getattr__(self, name: str) -> Any:  # noqa: ANN401
        return getattr(self.part, name)


class SilentRig(LogRig):
    """A logging boat whose parts can fall silent, by the names of `Hardware`."""

    def _build(self) -> Boat:
        names = ("gnss", "compass", "battery", "sonar", "depth", "hull", "rc")
        fitted = {name: getattr(self.hardware, name) for name in names}
        self.parts = {name: Silenceable(part) for name, part in fitted.items() if part is not None}
        self.hardware = dataclasses.replace(self.hardware, **self.parts)  # type: ignore[arg-type]
        return super()._build()

    def silence(self, *names: str) -> None:
        for name in names:
            self.parts[name].is_silent = True

    def counts(self, seconds: float, names: Iterable[str]) -> dict[str, int]:
        """How many messages of each type come in so many seconds."""
        self.peer.forget()
        self.run(seconds)
        return {name: len(self.peer.said(name)) for name in names}

    def health(self) -> int:
        """The health bits of a SYS_STATUS that comes now."""
        self.peer.forget()
        self.run(1.1)
        return int(self.peer.said("SYS_STATUS")[-1].onboard_control_sensors_health)


@pytest.fixture
def rig(tmp_path: Path) -> Iterator[SilentRig]:
    """Disarmed, well, and told to send all that sensors measure."""
    rig = SilentRig(tmp_path, *FITTED, config={"arming.repeat_s": 5.0})
    rig.ready()
    for message in (
        dialect.MAVLINK_MSG_ID_SCALED_IMU,
        dialect.MAVLINK_MSG_ID_RAW_IMU,
        dialect.MAVLINK_MSG_ID_GPS_RAW_INT,
        dialect.MAVLINK_MSG_ID_POWER_STATUS,
        dialect.MAVLINK_MSG_ID_DISTANCE_SENSOR,
        dialect.MAVLINK_MSG_ID_WATER_DEPTH,
    ):
        assert rig.ask(dialect.MAV_CMD_SET_MESSAGE_INTERVAL, message, 200_000) == OK
    assert rig.set_mode(LOITER) == OK
    rig.run(2.0)
    yield rig
    rig.boat.close()


def test_a_silent_receiver_has_no_fix_after_four_seconds_and_the_boat_does_not_arm(rig: SilentRig) -> None:
    assert rig.health() & dialect.MAV_SYS_STATUS_SENSOR_GPS
    rig.silence("gnss")
    rig.run(3.5)
    assert rig.peer.said("GPS_RAW_INT")[-1].fix_type == dialect.GPS_FIX_TYPE_RTK_FLOAT
    rig.run(1.0)
    rig.peer.forget()
    rig.run(1.0)
    fix = rig.peer.said("GPS_RAW_INT")[-1]
    assert (fix.fix_type, fix.satellites_visible) == (dialect.GPS_FIX_TYPE_NO_GPS, 0)
    health = rig.health()
    assert not health & dialect.MAV_SYS_STATUS_SENSOR_GPS
    assert not health & dialect.MAV_SYS_STATUS_PREARM_CHECK
    for _ in range(2):  # it stays so, while dead reckoning goes on
        assert rig.arm() == FAILED
        assert not rig.boat.vehicle.armed
        rig.run(rig.config.arming.repeat_s + 1.0)
        assert "PreArm: GPS: no 3-D fix" in rig.peer.texts


def test_a_receiver_without_a_fix_is_not_healthy_while_dead_reckoning_goes_on(rig: SilentRig) -> None:
    gnss = rig.parts["gnss"]
    gnss.given = msgspec.structs.replace(gnss.latest, fix_type=dialect.GPS_FIX_TYPE_2D_FIX)
    assert not rig.health() & dialect.MAV_SYS_STATUS_SENSOR_GPS
    assert rig.boat.nav is not None
    assert rig.boat.nav.position_age_s < rig.config.motors.estimate_timeout_s
    gnss.given = None
    assert rig.health() & dialect.MAV_SYS_STATUS_SENSOR_GPS


def test_a_silent_battery_monitor_is_no_full_pack(rig: SilentRig) -> None:
    rig.parts["battery"].given = BatteryReading(0.0, 12.3, 2.0)
    rig.run(1.0)
    rig.silence("battery")
    rig.run(3.2)
    assert rig.boat.vehicle.battery is None
    rig.peer.forget()
    rig.run(rig.config.arming.repeat_s + 1.0)
    status = rig.peer.said("SYS_STATUS")[-1]
    assert (status.voltage_battery, status.current_battery, status.battery_remaining) == (0xFFFF, -1, -1)
    assert "PreArm: Battery: unhealthy, the monitor is silent" in rig.peer.texts
    assert rig.counts(2.0, ("POWER_STATUS",)) == {"POWER_STATUS": 0}
    assert not rig.health() & dialect.MAV_SYS_STATUS_SENSOR_BATTERY
    assert rig.arm() == FAILED
    assert "Arm: Battery: unhealthy, the monitor is silent" in rig.peer.texts
    rig.parts["battery"].given = BatteryReading(0.0, 9.3, 2.0)  # as found when it measures again
    rig.parts["battery"].is_silent = False
    rig.run(10.5)
    assert any(text.startswith("Failsafe: Battery critical: 9.3 V") for text in rig.peer.texts)


def test_an_armed_boat_is_told_of_each_silence_and_its_log_has_no_more_readings(
    rig: SilentRig, tmp_path: Path
) -> None:
    rig.parts["compass"].given = HeadingReading(0.0, 1.0, 0.0, roll_rad=0.2, pitch_rad=0.1)
    assert rig.arm() == OK
    rig.run(2.0)
    rig.silence("gnss", "compass", "battery", "sonar", "depth", "hull", "rc")
    rig.run(6.0)
    silent_s = rig.now_s
    rig.run(5.0)
    texts = rig.peer.texts
    for text in (
        "Battery monitor is silent",
        "Depth sounder is silent",
        "Hull sensor is silent",
        "Failsafe: GPS lost: dead reckoning",
        "Failsafe: Sonar lost for 3 s",
        "Failsafe: RC lost: the receiver is silent",
    ):
        assert any(one.startswith(text) for one in texts), text
    rig.disarm()
    (path,) = tmp_path.glob("*.bin")
    records = [one for one in read_log(path) if getattr(one, "TimeUS", 0) > silent_s * 1e6]
    kinds = {one.get_type() for one in records}
    assert not kinds & {"GPS", "GPA", "HDG", "BAT", "SONR", "RFND", "DPTH", "RCIN"}
    assert {one.Roll for one in records if one.get_type() == "ATT"} == {0.0}


def test_a_bottom_is_believed_for_five_seconds_without_an_echo(rig: SilentRig) -> None:
    depth = rig.parts["depth"]
    assert rig.boat.sensors.bottom is not None
    found = depth.latest
    depth.given = msgspec.structs.replace(found, depth_m=None)
    rig.run(4.5)
    assert rig.boat.sensors.bottom is not None
    assert rig.boat.vehicle.board.depth is rig.boat.sensors.bottom
    rig.run(1.0)
    assert rig.boat.sensors.depth is not None
    assert rig.boat.sensors.bottom is None


def test_limits_are_those_of_the_configuration(tmp_path: Path) -> None:
    limits: dict[str, object] = {
        "parts.gnss.timeout_s": 8.0,
        "parts.compass.timeout_s": 7.0,
        "parts.battery.timeout_s": 9.0,
        "parts.hull.timeout_s": 10.0,
        "parts.depth.timeout_s": 11.0,
        "failsafe.sonar_timeout_s": 12.0,
    }
    rig = SilentRig(tmp_path, *FITTED, config=limits)
    rig.ready()
    rig.run(3.0)
    rig.silence(*(name for name in rig.parts if name != "rc"))
    latest = {
        "fix": rig.parts["gnss"].latest.time_s + 8.0,
        "compass": rig.parts["compass"].latest.time_s + 7.0,
        "battery": rig.parts["battery"].latest.time_s + 9.0,
        "hull": rig.parts["hull"].latest.time_s + 10.0,
        "depth": rig.parts["depth"].latest.time_s + 11.0,
    }
    assert rig.boat.sensors.sonar is not None
    latest["sonar"] = rig.boat.sensors.sonar.time_s + 12.0
    for name, until_s in sorted(latest.items(), key=lambda item: item[1]):
        rig.run(until_s - rig.now_s - 0.1)
        assert getattr(rig.boat.sensors, name) is not None, name
        rig.run(0.2 + READ_S)  # slow parts are looked at so often
        assert getattr(rig.boat.sensors, name) is None, name
    assert rig.boat.vehicle.mode is not Mode.AUTO
