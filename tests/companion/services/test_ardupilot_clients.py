"""What programs written for ArduPilot take for granted: the order on the wire, fields that they parse, codes.

Measured at ArduPilot Rover, or written in MAVLink's common set.
"""

import math
import types
from typing import Any

import pytest
from boat_rig import BOAT, DENIED, FAILED, HOME_ITEM, OK, QGC, Rig, Silent, waypoint

from companion.config.boat_config import BoatConfig, Parts, with_value
from companion.config.sensors import RangerPart
from companion.core.geo import LatLon
from companion.core.readings import GnssFix, SonarReading
from companion.mavlink.address import Address
from companion.mavlink.codec import Encoder
from companion.mavlink.dialect import Message, dialect
from companion.services.telemetry.motion_messages import gps_raw_int, gps_rtk
from companion.services.telemetry.sounding_messages import distance_sensor

CMD = dialect
LEFT, BOTH, PERCENT = 3, 1, 0
ARMED = dialect.MAV_MODE_FLAG_SAFETY_ARMED


@pytest.fixture
def rig() -> Rig:
    """A boat that could be armed, with a mission."""
    rig = Rig().ready()
    rig.upload([HOME_ITEM, waypoint(40.0, 0.0), waypoint(40.0, 40.0)])
    return rig


def motors(rig: Rig) -> tuple[float, float]:
    return rig.world._motors.left, rig.world._motors.right


@pytest.mark.parametrize(
    ("number", "params", "name"),
    [
        (CMD.MAV_CMD_REQUEST_MESSAGE, (148.0,), "AUTOPILOT_VERSION"),
        (CMD.MAV_CMD_REQUEST_MESSAGE, (435.0, 0.0), "AVAILABLE_MODES"),
        (CMD.MAV_CMD_REQUEST_MESSAGE, (397.0,), "COMPONENT_METADATA"),
        (CMD.MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES, (1.0,), "AUTOPILOT_VERSION"),
        (CMD.MAV_CMD_GET_HOME_POSITION, (), "HOME_POSITION"),
        (CMD.MAV_CMD_GET_MESSAGE_INTERVAL, (30.0,), "MESSAGE_INTERVAL"),
    ],
)
def test_a_message_follows_its_answer(rig: Rig, number: int, params: tuple[float, ...], name: str) -> None:
    rig.peer.forget()
    rig.peer.command(number, *params)
    rig.receive()
    heard = [message.get_type() for message in rig.peer.listen()]
    assert heard.index("COMMAND_ACK") < heard.index(name)


@pytest.mark.parametrize(("interval_us", "result"), [(19_900.0, DENIED), (20_000.0, OK)])
def test_an_interval_that_is_accepted_is_kept(rig: Rig, interval_us: float, result: int) -> None:
    assert rig.ask(CMD.MAV_CMD_SET_MESSAGE_INTERVAL, 30, interval_us) == result
    rig.peer.forget()
    rig.run(2.0)
    hz = len(rig.peer.said("ATTITUDE")) / 2.0
    assert hz == pytest.approx(50.0 if result == OK else 4.0, abs=1.0)


@pytest.mark.parametrize("magic", [2989.0, 21196.0])
def test_both_numbers_that_force_arming_do(magic: float) -> None:
    rig = Rig(gnss=Silent())
    rig.step()
    rig.set_mode(0)
    rig.peer.send(dialect.MAVLink_param_set_message(*BOAT, b"BATT_ARM_VOLT", 99.0, 9))
    rig.run(1.0)
    assert rig.boat.vehicle.arming_faults()
    assert rig.ask(CMD.MAV_CMD_COMPONENT_ARM_DISARM, 1.0, 0.0) == FAILED
    assert rig.ask(CMD.MAV_CMD_COMPONENT_ARM_DISARM, 1.0, magic) == OK
    assert rig.boat.vehicle.armed


def test_the_heartbeat_says_armed_while_a_motor_test_turns_propellers(rig: Rig) -> None:
    rig.peer.forget()
    assert rig.ask(CMD.MAV_CMD_DO_MOTOR_TEST, LEFT, PERCENT, 30.0, 2.0) == OK
    beats = rig.peer.said("HEARTBEAT")  # at once, before the motor turns
    assert beats
    assert beats[-1].base_mode & ARMED
    assert not rig.boat.vehicle.armed
    rig.run(3.0)
    assert motors(rig) == (0.0, 0.0)
    assert not rig.peer.said("HEARTBEAT")[-1].base_mode & ARMED


# Interlocks of what stations start


def test_a_motor_test_does_not_outlive_its_link(rig: Rig) -> None:
    other = rig.connect(Address(42, 190))
    assert rig.ask(CMD.MAV_CMD_DO_MOTOR_TEST, BOTH, PERCENT, 50.0, 25.0, peer=other) == OK
    rig.run(1.0)
    assert motors(rig) == (0.5, 0.5)
    other.link.close()
    rig.run(0.5)
    assert motors(rig) == (0.0, 0.0)
    assert "Motor test: ended, its link has closed" in rig.peer.texts


def test_a_motor_test_does_not_outlive_its_station_though_another_is_there(rig: Rig) -> None:
    other = rig.connect(Address(42, 190))
    assert rig.ask(CMD.MAV_CMD_DO_MOTOR_TEST, BOTH, PERCENT, 50.0, 25.0, peer=other) == OK
    for second in range(10):
        rig.peer.heartbeat()
        if second < 3:
            other.heartbeat()
        rig.run(1.0)
        assert motors(rig) == ((0.5, 0.5) if second < 7 else (0.0, 0.0)), second
    assert "Motor test: ended, its station is silent" in rig.peer.texts


@pytest.mark.parametrize("magic", [0.0, 2989.0])
def test_a_boat_that_is_about_to_restart_does_not_arm(rig: Rig, magic: float) -> None:
    assert rig.ask(CMD.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 1) == OK
    assert rig.ask(CMD.MAV_CMD_COMPONENT_ARM_DISARM, 1.0, magic) == FAILED
    assert "Arm: Program: restarting" in rig.peer.texts
    rig.ask(CMD.MAV_CMD_MISSION_START)
    assert rig.ask(CMD.MAV_CMD_DO_MOTOR_TEST, BOTH, PERCENT, 50.0, 25.0) == FAILED
    rig.run(0.4)
    assert rig.boat.wants_restart
    assert motors(rig) == (0.0, 0.0)


def test_a_program_that_does_not_restart_arms_again(rig: Rig) -> None:
    assert rig.ask(CMD.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 1) == OK
    rig.run(6.0)
    assert "Reboot: this program does not restart" in rig.peer.texts
    assert not rig.boat.wants_restart
    assert rig.arm() == OK


# Numbers that do not fit


def bytes_of(message: Message | None) -> bytes:
    """A frame, as the boat would send it: packing raises where a number does not fit its field."""
    assert message is not None
    return Encoder(QGC).encode(message)


def ranger(ping: SonarReading, driver: str) -> Message:
    config = BoatConfig(parts=Parts(sonar=RangerPart(driver=driver)))  # type: ignore[arg-type]
    now: Any = types.SimpleNamespace(sensors=types.SimpleNamespace(sonar=ping, depth=None), config=config)
    (message,) = distance_sensor(now)
    assert bytes_of(message)
    return message


def test_a_ranger_tells_its_kind_its_ranges_and_its_time_after_fifty_days_too() -> None:
    ping = SonarReading(50.0 * 86400.0, 0.0, 0.2, 0.25, 4.5)
    message = ranger(ping, "jsnsr04t")
    assert message.time_boot_ms == 50 * 86_400_000 - 2**32
    assert (message.min_distance, message.max_distance, message.current_distance) == (25, 450, 20)
    assert message.type == dialect.MAV_DISTANCE_SENSOR_ULTRASOUND
    assert message.horizontal_fov == pytest.approx(math.radians(15.0))
    assert ranger(ping, "tfmini").type == dialect.MAV_DISTANCE_SENSOR_LASER


def gps_raw_of(fix: GnssFix, compass: str) -> Message:
    config = with_value(BoatConfig(), "parts.compass.driver", compass)
    now = types.SimpleNamespace(sensors=types.SimpleNamespace(fix=fix), boot_us=0, config=config)
    message = gps_raw_int(now)  # type: ignore[arg-type]
    assert message is not None
    return message


@pytest.mark.parametrize(
    ("altitude_m", "accuracy_m"), [(3e6, 1.0), (-3e6, 1.0), (0.0, 5e6), (math.inf, math.inf), (-1e30, 1e30)]
)
def test_a_cold_receivers_numbers_fit_their_fields(altitude_m: float, accuracy_m: float) -> None:
    fix = GnssFix(1.0, LatLon(0.0, 0.0), 1, 0, 99.99, altitude_m=altitude_m, horizontal_accuracy_m=accuracy_m)
    message = gps_raw_of(fix, "none")
    assert bytes_of(message)
    assert message.h_acc == min(round(min(accuracy_m, 1e9) * 1e3), 0xFFFFFFFF)


def test_the_age_of_corrections_is_sent_while_there_are_some() -> None:
    def sent(age_s: float | None) -> Message | None:
        fix = GnssFix(
            500.0, LatLon(0.0, 0.0), 6, 20, 0.6, correction_age_s=age_s, horizontal_accuracy_m=0.014
        )
        return gps_rtk(types.SimpleNamespace(sensors=types.SimpleNamespace(fix=fix)))  # type: ignore[arg-type]

    assert sent(None) is None
    message = sent(5.0)
    assert message is not None
    assert bytes_of(message)
    assert (message.time_last_baseline_ms, message.accuracy, message.nsats) == (495_000, 14, 20)
    oldest = sent(math.inf)
    assert oldest is not None
    assert oldest.time_last_baseline_ms == 380_000


def test_a_receivers_accuracies_and_its_antennas_heading_are_sent() -> None:
    place = LatLon(50.0, 1.0)
    fix = GnssFix(
        1.0, place, 6, 20, 0.6, horizontal_accuracy_m=0.014, vertical_accuracy_m=0.02,
        speed_accuracy_m_s=0.12, heading_rad=math.radians(90.25), heading_accuracy_rad=math.radians(0.4),
    )  # fmt: skip
    message = gps_raw_of(fix, "gnss")
    assert (message.fix_type, message.h_acc, message.v_acc, message.vel_acc) == (6, 14, 20, 120)
    assert (message.yaw, message.hdg_acc) == (9025, 40_000)
    assert gps_raw_of(GnssFix(1.0, place, 6, 20, 0.6, heading_rad=0.0), "gnss").yaw == 36000  # north; 0: none
    assert gps_raw_of(GnssFix(1.0, place, 6, 20, 0.6), "gnss").yaw == 65535  # fitted, but no heading now
    assert gps_raw_of(GnssFix(1.0, place, 6, 20, 0.6), "bno055").yaw == 0
